// SPDX-License-Identifier: MIT
// The threads that render the blocks of one frame, wherever those come from.
#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "rayshade/render/block_feed.h"
#include "rayshade/render/block_renderer.h"
#include "rayshade/render/statistics.h"

namespace rayshade {

/// The form in which finished blocks are handed on.
struct PictureFormat {
  PixelStorage storage = PixelStorage::kByte;
  ColorEncoding encoding;
  std::vector<std::string> layers;  ///< names as in FrameBufferOptions

  bool operator==(const PictureFormat&) const = default;
};

PictureFormat format_of(const FrameBuffer& picture);

class FrameCrew {
 public:
  struct Job {
    const FrameScene& frame;  ///< prepared, and left alone until the crew has ended
    const RenderSettings& settings;
    PictureFormat format;
    BlockFeed& feed;
    int threads = 1;
    bool brute_force = false;
    RenderStatistics& statistics;  ///< each thread adds its counts when it ends
  };
  /// Starts the threads. Throws std::invalid_argument for a layer that nobody knows.
  explicit FrameCrew(const Job& job);
  /// Closes the feed and joins the threads.
  ~FrameCrew();
  FrameCrew(const FrameCrew&) = delete;
  FrameCrew& operator=(const FrameCrew&) = delete;

  /// Waits until all threads have ended, at most so many seconds. Returns whether they have.
  bool wait(double seconds);
  /// Joins the threads, which end when the feed does. Throws what the first of them threw, if one did: it
  /// closed the feed.
  void finish();

 private:
  void work();
  void render_blocks(BlockRenderer& renderer);

  Job job_;
  ColorEncoder encoder_;
  std::mutex mutex_;
  std::condition_variable ended_;
  int working_ = 0;
  std::exception_ptr error_;
  std::vector<std::thread> threads_;
};

}  // namespace rayshade
