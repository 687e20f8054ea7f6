// SPDX-License-Identifier: MIT
// Picture files to Image: PNG, PPM and PGM, PFM, Utah RLE, and the original's raw format (textures.md 6.1).
//
// Input is not trusted. Sizes are checked against the length of the file before memory is taken, wherever the
// format allows such a bound; nothing here crashes or reads beyond its input.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "rayshade/image/image.h"

namespace rayshade {

/// A picture that cannot be read; what() is the reason without the file's name ("the data end in row 12 of
/// 64").
struct ImageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

enum class ImageKind : std::uint8_t { kPng, kPnm, kPfm, kRle, kRaw };

/// What the first bytes say; kRaw where no signature is known.
ImageKind detect_image(std::string_view bytes);

/// The most pixels that read_image accepts: 2^28, and fewer where the file's length sets a bound.
inline constexpr std::int64_t kMaxImagePixels = std::int64_t{1} << 28;

/// The (first) picture in `bytes`. Throws ImageError.
Image read_image(std::string_view bytes);

/// What the header of a Utah RLE picture says, and how far its rows go (shading.md 8.3).
struct RleInfo {
  int x = 0, y = 0, width = 0, height = 0;  ///< of the window; y counts from the bottom
  bool alpha = false;
  bool exponential = false;  ///< four colours with the comment `exponential_data`
  bool whole = false;        ///< the end opcode was seen
  std::int64_t rows = 0;     ///< rows from the bottom that are certainly complete
  std::size_t size = 0;      ///< bytes up to and including the end opcode (or to the end of the input)
  std::vector<std::string> comments;
};

/// Inspects the picture at the start of `bytes`; a cut-off body is no error. Throws ImageError for a broken
/// header.
RleInfo inspect_rle(std::string_view bytes);

}  // namespace rayshade
