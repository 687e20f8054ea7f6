// SPDX-License-Identifier: MIT
// The order in which the pixels of a block are sampled: small squares one after the other, so that the rays
// of a pack, and the hits that they bring, are near each other in both directions.
#pragma once

#include <algorithm>
#include <cstddef>

#include "rayshade/sampling/refine.h"

namespace rayshade {

class TileOrder {
 public:
  static constexpr int kSide = 8;  ///< a square fills a pack

  explicit TileOrder(const PixelRect& rect) : rect_(rect) {}

  /// Calls `f(x, y)` for every pixel.
  template <class F>
  void each(const F& f) const {
    for (int y0 = rect_.y0; y0 < rect_.y1; y0 += kSide) {
      const int y1 = std::min(y0 + kSide, rect_.y1);
      for (int x0 = rect_.x0; x0 < rect_.x1; x0 += kSide) {
        const int x1 = std::min(x0 + kSide, rect_.x1);
        for (int y = y0; y < y1; ++y) {
          for (int x = x0; x < x1; ++x) f(x, y);
        }
      }
    }
  }
  /// The how manieth pixel (x, y) is.
  std::size_t index(int x, int y) const {
    const int column = x - rect_.x0, row = y - rect_.y0;
    const int left = column / kSide * kSide, above = row / kSide * kSide;
    const int width = std::min(kSide, rect_.width() - left), height = std::min(kSide, rect_.height() - above);
    return static_cast<std::size_t>(above) * static_cast<std::size_t>(rect_.width()) +
           static_cast<std::size_t>(left * height + (row - above) * width + (column - left));
  }

 private:
  PixelRect rect_;
};

}  // namespace rayshade
