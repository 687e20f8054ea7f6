// SPDX-License-Identifier: MIT
// Pictures as textures (textures.md 6): look-up, tiling, and what each component does to a surface.
#pragma once

#include <cstdint>
#include <vector>

#include "rayshade/math/vec.h"
#include "rayshade/scene/surface.h"
#include "rayshade/scene/texture.h"

namespace rayshade {

/// Colour and coverage at a point of a picture.
struct Texel {
  Color color;  ///< the three are equal for grey pictures
  double alpha = 1;
};

/// A picture in memory. Row 0 belongs to v = 0, column 0 to u = 0; samples are code values in 0 .. maximum.
class TextureImage {
 public:
  /// `samples` holds height rows of width pixels of (channels + has_alpha) samples, alpha last. `channels` is
  /// 1 or 3, width and height at least 1.
  TextureImage(std::uint32_t width, std::uint32_t height, int channels, bool has_alpha, int maximum,
               std::vector<std::uint16_t> samples);

  std::uint32_t width() const { return width_; }
  std::uint32_t height() const { return height_; }
  int channels() const { return channels_; }
  bool has_alpha() const { return has_alpha_; }
  std::uint64_t bytes() const { return wide_.size() * 2 + narrow_.size(); }

  /// A place in the picture: pixel, and fractions toward the next column and row.
  struct Position {
    std::uint32_t x = 0, y = 0;
    double fx = 0, fy = 0;
  };
  /// Any u, v; the picture repeats with period 1.
  Position locate(double u, double v) const;
  /// Position of the next column (row), around the edge, with the same fractions.
  Position right_of(Position p) const;
  Position above(Position p) const;
  /// The pixel, or with `smooth` the bilinear mean of it and its neighbours to the right and above.
  Texel at(const Position& p, bool smooth) const;

 private:
  Texel pixel(std::uint32_t x, std::uint32_t y) const;
  double sample(std::size_t index) const { return narrow_.empty() ? wide_[index] : narrow_[index]; }

  std::uint32_t width_, height_;
  int channels_;
  bool has_alpha_;
  double maximum_;
  std::vector<std::uint8_t> narrow_;  ///< when maximum is at most 255
  std::vector<std::uint16_t> wide_;   ///< otherwise
};

/// Whether `tile tu tv` draws the picture at (u, v), before wrapping.
bool tile_draws(double u, double v, double tu, double tv);

/// Whether a component takes pictures of that many channels: colours 1 or 3, numbers 1.
bool component_takes(ImageComponent component, int channels);

/// Changes a surface by a texel (not for kBump): the named component multiplied, then mixed in by alpha.
/// `replacement` is the textsurf, used when no component is named; null without.
void apply_texel(const Texel& texel, const ImageOptions& options, const Surface* replacement,
                 Surface& surface);

}  // namespace rayshade
