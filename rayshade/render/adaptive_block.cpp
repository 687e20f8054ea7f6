// SPDX-License-Identifier: MIT
// Blocks whose pixels get as many samples as their error needs (sampling/stop.h): first samples with a halo,
// then round after round those pixels of the block that have not enough.
#include <algorithm>
#include <array>

#include "rayshade/render/block_renderer.h"
#include "rayshade/sampling/stop.h"
#include "rayshade/sampling/tile_order.h"

namespace rayshade {

/// Adds samples `from` ... `to` - 1 of a pixel of `rounds.outer` to those to be traced.
void BlockRenderer::take_samples(Rounds& rounds, std::size_t pixel, int from, int to) {
  const auto width = static_cast<std::size_t>(rounds.outer.width());
  const int x = rounds.outer.x0 + static_cast<int>(pixel % width);
  const int y = rounds.outer.y0 + static_cast<int>(pixel / width);
  for (int k = from; k < to; ++k) {
    take_sample(x, y, k);
    rounds.owners.push_back(pixel);
    if (samples_.size() >= kSamplesTogether) trace_round(rounds);
  }
}

/// Traces what was taken and adds it up.
void BlockRenderer::trace_round(Rounds& rounds) {
  traced_.clear();
  trace_samples(traced_);
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const SampleResult& result = traced_.results[i];
    rounds.sums[rounds.owners[i]].add(result.color, result.hit);
    const int x = static_cast<int>(samples_[i].x), y = static_cast<int>(samples_[i].y);
    if (rounds.out.layers.empty() || !rounds.out.rect.contains(x, y)) continue;
    BlockPixels::Layer& layer = rounds.out.layers[rounds.out.rect.index(x, y)];
    if (samples_[i].sample == 0) note_layer(traced_, i, layer);
    layer.samples += 1;
    add_cost(traced_, i, layer);
  }
  samples_.clear();
  rounds.owners.clear();
}

void BlockRenderer::render_until_exact(const PixelRect& rect, BlockPixels& out) {
  const RenderSettings& settings = *frame_.shading.settings;
  const int most = settings.samples * settings.samples;
  const StopRule rule(settings.tolerance, most);
  const bool stops = rule.first() < most;
  Rounds rounds{out, stops ? halo(rect, kStopReach, settings.width, settings.height) : rect, {}, {}};
  const PixelRect& outer = rounds.outer;
  rounds.sums.resize(outer.area());
  samples_.clear();
  TileOrder(outer).each([&](int x, int y) { take_samples(rounds, outer.index(x, y), 0, rule.first()); });
  trace_round(rounds);
  counts_.halo_samples += (outer.area() - rect.area()) * static_cast<std::size_t>(rule.first());

  struct Open {
    std::size_t pixel;  ///< in `outer`
    Color prior;
  };
  std::vector<Open> open;
  std::vector<SampleMoments> moments;
  if (stops) moments = {rounds.sums.begin(), rounds.sums.end()};
  for (int y = rect.y0; stops && y < rect.y1; ++y) {
    const int rows[3] = {std::max(y - 1, 0), y, std::min(y + 1, settings.height - 1)};
    for (int x = rect.x0; x < rect.x1; ++x) {
      const int columns[3] = {std::max(x - 1, 0), x, std::min(x + 1, settings.width - 1)};
      std::array<const SampleMoments*, 9> around;
      std::size_t i = 0;
      for (const int near_y : rows)
        for (const int near_x : columns) around[i++] = &moments[outer.index(near_x, near_y)];
      open.push_back({outer.index(x, y), StopRule::prior(around, rule.first())});
    }
  }
  for (int count = rule.first(); count < most && !open.empty();) {
    std::erase_if(open, [&](const Open& o) { return rule.enough(rounds.sums[o.pixel], o.prior); });
    const int next = rule.next(count);
    for (const Open& o : open) take_samples(rounds, o.pixel, count, next);
    trace_round(rounds);
    count = next;
  }
  counts_.supersampled += stops ? open.size() : rect.area();

  for (int y = rect.y0; y < rect.y1; ++y) {
    for (int x = rect.x0; x < rect.x1; ++x) {
      const SampleSums& pixel = rounds.sums[outer.index(x, y)];
      const double alpha =
          frame_.sample_map ? pixel.count == most : pixel.hits / static_cast<double>(pixel.count);
      store_pixel(&out.rgba[4 * rect.index(x, y)], pixel.mean(), alpha);
    }
  }
}

}  // namespace rayshade
