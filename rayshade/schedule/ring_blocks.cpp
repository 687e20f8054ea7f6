// SPDX-License-Identifier: MIT
#include "rayshade/schedule/ring_blocks.h"

#include "rayshade/schedule/ring_pattern.h"

namespace rayshade {
namespace {

/// A lone worker finds the next block one step on; in a crowd, or outside the picture, the index finds it
/// sooner.
constexpr int kSteps = 24;

}  // namespace

RingBlocks::RingBlocks(const BlockGrid& grid, StartingBlocks starts, int workers)
    : grid_(grid), starts_(starts), workers_(workers), free_(grid.columns(), grid.rows()) {}

std::int64_t RingBlocks::next(int worker) {
  if (free_.empty()) return -1;
  const std::int64_t start = starting_block(starts_, grid_, worker, workers_);
  const int column = static_cast<int>(start % grid_.columns()),
            row = static_cast<int>(start / grid_.columns());
  std::int64_t& place = place_[worker];
  for (int step = 0; step < kSteps; ++step, ++place) {
    const RingOffset offset = ring_offset(place);
    const int x = column + offset.x, y = row + offset.y;
    if (x < 0 || y < 0 || x >= grid_.columns() || y >= grid_.rows() || !free_.contains(x, y)) continue;
    ++place;
    free_.remove(x, y);
    return std::int64_t{y} * grid_.columns() + x;
  }
  const std::int64_t number = free_.first_around(column, row);
  const int x = static_cast<int>(number % grid_.columns()), y = static_cast<int>(number / grid_.columns());
  place = ring_place({x - column, y - row}) + 1;
  free_.remove(x, y);
  return number;
}

}  // namespace rayshade
