// SPDX-License-Identifier: MIT
// A picture in memory as textures see it (textures.md 6.1): grey or colour, perhaps with alpha, row 0 at v =
// 0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rayshade {

/// `width` x `height` pixels, each `channels` colour samples followed by alpha if there is one. Row 0 is the
/// visual bottom, except for the raw format, whose file order is kept. Samples are raw code values: no gamma,
/// no profile.
struct Image {
  std::int64_t width = 0, height = 0;
  int channels = 3;  ///< colour channels: 1 or 3
  bool has_alpha = false;
  int depth = 8;  ///< 8, 16: integers in `bytes` or `words`; 32: floats in `floats`
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint16_t> words;
  std::vector<float> floats;

  int samples_per_pixel() const { return channels + (has_alpha ? 1 : 0); }

  /// Sample c of pixel (x, y) as code / 255, code / 65535 or the float itself; c = channels is alpha.
  /// Unchecked.
  double value(std::int64_t x, std::int64_t y, int c) const {
    const std::size_t i = static_cast<std::size_t>((y * width + x) * samples_per_pixel() + c);
    if (depth == 8) return bytes[i] / 255.0;
    return depth == 16 ? words[i] / 65535.0 : static_cast<double>(floats[i]);
  }
  /// Alpha of pixel (x, y), 1 without an alpha channel. Unchecked.
  double alpha(std::int64_t x, std::int64_t y) const { return has_alpha ? value(x, y, channels) : 1.0; }
};

}  // namespace rayshade
