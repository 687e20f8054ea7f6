// SPDX-License-Identifier: MIT
#include "rayshade/render/block_renderer.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <numeric>

#include "rayshade/sampling/sample_numbers.h"
#include "rayshade/sampling/tile_order.h"

namespace rayshade {
BlockRenderer::BlockRenderer(const FrameScene& frame) : frame_(frame), tree_(frame.shading) {}

/// The one sample of a pixel that is not fully sampled (shading.md 7.3): uniform over its N x N samples, and
/// such that N x N pixels together take each once. Neighbours then see different parts of the lens, the
/// shutter and the lights, and calm regions keep less noise than with independent choices.
int BlockRenderer::chosen_sample(int x, int y) const {
  const int side = frame_.grid->samples_per_side();
  const int count = side * side;
  if (count == 1 || frame_.shading.settings->sobol()) return 0;
  const RandomKey key{frame_.shading.settings->seed, frame_.shading.frame,
                      static_cast<std::uint32_t>(x / side), static_cast<std::uint32_t>(y / side), 0};
  // An affine permutation of the tile's pixels; the factor has no divisor in common with the count.
  const auto random = uniform2(key, dimension(kRootPath, Purpose::kSampleChoice));
  int factor = 1 + static_cast<int>(random[0] * (count - 1));
  while (std::gcd(factor, count) != 1) ++factor;
  const int shift = static_cast<int>(random[1] * count);
  return ((x % side + side * (y % side)) * factor + shift) % count;
}

/// Adds sample `k` of a pixel to those to be traced. It is made where it stays: copies of fresh records stall
/// on their own stores.
void BlockRenderer::take_sample(int x, int y, int k) {
  EyeSample& out = samples_.add();
  out.x = static_cast<std::uint32_t>(x);
  out.y = static_cast<std::uint32_t>(y);
  out.sample = static_cast<std::uint32_t>(k);
  out.sample_number = frame_.shading.settings->sobol() ? 0 : frame_.grid->sample_number(k);
}

/// The rays of samples_.
void BlockRenderer::make_rays() {
  const RenderSettings& settings = *frame_.shading.settings;
  const Camera& camera = *frame_.camera;
  const SampleGrid& grid = *frame_.grid;
  const int frame = frame_.shading.frame;
  const bool sobol = settings.sobol(), lens = camera.has_lens(), shutter = settings.shutter > 0;
  const bool moves = sobol || settings.jitter, varies = moves || lens || shutter;
  const double start = frame_.shading.eye_start(), still = camera.time(frame, 0, 0);
  if (rays_.size() < samples_.size()) rays_.resize(samples_.size());
  ScreenPoints points;
  for (std::size_t first = 0; first < samples_.size(); first += ScreenPoints::kMost) {
    const EyeSample* const samples = samples_.begin() + first;
    NearestQuery* const rays = rays_.data() + first;
    const std::size_t count = points.count = std::min(ScreenPoints::kMost, samples_.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const EyeSample& sample = samples[i];
      const int k = static_cast<int>(sample.sample);
      rays[i].lo = start;
      rays[i].ray.time = still;
      if (!varies) {
        const auto& corner = grid.corner(k);
        points.u[i] = sample.x + corner[0];
        points.v[i] = sample.y + corner[1];
        continue;
      }
      const SampleNumbers numbers(settings, frame, sample.x, sample.y, sample.sample);
      const auto chosen = numbers.eye(moves, lens, moves && shutter);
      const auto [xi, zeta] = chosen.pixel;
      const auto offset = sobol ? frame_.filter->offset(xi, zeta) : grid.offset(k, xi, zeta);
      points.u[i] = sample.x + offset[0];
      points.v[i] = sample.y + offset[1];
      if (lens)
        rays[i].ray =
            camera.lens_ray(points.u[i], points.v[i], sample.sample_number, chosen.lens[0], chosen.lens[1]);
      rays[i].ray.time = camera.time(frame, sample.sample_number, chosen.moment);
    }
    if (lens) continue;
    camera.aim(points);
    for (std::size_t i = 0; i < count; ++i) {
      Ray& ray = rays[i].ray;
      ray.origin = camera.eye();
      ray.direction = points.direction(i);
      ray.unit = true;
    }
  }
}

/// Traces samples_ and adds what they bring to `traced`; one by one and timed where costs are wanted.
void BlockRenderer::trace_samples(Traced& traced) {
  make_rays();
  const std::size_t before = traced.results.size(), count = samples_.size();
  traced.results.resize(before + count);
  if (layered()) traced.details.resize(before + count);
  const auto trace = [&](std::size_t first, std::size_t n) {
    const auto part = [&](auto& records) {
      return std::span(records).subspan(records.empty() ? 0 : before + first, records.empty() ? 0 : n);
    };
    tree_.trace({rays_.data() + first, n}, {samples_.begin() + first, n}, part(traced.results),
                part(traced.details));
  };
  if (!frame_.cost) {
    trace(0, count);
    return;
  }
  traced.costs.resize(before + count);
  const auto queries = [&] { return tree_.counts().queries(); };
  const auto in_trees = [&] { return tree_.scratch().trees ? tree_.scratch().trees->rays() : 0; };
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t queries_before = queries(), in_trees_before = in_trees();
    const auto start = std::chrono::steady_clock::now();
    trace(i, 1);
    const auto end = std::chrono::steady_clock::now();
    traced.costs[before + i] = {std::chrono::duration<float, std::micro>(end - start).count(),
                                static_cast<float>(queries() - queries_before),
                                static_cast<float>(in_trees() - in_trees_before)};
  }
}

