// SPDX-License-Identifier: MIT
#include "rayshade/schedule/block_grid.h"

#include <algorithm>

namespace rayshade {

BlockGrid::BlockGrid(int width, int height, int side) : BlockGrid(width, height, side, side) {}

BlockGrid::BlockGrid(int width, int height, int block_width, int block_height)
    : width_(width),
      height_(height),
      block_width_(std::max(1, block_width)),
      block_height_(std::max(1, block_height)),
      columns_((width_ - 1) / block_width_ + 1),
      rows_((height_ - 1) / block_height_ + 1) {}

Block BlockGrid::block(std::int64_t number) const {
  const int column = static_cast<int>(number % columns_), row = static_cast<int>(number / columns_);
  const int x = column * block_width_, y = row * block_height_;
  return {number, x, y, std::min(block_width_, width_ - x), std::min(block_height_, height_ - y)};
}

int default_block_side(int width, int height, int workers) {
  const double pixels = static_cast<double>(width) * height;
  int side = 64;
  while (side > 16 && pixels / (static_cast<double>(side) * side) < 12.0 * workers) side /= 2;
  return side;
}

}  // namespace rayshade
