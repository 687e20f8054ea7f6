// SPDX-License-Identifier: MIT
// The picture cut into blocks: squares, or whole scan lines. Pure: no clock, no thread, no random state.
#pragma once

#include <cstdint>

namespace rayshade {

/// A block of pixels relative to the window's corner.
struct Block {
  std::int64_t number = 0;
  int x = 0, y = 0, width = 0, height = 0;

  std::int64_t pixels() const { return std::int64_t{width} * height; }
  bool operator==(const Block&) const = default;
};

/// Rectangles of one size (smaller at the right and bottom edges), numbered row by row.
class BlockGrid {
 public:
  /// Squares of `side` pixels.
  BlockGrid(int width, int height, int side);
  BlockGrid(int width, int height, int block_width, int block_height);
  /// Every scan line of the picture is a block.
  static BlockGrid scan_lines(int width, int height) { return {width, height, width, 1}; }

  std::int64_t count() const { return std::int64_t{columns_} * rows_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  int width() const { return width_; }
  int height() const { return height_; }
  int block_width() const { return block_width_; }
  int block_height() const { return block_height_; }
  /// The block of a number in [0, count()).
  Block block(std::int64_t number) const;

 private:
  int width_, height_, block_width_, block_height_, columns_, rows_;
};

/// A side that gives every worker some dozens of blocks and keeps halos cheap: a power of two from 16 to 64.
int default_block_side(int width, int height, int workers);

}  // namespace rayshade
