// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <deque>
#include <set>
#include <string>
#include <vector>

#include "rayshade/schedule/block_grid.h"
namespace rayshade {
struct WorkBookOptions {
  std::string schedule, starts;
  int granularity = 0, workers = 1, block_side = 0;
};
class WorkBook {
 public:
  WorkBook(int w, int h, const WorkBookOptions& o)
      : grid_(w, h, o.block_side > 0 ? o.block_side : default_block_side(w, h, o.workers)),
        state_(static_cast<std::size_t>(grid_.count())), owner_(state_.size()) {
    missing_ = grid_.count();
    for (std::int64_t i = 0; i < grid_.count(); ++i) todo_.push_back(i);
  }
  std::string schedule_name() const { return "stub"; }
  std::int64_t count() const { return grid_.count(); }
  Block block(std::int64_t i) const { return grid_.block(i); }
  void skip(std::int64_t i) { state_[static_cast<std::size_t>(i)] = 2; --missing_; }
  std::int64_t missing() const { return missing_; }
  std::int64_t leased() const { return 1; }
  bool complete() const { return missing_ == 0; }
  bool finished(std::int64_t i, int, double, double) {
    auto& s = state_[static_cast<std::size_t>(i)];
    if (s == 2) return false;
    s = 2; --missing_; return true;
  }
  void lost(int w) {
    for (std::int64_t i = 0; i < count(); ++i)
      if (state_[static_cast<std::size_t>(i)] == 1 && owner_[static_cast<std::size_t>(i)] == w) { state_[static_cast<std::size_t>(i)] = 0; todo_.push_front(i); }
  }
  std::vector<Block> take(int worker, int threads, double) {
    std::vector<Block> out;
    const std::size_t n = static_cast<std::size_t>(std::clamp<std::int64_t>(static_cast<std::int64_t>(todo_.size()) / 8, threads, 100));
    while (out.size() < n && !todo_.empty()) {
      const auto i = todo_.front(); todo_.pop_front();
      auto& s = state_[static_cast<std::size_t>(i)];
      if (s != 0) continue;
      s = 1; owner_[static_cast<std::size_t>(i)] = worker; out.push_back(block(i));
    }
    return out;
  }
 private:
  BlockGrid grid_;
  std::vector<int> state_, owner_;
  std::deque<std::int64_t> todo_;
  std::int64_t missing_ = 0;
};
}
