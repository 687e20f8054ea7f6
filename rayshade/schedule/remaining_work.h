// SPDX-License-Identifier: MIT
// What the blocks that nobody has been given are expected to cost in all.
#pragma once

#include <cstdint>
#include <vector>

#include "rayshade/schedule/cost_forecast.h"

namespace rayshade {

class RemainingWork {
 public:
  RemainingWork(const BlockGrid& grid, const CostForecast& forecast);
  /// A block is no longer, or again, one of them.
  void remove(std::int64_t number) { change(number, -1); }
  void add(std::int64_t number) { change(number, 1); }
  /// After the forecast has learned of a block.
  void learned(std::int64_t number);
  std::int64_t blocks() const { return blocks_; }
  /// On a thread of speed 1; 0 while nothing is known.
  double seconds() const;

 private:
  struct Cell {
    double pixels = 0, rate = 0;
    bool known = false;
  };
  void change(std::int64_t number, int sign);

  BlockGrid grid_;
  const CostForecast& forecast_;
  std::vector<Cell> cells_;
  std::int64_t blocks_ = 0;
  double known_seconds_ = 0, unknown_pixels_ = 0;
};

}  // namespace rayshade
