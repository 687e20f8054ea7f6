// SPDX-License-Identifier: MIT
// The blocks of a picture in order, for the threads of one machine.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <vector>

#include "rayshade/render/block_feed.h"
#include "rayshade/render/frame_job.h"

namespace rayshade {

/// Hands out the blocks of which not all pixels have arrived, and puts finished ones into the picture.
class PictureFeed final : public BlockFeed {
 public:
  PictureFeed(const FrameJob& job, int block_side);

  std::optional<Block> next() override;
  void finished(const Block& block, EncodedBlock&& pixels, const BlockCost& cost) override;
  void close() override { closed_.store(true, std::memory_order_relaxed); }

  /// Blocks that are still to be rendered.
  std::int64_t missing() const { return static_cast<std::int64_t>(blocks_.size()); }
  FrameProgress progress();

 private:
  const FrameJob& job_;
  int side_;
  std::vector<Block> blocks_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> closed_{false};
  std::mutex mutex_;  ///< of what follows, and of job_.keep
  FrameProgress progress_;
};

}  // namespace rayshade
