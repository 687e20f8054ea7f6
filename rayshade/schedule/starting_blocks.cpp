// SPDX-License-Identifier: MIT
#include "rayshade/schedule/starting_blocks.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "rayshade/math/functions.h"

namespace rayshade {
namespace {

/// Place `i` of `count` on a circle whose diameter is a share of the picture's sides.
std::int64_t on_circle(const BlockGrid& grid, double share, int i, int count) {
  const double angle = 2 * fn::kPi * i / std::max(1, count);
  const auto place = [share](int blocks, double direction) {
    const double middle = (blocks - 1) / 2.0;
    return std::clamp(static_cast<int>(std::lround(middle + direction * share * blocks / 2)), 0, blocks - 1);
  };
  const int column = place(grid.columns(), fn::cos(angle)), row = place(grid.rows(), fn::sin(angle));
  return std::int64_t{row} * grid.columns() + column;
}

}  // namespace

StartingBlocks parse_starting_blocks(std::string_view name) {
  if (name == "third") return StartingBlocks::kThird;
  if (name == "half") return StartingBlocks::kHalf;
  if (name == "two-circles" || name.empty()) return StartingBlocks::kTwoCircles;
  throw std::invalid_argument("unknown scheme of starting blocks '" + std::string(name) + "'");
}

std::int64_t starting_block(StartingBlocks scheme, const BlockGrid& grid, int worker, int workers) {
  workers = std::max(1, workers);
  worker %= workers;
  switch (scheme) {
    case StartingBlocks::kThird:
      return on_circle(grid, 1 / 3., worker, workers);
    case StartingBlocks::kHalf:
      return on_circle(grid, 1 / 2., worker, workers);
    case StartingBlocks::kTwoCircles:
      break;
  }
  if (workers <= 8) return on_circle(grid, 1, worker, workers);
  const int inner = workers / 3;
  if (worker % 3 == 2) return on_circle(grid, 1 / 3., worker / 3, inner);
  return on_circle(grid, 1, worker - worker / 3, workers - inner);
}

}  // namespace rayshade
