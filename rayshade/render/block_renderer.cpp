// SPDX-License-Identifier: MIT
#include "rayshade/render/block_renderer.h"

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
  const RenderSettings& settings = *frame_.shading.settings;
  EyeSample& out = samples_.add();
  out.x = static_cast<std::uint32_t>(x);
  out.y = static_cast<std::uint32_t>(y);
  out.sample = static_cast<std::uint32_t>(k);
  out.sample_number = settings.sobol() ? 0 : frame_.grid->sample_number(k);
  const SampleNumbers numbers(settings, frame_.shading.frame, out.x, out.y, out.sample);
  const bool moves = settings.sobol() || settings.jitter;
  const auto chosen = numbers.eye(moves, frame_.camera->has_lens(), moves && settings.shutter > 0);
  const auto [xi, zeta] = chosen.pixel;
  const auto offset = settings.sobol() ? frame_.filter->offset(xi, zeta) : frame_.grid->offset(k, xi, zeta);
  const double u = x + offset[0], v = y + offset[1];
  if (frame_.camera->has_lens()) {
    out.ray = frame_.camera->lens_ray(u, v, out.sample_number, chosen.lens[0], chosen.lens[1]);
  } else {
    frame_.camera->ray(u, v, out.ray);
  }
  out.ray.time = frame_.camera->time(frame_.shading.frame, out.sample_number, chosen.moment);
}

void BlockRenderer::trace_range(std::size_t first, std::size_t count) {
  tree_.trace(std::span(samples_.begin(), samples_.end()).subspan(first, count),
              std::span(results_).subspan(first, count));
}

/// Traces samples_ into results_; one by one and timed where costs are wanted.
void BlockRenderer::trace_samples() {
  results_.resize(samples_.size());
  if (!frame_.cost) {
    trace_range(0, samples_.size());
    return;
  }
  costs_.resize(samples_.size());
  const auto queries = [&] { return tree_.counts().queries(); };
  const auto in_trees = [&] { return tree_.scratch().trees ? tree_.scratch().trees->rays() : 0; };
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const std::uint64_t queries_before = queries(), in_trees_before = in_trees();
    const auto start = std::chrono::steady_clock::now();
    trace_range(i, 1);
    const auto end = std::chrono::steady_clock::now();
    costs_[i] = {std::chrono::duration<float, std::micro>(end - start).count(),
                 static_cast<float>(queries() - queries_before),
                 static_cast<float>(in_trees() - in_trees_before)};
  }
}

void BlockRenderer::note_layer(const SampleResult& result, BlockPixels::Layer& layer) const {
  layer.depth = result.hit ? static_cast<float>(result.distance) : std::numeric_limits<float>::infinity();
  for (int axis = 0; axis < 3; ++axis)
    layer.normal[axis] = result.hit ? static_cast<float>(result.normal[axis]) : 0.0f;
  layer.object =
      result.hit && !frame_.numbers.empty() ? static_cast<float>(frame_.numbers[result.leaf]) : 0.0f;
}

void BlockRenderer::add_cost(const SampleResult& result, const SampleCost* cost, BlockPixels::Layer& layer) {
  layer.tests += static_cast<float>(result.tests);
  layer.bounds_tests += static_cast<float>(result.bounds_tests);
  if (!cost) return;
  layer.microseconds += cost->microseconds;
  layer.rays += cost->rays;
  layer.tree_rays += cost->tree_rays;
}

void BlockRenderer::render_single(const PixelRect& rect) {
  samples_.clear();
  TileOrder(rect).each([&](int x, int y) { take_sample(x, y, chosen_sample(x, y)); });
  trace_samples();
}

void BlockRenderer::render(const PixelRect& rect, BlockPixels& out) {
  const RenderSettings& settings = *frame_.shading.settings;
  const bool layered = frame_.layers || frame_.cost;
  const std::size_t pixels = static_cast<std::size_t>(rect.width()) * rect.height();
  out.rect = rect;
  out.rgba.resize(4 * pixels);
  out.layers.assign(layered ? pixels : 0, {});
  ++counts_.blocks;
  counts_.pixels += pixels;
  if (settings.sobol()) {
    render_until_exact(rect, out);
    return;
  }

  // Single samples, with the halo that refinement looks at.
  const bool refine = frame_.grid->count() > 1;
  const PixelRect outer = refine ? halo(rect, kRefinementReach, settings.width, settings.height) : rect;
  render_single(outer);
  std::swap(results_, single_);  // not moved: the next block finds its memory here
  std::swap(costs_, single_costs_);
  const std::vector<SampleResult>& single = single_;
  counts_.halo_samples += single.size() - pixels;
  const TileOrder order(outer);
  std::vector<bool> full;
  if (refine) {
    std::vector<Color> colors(single.size());
    std::size_t i = 0;
    order.each([&](int x, int y) { colors[outer.index(x, y)] = single[i++].color; });
    full = choose_full(rect, colors, settings.contrast, settings.width, settings.height);
  }

  std::size_t i = 0;
  order.each([&](int x, int y) {
    const std::size_t own = i++;
    if (!rect.contains(x, y)) return;
    const SampleResult& one = single[own];
    const std::size_t index = rect.index(x, y);
    store_pixel(&out.rgba[4 * index], one.color, one.hit && !frame_.sample_map ? 1.0 : 0.0);
    if (layered) {
      BlockPixels::Layer& layer = out.layers[index];
      note_layer(one, layer);
      layer.samples = 1;
      add_cost(one, frame_.cost ? &single_costs_[own] : nullptr, layer);
    }
  });
  if (!refine) {
    for (int y = rect.y0; y < rect.y1; ++y) {
      for (int x = rect.x0; x < rect.x1; ++x) {
        const bool border = x == 0 || y == 0 || x == settings.width - 1 || y == settings.height - 1;
        counts_.supersampled += border;
        if (border && frame_.sample_map) {
          out.rgba[4 * (static_cast<std::size_t>(y - rect.y0) * rect.width() + (x - rect.x0)) + 3] = 1;
        }
      }
    }
    return;
  }

  // The other samples of the pixels that need them, in chunks of whole pixels.
  const int count = frame_.grid->count();
  std::vector<std::size_t> chosen;
  const auto flush = [&] {
    trace_samples();
    const SampleResult* result = results_.data();
    const SampleCost* cost = costs_.data();
    for (const std::size_t p : chosen) {
      const int x = rect.x0 + static_cast<int>(p % static_cast<std::size_t>(rect.width()));
      const int y = rect.y0 + static_cast<int>(p / static_cast<std::size_t>(rect.width()));
      const int reused = chosen_sample(x, y);
      const SampleResult& one = single[order.index(x, y)];
      Color sum;
      double alpha = 0;
      for (int k = 0; k < count; ++k) {
        const SampleResult& sample = k == reused ? one : *result++;
        const double weight = frame_.grid->weight(k);
        sum += weight * sample.color;
        alpha += sample.hit ? weight : 0.0;
        if (!layered || k == reused) continue;
        add_cost(sample, frame_.cost ? cost++ : nullptr, out.layers[p]);
      }
      store_pixel(&out.rgba[4 * p], sum, frame_.sample_map ? 1.0 : alpha);
      if (layered) out.layers[p].samples = static_cast<float>(count);
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
  trace_samples();
  tree_.set_observer(nullptr);
}

}  // namespace rayshade
