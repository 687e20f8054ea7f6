// SPDX-License-Identifier: MIT
#include "rayshade/schedule/cost_order.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace rayshade {
namespace {

constexpr int kSide = CostForecast::kCellSide;

/// Orders the cells so that any beginning of the order is spread over the picture: the bits of column and row
/// are read from the lowest to the highest.
std::uint64_t spread_key(std::uint32_t column, std::uint32_t row, int bits) {
  std::uint64_t key = 0;
  for (int i = 0; i < bits; ++i)
    key = key << 2 | std::uint64_t{(column ^ row) >> i & 1} << 1 | std::uint64_t{row >> i & 1};
  return key;
}

}  // namespace

CostOrder::CostOrder(const BlockGrid& grid, const CostForecast& forecast) : grid_(grid), forecast_(forecast) {
  const int columns = forecast.cell_columns(), rows = forecast.cell_rows();
  const int bits = std::bit_width(static_cast<std::uint32_t>(std::max(columns, rows)));
  std::vector<std::pair<std::uint64_t, std::int64_t>> order;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int width = std::min(kSide, grid.columns() - column * kSide);
      const int height = std::min(kSide, grid.rows() - row * kSide);
      cells_.push_back({0, static_cast<std::uint8_t>(width * height), 0});
      order.emplace_back(
          spread_key(static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row), bits),
          static_cast<std::int64_t>(order.size()));
    }
  }
  std::sort(order.begin(), order.end());
  for (const auto& [key, cell] : order) survey_.push_back(cell);
}

std::int64_t CostOrder::next(int /*worker*/) {
  if (surveyed_ < survey_.size()) return give(survey_[surveyed_++]);
  while (!queue_.empty()) {
    const Entry top = queue_.top();
    if (top.version == cells_[static_cast<std::size_t>(top.cell)].version) return give(top.cell);
    queue_.pop();
  }
  return -1;
}

void CostOrder::learned(std::int64_t number) {
  const std::int64_t cell = forecast_.cell_of(number);
  // Cells that have not been surveyed have their turn anyway.
  if (cells_[static_cast<std::size_t>(cell)].given > 0) enqueue(cell);
}

std::int64_t CostOrder::give(std::int64_t number) {
  Cell& cell = cells_[static_cast<std::size_t>(number)];
  const std::int64_t block = block_of(number, cell.given++);
  if (cell.given == 1)
    enqueue(number);
  else if (cell.given == cell.blocks)
    ++cell.version;
  return block;
}

void CostOrder::enqueue(std::int64_t number) {
  Cell& cell = cells_[static_cast<std::size_t>(number)];
  ++cell.version;
  if (cell.given < cell.blocks) queue_.push({forecast_.per_pixel(number), number, cell.version});
}

std::int64_t CostOrder::block_of(std::int64_t cell, int i) const {
  const int column = static_cast<int>(cell % forecast_.cell_columns()) * kSide;
  const int row = static_cast<int>(cell / forecast_.cell_columns()) * kSide;
  const int width = std::min(kSide, grid_.columns() - column), height = std::min(kSide, grid_.rows() - row);
  const int middle = height / 2 * width + width / 2;
  const int place = i == 0 ? middle : (i <= middle ? i - 1 : i);
  return (std::int64_t{row} + place / width) * grid_.columns() + column + place % width;
}

}  // namespace rayshade
