// SPDX-License-Identifier: MIT
// Cost: the most expensive blocks first, so that the last ones are cheap and no worker waits long for
// another.
//
// Nobody knows costs beforehand. So one block of every cell of the forecast (2 x 2 blocks) is rendered first,
// in an order that covers the picture ever more finely; then cells are taken by what a block of theirs is
// expected to cost, and what becomes known meanwhile counts at once. A message takes its blocks from as few
// cells as it can: neighbours share the trees that their rays build.
#pragma once

#include <cstdint>
#include <queue>
#include <vector>

#include "rayshade/schedule/cost_forecast.h"
#include "rayshade/schedule/schedule.h"

namespace rayshade {

class CostOrder final : public Schedule {
 public:
  CostOrder(const BlockGrid& grid, const CostForecast& forecast);
  std::int64_t next(int worker) override;
  void learned(std::int64_t number) override;

 private:
  struct Cell {
    std::uint8_t given = 0, blocks = 0;
    std::uint32_t version = 0;  ///< of its entry in the queue; older ones are void
  };
  struct Entry {
    double cost = 0;
    std::int64_t cell = 0;
    std::uint32_t version = 0;
    bool operator<(const Entry& other) const {
      return cost != other.cost ? cost < other.cost : cell > other.cell;
    }
  };
  std::int64_t give(std::int64_t cell);
  void enqueue(std::int64_t cell);
  /// The block of a cell that is given as its i-th: first one in the middle, then row by row.
  std::int64_t block_of(std::int64_t cell, int i) const;

  BlockGrid grid_;
  const CostForecast& forecast_;
  std::vector<Cell> cells_;
  std::vector<std::int64_t> survey_;  ///< cells in the order of their first blocks
  std::size_t surveyed_ = 0;
  std::priority_queue<Entry> queue_;
};

}  // namespace rayshade
