// SPDX-License-Identifier: MIT
#include "rayshade/schedule/round_robin.h"

#include <algorithm>

namespace rayshade {

RoundRobin::RoundRobin(std::int64_t blocks, int workers)
    : blocks_(blocks), workers_(static_cast<int>(std::clamp<std::int64_t>(workers, 1, blocks))) {
  for (int owner = 0; owner < workers_; ++owner) {
    next_.push_back(owner);
    place_.push_back(owner);
    at_rest_.push_back(owner);
  }
}

std::int64_t RoundRobin::next(int worker) {
  if (worker < workers_ && next_[static_cast<std::size_t>(worker)] < blocks_) return take(worker);
  return at_rest_.empty() ? -1 : take(at_rest_.back());
}

void RoundRobin::rest(int worker, bool at_rest) {
  if (worker >= workers_) return;
  set_listed(worker, at_rest && next_[static_cast<std::size_t>(worker)] < blocks_);
}

std::int64_t RoundRobin::take(int owner) {
  std::int64_t& next = next_[static_cast<std::size_t>(owner)];
  const std::int64_t number = next;
  next += workers_;
  if (next >= blocks_) set_listed(owner, false);
  return number;
}

void RoundRobin::set_listed(int owner, bool listed) {
  int& place = place_[static_cast<std::size_t>(owner)];
  if (listed == (place >= 0)) return;
  if (listed) {
    place = static_cast<int>(at_rest_.size());
    at_rest_.push_back(owner);
    return;
  }
  const int moved = at_rest_.back();
  at_rest_[static_cast<std::size_t>(place)] = moved;
  place_[static_cast<std::size_t>(moved)] = place;
  at_rest_.pop_back();
  place = -1;
}

}  // namespace rayshade
