// SPDX-License-Identifier: MIT
// Pictures as textures (textures.md 6): look-up, tiling, and what each component does to a surface.
#pragma once

#include <cstdint>

#include "rayshade/image/image.h"
#include "rayshade/math/vec.h"
#include "rayshade/scene/surface.h"
#include "rayshade/scene/texture.h"

namespace rayshade {

/// Colour and coverage at a point of a picture.
struct Texel {
  Color color;  ///< the three are equal for grey pictures
  double alpha = 1;
};

/// A place in a picture: pixel, and fractions toward the next column and row.
struct TexelPosition {
  std::int64_t x = 0, y = 0;
  double fx = 0, fy = 0;
};

/// The place of any (u, v); the picture repeats with period 1.
TexelPosition locate_texel(const Image& image, double u, double v);
/// The place one column to the right (one row above), around the edge, with the same fractions.
TexelPosition texel_right_of(const Image& image, TexelPosition position);
TexelPosition texel_above(const Image& image, TexelPosition position);
/// The pixel, or with `smooth` the bilinear mean of it and its neighbours to the right and above. Pixels sit
/// at the lower left corners of their cells.
Texel texel_at(const Image& image, const TexelPosition& position, bool smooth);

/// Whether `tile tu tv` draws the picture at (u, v), before wrapping.
bool tile_draws(double u, double v, double tu, double tv);

/// Whether a component takes pictures of that many channels: colours 1 or 3, numbers 1.
bool component_takes(ImageComponent component, int channels);

/// Changes a surface by a texel (not for kBump): the named component multiplied, then mixed in by alpha.
/// `replacement` is the textsurf, used when no component is named; null without.
void apply_texel(const Texel& texel, const ImageOptions& options, const Surface* replacement,
                 Surface& surface);

}  // namespace rayshade