void BlockRenderer::note_layer(const Traced& traced, std::size_t i, BlockPixels::Layer& layer) const {
  const bool hit = traced.results[i].hit;
  const SampleDetail& detail = traced.details[i];
  layer.depth = hit ? static_cast<float>(detail.distance) : std::numeric_limits<float>::infinity();
  for (int axis = 0; axis < 3; ++axis)
    layer.normal[axis] = hit ? static_cast<float>(detail.normal[axis]) : 0.0f;
  layer.object = hit && !frame_.numbers.empty() ? static_cast<float>(frame_.numbers[detail.leaf]) : 0.0f;
}

void BlockRenderer::add_cost(const Traced& traced, std::size_t i, BlockPixels::Layer& layer) {
  layer.tests += static_cast<float>(traced.details[i].tests);
  layer.bounds_tests += static_cast<float>(traced.details[i].bounds_tests);
  if (traced.costs.empty()) return;
  layer.microseconds += traced.costs[i].microseconds;
  layer.rays += traced.costs[i].rays;
  layer.tree_rays += traced.costs[i].tree_rays;
}

/// One sample of every pixel of `outer` into single_, in TileOrder; those of the block become its pixels.
void BlockRenderer::render_single(const PixelRect& outer, BlockPixels& out) {
  single_.clear();
  samples_.clear();
  const PixelRect rect = out.rect;
  double* const rgba = out.rgba.data();
  const double hit = frame_.sample_map ? 0 : 1;
  const bool layers = !out.layers.empty();
  const auto flush = [&] {
    const std::size_t first = single_.results.size();
    trace_samples(single_);
    const std::size_t count = samples_.size();
    const EyeSample* const samples = samples_.begin();
    const SampleResult* const results = single_.results.data() + first;
    for (std::size_t i = 0; i < count; ++i) {
      const int x = static_cast<int>(samples[i].x), y = static_cast<int>(samples[i].y);
      if (!rect.contains(x, y)) continue;
      const std::size_t index = rect.index(x, y);
      store_pixel(&rgba[4 * index], results[i].color, results[i].hit ? hit : 0.0);
      if (!layers) continue;
      BlockPixels::Layer& layer = out.layers[index];
      note_layer(single_, first + i, layer);
      layer.samples = 1;
      add_cost(single_, first + i, layer);
    }
    samples_.clear();
  };
  const bool choose = frame_.grid->count() > 1;
  TileOrder(outer).each([&](int x, int y) {
    take_sample(x, y, choose ? chosen_sample(x, y) : 0);
    if (samples_.size() >= kSamplesTogether) flush();
  });
  flush();
}

