// SPDX-License-Identifier: MIT
#include "rayshade/cli/cost_recorder.h"

namespace rayshade {

std::function<void(const Block&, const BlockCost&)> CostRecorder::of_frame() {
  blocks_.clear();
  seconds_.clear();
  return [this](const Block& block, const BlockCost& cost) {
    blocks_.push_back(block);
    seconds_.push_back(cost.seconds);
  };
}

BlockCosts CostRecorder::costs(const RenderSettings& settings, const PictureFormat& format,
                               const RenderStatistics& statistics, double parse_seconds,
                               std::uint64_t scene_bytes) const {
  BlockCosts out;
  out.width = settings.window_width();
  out.height = settings.window_height();
  out.samples = settings.samples;
  out.scene_bytes = scene_bytes;
  out.compile_seconds = parse_seconds + statistics.compile_seconds;
  out.result_bytes_per_pixel =
      static_cast<double>(pixel_size(format.storage) + sizeof(float) * format.layers.size());
  for (const ClassReport& c : statistics.intersector.classes)
    out.tree_region_seconds += 1e-9 * static_cast<double>(c.in_tree.nanoseconds);
  std::int64_t pixels = 0;
  for (const Block& block : blocks_) {
    out.side = std::max(out.side, block.width);
    pixels += block.pixels();
  }
  if (pixels != std::int64_t{out.width} * out.height)
    throw BlockCostsError(
        "--block-costs: a part of the picture was rendered before, and what it took is not known");
  out.blocks = blocks_;
  out.seconds = seconds_;
  return out;
}

}  // namespace rayshade
