// SPDX-License-Identifier: MIT
// What blocks are going to cost, from what others have: neighbours in a picture cost alike.
//
// The grid is divided into cells of kCellSide x kCellSide blocks. A cell's cost per pixel is that of its
// finished blocks; where it has none, that of the smallest group of 2 x 2, 4 x 4, ... cells around it that
// has.
#pragma once

#include <cstdint>
#include <vector>

#include "rayshade/schedule/block_grid.h"

namespace rayshade {

class CostForecast {
 public:
  static constexpr int kCellSide = 2;

  explicit CostForecast(const BlockGrid& grid);

  int cell_columns() const { return levels_[0].columns; }
  int cell_rows() const { return levels_[0].rows; }
  std::int64_t cell_of(std::int64_t number) const;

  /// A block took so many seconds on a processor of speed 1. Values that are no costs are not learned.
  void learn(std::int64_t number, double seconds);
  /// Whether it has learned anything.
  bool knows() const { return levels_.back().cells[0].pixels > 0; }
  /// Whether a block of the cell has been learned.
  bool knows_cell(std::int64_t cell) const {
    return levels_[0].cells[static_cast<std::size_t>(cell)].pixels > 0;
  }
  /// Seconds per pixel in a cell; 0 while nothing is known.
  double per_pixel(std::int64_t cell) const;
  /// Seconds for a block.
  double seconds(std::int64_t number) const;
  /// Seconds for a block if it were like the average of some dozens around it, to which several workers will
  /// have contributed; 0 if none of them is known.
  double nearby_seconds(std::int64_t number) const;
  /// Seconds per pixel of all that was learned.
  double mean_per_pixel() const;

 private:
  struct Sum {
    double seconds = 0, pixels = 0;
  };
  struct Level {
    int columns = 0, rows = 0;
    std::vector<Sum> cells;
  };
  BlockGrid grid_;
  std::vector<Level> levels_;
};

}  // namespace rayshade
