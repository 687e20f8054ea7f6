// SPDX-License-Identifier: MIT
// The picture cut into blocks. Pure: no clock, no thread, no random state.
#pragma once

#include <cstdint>

namespace rayshade {

/// A block of pixels relative to the window's corner.
struct Block {
  std::int64_t number = 0;
  int x = 0, y = 0, width = 0, height = 0;
};

/// Squares of `side` pixels (smaller at the right and bottom edges), numbered row by row.
class BlockGrid {
 public:
  BlockGrid(int width, int height, int side);
  std::int64_t count() const { return std::int64_t{columns_} * rows_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  /// The block of a number in [0, count()).
  Block block(std::int64_t number) const;

 private:
  int width_, height_, side_, columns_, rows_;
};

/// A side that gives every worker some dozens of blocks and keeps halos cheap: a power of two from 16 to 64.
int default_block_side(int width, int height, int workers);

}  // namespace rayshade
