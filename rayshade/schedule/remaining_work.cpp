// SPDX-License-Identifier: MIT
#include "rayshade/schedule/remaining_work.h"

#include <algorithm>

namespace rayshade {

RemainingWork::RemainingWork(const BlockGrid& grid, const CostForecast& forecast)
    : grid_(grid),
      forecast_(forecast),
      cells_(static_cast<std::size_t>(forecast.cell_columns()) * forecast.cell_rows()),
      blocks_(grid.count()) {
  const std::int64_t cell_width = std::int64_t{1} * grid.block_width() * CostForecast::kCellSide;
  const std::int64_t cell_height = std::int64_t{1} * grid.block_height() * CostForecast::kCellSide;
  for (int row = 0; row < forecast.cell_rows(); ++row) {
    for (int column = 0; column < forecast.cell_columns(); ++column) {
      const std::int64_t x = std::int64_t{column} * cell_width, y = std::int64_t{row} * cell_height;
      const auto width = static_cast<double>(std::min<std::int64_t>(cell_width, grid.width() - x));
      const auto height = static_cast<double>(std::min<std::int64_t>(cell_height, grid.height() - y));
      cells_[static_cast<std::size_t>(row) * forecast.cell_columns() + column].pixels = width * height;
      unknown_pixels_ += width * height;
    }
  }
}

void RemainingWork::change(std::int64_t number, int sign) {
  Cell& cell = cells_[static_cast<std::size_t>(forecast_.cell_of(number))];
  const double pixels = sign * static_cast<double>(grid_.block(number).pixels());
  blocks_ += sign;
  cell.pixels += pixels;
  if (cell.known)
    known_seconds_ += pixels * cell.rate;
  else
    unknown_pixels_ += pixels;
}

void RemainingWork::learned(std::int64_t number) {
  const std::int64_t index = forecast_.cell_of(number);
  if (!forecast_.knows_cell(index)) return;
  Cell& cell = cells_[static_cast<std::size_t>(index)];
  if (!cell.known) unknown_pixels_ -= cell.pixels;
  const double rate = forecast_.per_pixel(index);
  known_seconds_ += cell.pixels * (cell.known ? rate - cell.rate : rate);
  cell.known = true;
  cell.rate = rate;
}

double RemainingWork::seconds() const {
  return std::max(0.0, known_seconds_ + unknown_pixels_ * forecast_.mean_per_pixel());
}

}  // namespace rayshade