void BlockRenderer::render(const PixelRect& rect, BlockPixels& out) {
  const RenderSettings& settings = *frame_.shading.settings;
  const std::size_t pixels = rect.area();
  out.rect = rect;
  out.rgba.resize(4 * pixels);
  out.layers.assign(layered() ? pixels : 0, {});
  ++counts_.blocks;
  counts_.pixels += pixels;
  if (settings.sobol()) {
    render_until_exact(rect, out);
    return;
  }

  // Single samples, with the halo that refinement looks at.
  const bool refine = frame_.grid->count() > 1;
  const PixelRect outer = refine ? halo(rect, kRefinementReach, settings.width, settings.height) : rect;
  render_single(outer, out);
  const std::vector<SampleResult>& single = single_.results;
  counts_.halo_samples += single.size() - pixels;
  if (!refine) {
    // Nothing is left to be done, but the border of the screen counts as fully sampled.
    const PixelRect inner{std::max(rect.x0, 1), std::max(rect.y0, 1), std::min(rect.x1, settings.width - 1),
                          std::min(rect.y1, settings.height - 1)};
    const bool any_inner = inner.x0 < inner.x1 && inner.y0 < inner.y1;
    counts_.supersampled += pixels - (any_inner ? inner.area() : 0);
    if (!frame_.sample_map) return;
    for (int y = rect.y0; y < rect.y1; ++y) {
      for (int x = rect.x0; x < rect.x1; ++x)
        if (!inner.contains(x, y)) out.rgba[4 * rect.index(x, y) + 3] = 1;
    }
    return;
  }

  const TileOrder order(outer);
  std::vector<Color> colors(single.size());
  std::size_t own = 0;
  order.each([&](int x, int y) { colors[outer.index(x, y)] = single[own++].color; });
  const std::vector<bool> full =
      choose_full(rect, colors, settings.contrast, settings.width, settings.height);

  // The other samples of the pixels that need them, in chunks of whole pixels.
  const int count = frame_.grid->count();
  std::vector<std::size_t> chosen;
  const auto flush = [&] {
    traced_.clear();
    trace_samples(traced_);
    std::size_t next = 0;
    for (const std::size_t p : chosen) {
      const int x = rect.x0 + static_cast<int>(p % static_cast<std::size_t>(rect.width()));
      const int y = rect.y0 + static_cast<int>(p / static_cast<std::size_t>(rect.width()));
      const int reused = chosen_sample(x, y);
      const SampleResult& one = single[order.index(x, y)];
      Color sum;
      double alpha = 0;
      for (int k = 0; k < count; ++k) {
        const bool again = k == reused;
        const SampleResult& sample = again ? one : traced_.results[next];
        const double weight = frame_.grid->weight(k);
        sum += weight * sample.color;
        alpha += sample.hit ? weight : 0.0;
        if (again) continue;
        if (!out.layers.empty()) add_cost(traced_, next, out.layers[p]);
        ++next;
      }
      store_pixel(&out.rgba[4 * p], sum, frame_.sample_map ? 1.0 : alpha);
      if (!out.layers.empty()) out.layers[p].samples = static_cast<float>(count);
    }
    samples_.clear();
    chosen.clear();
  };
  samples_.clear();
  for (std::size_t p = 0; p < pixels; ++p) {
    if (!full[p]) continue;
    ++counts_.supersampled;
    chosen.push_back(p);
    const int x = rect.x0 + static_cast<int>(p % static_cast<std::size_t>(rect.width()));
    const int y = rect.y0 + static_cast<int>(p / static_cast<std::size_t>(rect.width()));
    const int reused = chosen_sample(x, y);
    for (int k = 0; k < count; ++k) {
      if (k != reused) take_sample(x, y, k);
    }
    if (samples_.size() >= kSamplesTogether) flush();
  }
  if (!chosen.empty()) flush();
}

void BlockRenderer::observe(int x, int y, TreeObserver& observer) {
  tree_.set_observer(&observer);
  samples_.clear();
  take_sample(x, y, chosen_sample(x, y));
  traced_.clear();
  trace_samples(traced_);
  tree_.set_observer(nullptr);
}

}  // namespace rayshade
