// SPDX-License-Identifier: MIT
// Which pixels get all their samples (shading.md 7.5), decided without an order of scan.
//
// The original refines row by row while it renders: where the contrast over a pixel and its four neighbours
// (a "plus") is too large, it fully samples these five at once, and goes on with the new values. So its
// choice depends on the order of scan and on every random draw before. Ours has the same effect, from single
// samples and two synchronous rounds alone:
//
//   1. A pixel is *active* if the contrast test holds over the single samples of its plus.
//   2. Pixels have one of five classes, (x + 2 y) mod 5, so that the five of any plus differ. An active pixel
//   assumes
//      that all active pixels of lower classes have had their pluses fully sampled, and tests again, taking
//      for each pixel so sampled the mean of the 13 single samples within two pixels of it, an estimate of
//      its full value. If the test still holds, the pixel *fires*.
//
// Fully sampled are the pluses of the pixels that fire, and the border of the screen (where no test is made).
// A lone odd sample in a calm region costs five full pixels, as in the original, and an edge gets the pixels
// on both of its sides. The choice for a pixel depends on single samples no farther than kRefinementReach
// away, rows and columns added: any tile, window or crop gives the same bytes at the price of a halo of
// single samples.
#pragma once

#include <span>
#include <vector>

#include "rayshade/math/vec.h"

namespace rayshade {

/// One for the plus of the pixel that fires, one for the plus that it tests, and two more for the estimates
/// there; an active pixel of a lower class that reaches into that plus, and what it tests, is no farther.
inline constexpr int kRefinementReach = 4;

/// A rectangle of pixels in screen coordinates, [x0, x1) x [y0, y1).
struct PixelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool contains(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - y0) * static_cast<std::size_t>(width()) +
           static_cast<std::size_t>(x - x0);
  }
  std::size_t area() const { return static_cast<std::size_t>(width()) * static_cast<std::size_t>(height()); }
};

/// `rect` grown by `margin` on all sides, within the screen.
PixelRect halo(const PixelRect& rect, int margin, int screen_width, int screen_height);

/// The contrast test over five colours (shading.md 7.5): some channel has max + min > EPS and
/// (max - min) / (max + min) > threshold. Unclamped values before gamma.
bool contrast_exceeds(std::span<const Color, 5> colors, const Color& threshold);

/// For each pixel of `rect`, row by row, whether it is fully sampled. `single` holds the single samples of
/// halo(rect, kRefinementReach), row by row; only those within the reach matter.
std::vector<bool> choose_full(const PixelRect& rect, std::span<const Color> single, const Color& threshold,
                              int screen_width, int screen_height);

}  // namespace rayshade
