// SPDX-License-Identifier: MIT
// Between the rendering threads of a rank and the thread that talks to other ranks: blocks in, pixels out.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <span>
#include <vector>

#include "rayshade/render/block_feed.h"

namespace pafas {

/// Seconds since the process began to measure; never goes back.
double seconds_now();

class QueueFeed final : public rayshade::BlockFeed {
 public:
  struct Finished {
    rayshade::Block block;
    rayshade::EncodedBlock pixels;
    rayshade::BlockCost cost;
    double begin = 0, end = 0;  ///< by seconds_now()
  };
  struct State {
    std::size_t queued = 0;    ///< nobody renders them yet
    std::size_t rendered = 0;  ///< at this moment
    std::size_t finished = 0;  ///< and not taken
  };

  void add(std::span<const rayshade::Block> blocks);
  std::vector<Finished> take_finished();
  State state() const;
  /// Waits until something happens: a block is finished, or a thread has nothing to do; at most so many
  /// seconds.
  void wait_for_news(double seconds);
  /// Seconds that threads have waited for blocks, their sum.
  double waited() const;

  std::optional<rayshade::Block> next() override;
  void finished(const rayshade::Block& block, rayshade::EncodedBlock&& pixels,
                const rayshade::BlockCost& cost) override;
  void close() override;

 private:
  mutable std::mutex mutex_;
  std::condition_variable work_, news_;
  std::deque<rayshade::Block> queue_;
  std::vector<Finished> finished_;
  std::vector<std::pair<std::int64_t, double>> begun_;  ///< number and time of those being rendered
  bool closed_ = false, has_news_ = false;
  double waited_ = 0;
};

}  // namespace pafas
