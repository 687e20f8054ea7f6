// SPDX-License-Identifier: MIT
// Where the threads that render a frame get their blocks, and where finished ones go: a counter and a picture
// on one machine, queues that messages fill and empty on a cluster.
#pragma once

#include <optional>

#include "rayshade/image/frame_buffer.h"
#include "rayshade/schedule/block_grid.h"

namespace rayshade {

/// What a block took.
struct BlockCost {
  double seconds = 0;  ///< processor time of the thread
};

/// All calls may come from any thread at any time.
class BlockFeed {
 public:
  virtual ~BlockFeed() = default;
  /// The next block for the calling thread; it may be waited for. Empty: this frame has no more for it.
  virtual std::optional<Block> next() = 0;
  /// Takes a finished block.
  virtual void finished(const Block& block, EncodedBlock&& pixels, const BlockCost& cost) = 0;
  /// From now on next() is empty, also for those who wait in it.
  virtual void close() = 0;
};

}  // namespace rayshade
