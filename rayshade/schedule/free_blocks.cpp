// SPDX-License-Identifier: MIT
#include "rayshade/schedule/free_blocks.h"

#include <algorithm>
#include <cstdlib>
#include <queue>

#include "rayshade/schedule/ring_pattern.h"

namespace rayshade {
namespace {

/// The smallest absolute difference of `to` and a number in [low, high].
int distance(int low, int high, int to) { return std::max({0, low - to, to - high}); }

struct Box {
  RingRank rank;  ///< that of no block in it is smaller
  int level = 0, column = 0, row = 0;
  bool operator<(const Box& other) const { return other.rank < rank; }
};

}  // namespace

FreeBlocks::FreeBlocks(int columns, int rows) {
  levels_.push_back({columns, rows, {}});
  while (levels_.back().columns > 1 || levels_.back().rows > 1)
    levels_.push_back({(levels_.back().columns + 1) / 2, (levels_.back().rows + 1) / 2, {}});
  for (Level& level : levels_) level.bits.assign(static_cast<std::size_t>(level.columns) * level.rows, 1);
}

void FreeBlocks::remove(int column, int row) {
  for (std::size_t i = 0; i < levels_.size(); ++i, column /= 2, row /= 2) {
    Level& level = levels_[i];
    bool any = false;
    if (i > 0) {
      const Level& below = levels_[i - 1];
      for (int y = 2 * row; y < std::min(2 * row + 2, below.rows); ++y)
        for (int x = 2 * column; x < std::min(2 * column + 2, below.columns); ++x)
          any |= below.bits[static_cast<std::size_t>(y) * below.columns + x] != 0;
    }
    if (any) return;
    level.bits[static_cast<std::size_t>(row) * level.columns + column] = 0;
  }
}

std::int64_t FreeBlocks::first_around(int column, int row) const {
  if (empty()) return -1;
  const auto box = [&](int level, int x, int y) {
    if (level == 0) return Box{ring_rank({x - column, y - row}), level, x, y};
    const int size = 1 << level;
    const int dx = distance(x * size, x * size + size - 1, column);
    const int dy = distance(y * size, y * size + size - 1, row);
    return Box{{std::max(dx, dy), std::min(dx, dy), 0}, level, x, y};
  };
  std::priority_queue<Box> boxes;
  boxes.push(box(static_cast<int>(levels_.size()) - 1, 0, 0));
  while (true) {
    const Box top = boxes.top();  // never empty: a set bit has a set bit below
    if (top.level == 0) return std::int64_t{top.row} * levels_[0].columns + top.column;
    boxes.pop();
    const Level& below = levels_[static_cast<std::size_t>(top.level) - 1];
    for (int y = 2 * top.row; y < std::min(2 * top.row + 2, below.rows); ++y)
      for (int x = 2 * top.column; x < std::min(2 * top.column + 2, below.columns); ++x)
        if (below.bits[static_cast<std::size_t>(y) * below.columns + x]) boxes.push(box(top.level - 1, x, y));
  }
}

}  // namespace rayshade
