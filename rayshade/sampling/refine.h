// SPDX-License-Identifier: MIT
// Which pixels get all their samples (shading.md 7.5), decided without an order of scan.
//
// The original refines row by row while it renders, so its choice depends on the order of scan and on every random draw
// before. Ours takes two synchronous rounds over single samples. Round one: a pixel is *active* if the contrast test
// holds over the single samples of the pixel and its four neighbours. Round two: a pixel is fully sampled if it or one
// of its four neighbours is active. Pixels on the border of the screen always are (and the test is not made there).
// The choice for a pixel depends on single samples no farther than kRefinementReach away, in rows and columns added:
// any tile, window or crop gives the same bytes at the price of a halo of single samples.
#pragma once

#include <span>
#include <vector>

#include "rayshade/math/vec.h"

namespace rayshade {

inline constexpr int kRefinementReach = 2;

/// A rectangle of pixels in screen coordinates, [x0, x1) x [y0, y1).
struct PixelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool contains(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
};

/// `rect` grown by `margin` on all sides, within the screen.
PixelRect halo(const PixelRect& rect, int margin, int screen_width, int screen_height);

/// The contrast test over five colours (shading.md 7.5): some channel has max + min > EPS and
/// (max - min) / (max + min) > threshold. Unclamped values before gamma.
bool contrast_exceeds(std::span<const Color, 5> colors, const Color& threshold);

/// For each pixel of `rect`, row by row, whether it is fully sampled. `single` holds the single samples of
/// halo(rect, kRefinementReach), row by row; only those within the reach are looked at.
std::vector<bool> choose_full(const PixelRect& rect, std::span<const Color> single, const Color& threshold,
                              int screen_width, int screen_height);

}  // namespace rayshade
