// SPDX-License-Identifier: MIT
#include "rayshade/schedule/cost_forecast.h"

#include <algorithm>
#include <cmath>

namespace rayshade {

CostForecast::CostForecast(const BlockGrid& grid) : grid_(grid) {
  int columns = (grid.columns() + kCellSide - 1) / kCellSide;
  int rows = (grid.rows() + kCellSide - 1) / kCellSide;
  while (true) {
    levels_.push_back({columns, rows, std::vector<Sum>(static_cast<std::size_t>(columns) * rows)});
    if (columns == 1 && rows == 1) break;
    columns = (columns + 1) / 2;
    rows = (rows + 1) / 2;
  }
}

std::int64_t CostForecast::cell_of(std::int64_t number) const {
  const std::int64_t column = number % grid_.columns() / kCellSide,
                     row = number / grid_.columns() / kCellSide;
  return row * cell_columns() + column;
}

void CostForecast::learn(std::int64_t number, double seconds) {
  if (!std::isfinite(seconds) || seconds < 0) return;
  const auto pixels = static_cast<double>(grid_.block(number).pixels());
  const std::int64_t cell = cell_of(number);
  int column = static_cast<int>(cell % cell_columns()), row = static_cast<int>(cell / cell_columns());
  for (Level& level : levels_) {
    Sum& sum = level.cells[static_cast<std::size_t>(row) * level.columns + column];
    sum.seconds += seconds;
    sum.pixels += pixels;
    column /= 2;
    row /= 2;
  }
}

double CostForecast::per_pixel(std::int64_t cell) const {
  int column = static_cast<int>(cell % cell_columns()), row = static_cast<int>(cell / cell_columns());
  for (const Level& level : levels_) {
    const Sum& sum = level.cells[static_cast<std::size_t>(row) * level.columns + column];
    if (sum.pixels > 0) return sum.seconds / sum.pixels;
    column /= 2;
    row /= 2;
  }
  return 0;
}

double CostForecast::seconds(std::int64_t number) const {
  return per_pixel(cell_of(number)) * static_cast<double>(grid_.block(number).pixels());
}

double CostForecast::nearby_seconds(std::int64_t number) const {
  const std::size_t level = std::min<std::size_t>(2, levels_.size() - 1);
  const std::int64_t cell = cell_of(number);
  const std::int64_t column = cell % cell_columns() >> level, row = cell / cell_columns() >> level;
  const Sum& sum = levels_[level].cells[static_cast<std::size_t>(row * levels_[level].columns + column)];
  return sum.pixels > 0 ? sum.seconds / sum.pixels * static_cast<double>(grid_.block(number).pixels()) : 0;
}

double CostForecast::mean_per_pixel() const {
  const Sum& all = levels_.back().cells[0];
  return all.pixels > 0 ? all.seconds / all.pixels : 0;
}

}  // namespace rayshade
