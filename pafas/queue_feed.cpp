// SPDX-License-Identifier: MIT
#include "pafas/queue_feed.h"

#include <algorithm>
#include <utility>

namespace pafas {

double seconds_now() {
  using Clock = std::chrono::steady_clock;
  static const Clock::time_point start = Clock::now();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void QueueFeed::add(std::span<const rayshade::Block> blocks) {
  const std::lock_guard lock(mutex_);
  queue_.insert(queue_.end(), blocks.begin(), blocks.end());
  work_.notify_all();
}

std::vector<QueueFeed::Finished> QueueFeed::take_finished() {
  const std::lock_guard lock(mutex_);
  return std::exchange(finished_, {});
}

QueueFeed::State QueueFeed::state() const {
  const std::lock_guard lock(mutex_);
  return {queue_.size(), begun_.size(), finished_.size()};
}

void QueueFeed::wait_for_news(double seconds) {
  std::unique_lock lock(mutex_);
  news_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return has_news_; });
  has_news_ = false;
}

double QueueFeed::waited() const {
  const std::lock_guard lock(mutex_);
  return waited_;
}

std::optional<rayshade::Block> QueueFeed::next() {
  std::unique_lock lock(mutex_);
  if (queue_.empty() && !closed_) {
    has_news_ = true;
    news_.notify_all();
    const double start = seconds_now();
    work_.wait(lock, [&] { return closed_ || !queue_.empty(); });
    waited_ += seconds_now() - start;
  }
  if (closed_) return {};
  const rayshade::Block block = queue_.front();
  queue_.pop_front();
  begun_.emplace_back(block.number, seconds_now());
  return block;
}

void QueueFeed::finished(const rayshade::Block& block, rayshade::EncodedBlock&& pixels,
                         const rayshade::BlockCost& cost) {
  const std::lock_guard lock(mutex_);
  const auto begun = std::find_if(begun_.begin(), begun_.end(),
                                  [&](const auto& entry) { return entry.first == block.number; });
  finished_.push_back({block, std::move(pixels), cost, begun->second, seconds_now()});
  begun_.erase(begun);
  has_news_ = true;
  news_.notify_all();
}

void QueueFeed::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  queue_.clear();
  work_.notify_all();
  news_.notify_all();
}

}  // namespace pafas
