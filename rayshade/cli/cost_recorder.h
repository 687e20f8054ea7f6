// SPDX-License-Identifier: MIT
// What the blocks of a frame took, gathered while it is rendered, for --block-costs.
#pragma once

#include <functional>

#include "rayshade/render/frame_job.h"
#include "rayshade/render/renderer.h"
#include "rayshade/schedule/block_costs.h"

namespace rayshade {

class CostRecorder {
 public:
  /// As FrameJob::cost. Forgets what was recorded of another frame.
  std::function<void(const Block&, const BlockCost&)> of_frame();
  /// What was recorded, of a picture of this form. Throws BlockCostsError where blocks are missing (a part of
  /// the picture was there before).
  BlockCosts costs(const RenderSettings& settings, const PictureFormat& format,
                   const RenderStatistics& statistics, double parse_seconds, std::uint64_t scene_bytes) const;

 private:
  std::vector<Block> blocks_;
  std::vector<double> seconds_;
};

}  // namespace rayshade
