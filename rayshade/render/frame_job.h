// SPDX-License-Identifier: MIT
// One frame to be rendered: into which picture, and who is told.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

#include "rayshade/render/block_feed.h"

namespace rayshade {

/// How far a frame is.
struct FrameProgress {
  std::int64_t blocks_done = 0, blocks = 0;  ///< of those rendered in this run
  std::int64_t pixels_done = 0, pixels = 0;
  std::int64_t pixels_before = 0;  ///< of pixels_done: there when this run began
  std::int64_t rows_done = 0;      ///< rows of the window that are complete from the top
};

struct FrameJob {
  int frame = 0;
  /// Of the size of the window. What has arrived in it before is not rendered again.
  FrameBuffer& picture;
  /// When it becomes true, the blocks at hand are finished and no more are begun.
  const std::atomic<bool>& stop;
  /// Called from the calling thread, a few times per second; may be empty.
  std::function<void(const FrameProgress&)> progress = {};
  /// Told of every finished block before the picture gets it, from any thread, never by two at once; may be
  /// empty.
  std::function<void(const EncodedBlock&)> keep = {};
  /// Told what it took, in the same way.
  std::function<void(const Block&, const BlockCost&)> cost = {};
};

}  // namespace rayshade
