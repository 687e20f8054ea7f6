// SPDX-License-Identifier: MIT
// Which blocks of a grid nobody has been given, by place: finds the first of them in the ring pattern around
// a start without walking over the others.
//
// A pyramid of bits: level 0 has one per block, each level above one per 2 x 2 of that below, set while any
// of them is. A search opens those boxes first that may hold the block that comes first.
#pragma once

#include <cstdint>
#include <vector>

namespace rayshade {

class FreeBlocks {
 public:
  /// All are free.
  FreeBlocks(int columns, int rows);

  bool contains(int column, int row) const {
    return levels_[0].bits[static_cast<std::size_t>(row) * levels_[0].columns + column] != 0;
  }
  bool empty() const { return levels_.back().bits[0] == 0; }
  /// Removing what is not there changes nothing.
  void remove(int column, int row);
  /// The number (row by row) of the free block that comes first in the ring pattern around a start; -1: none.
  std::int64_t first_around(int column, int row) const;

 private:
  struct Level {
    int columns = 0, rows = 0;
    std::vector<std::uint8_t> bits;
  };
  std::vector<Level> levels_;
};

}  // namespace rayshade
