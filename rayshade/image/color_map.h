// SPDX-License-Identifier: MIT
// Colour map files of marble, fbm and mount (textures.md 4): one "R G B" per line, 256 of them.
#pragma once

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>

#include "rayshade/math/vec.h"

namespace rayshade {

/// A line that does not start with three integers. what() reads "line N: ...".
struct ColorMapError : std::runtime_error {
  ColorMapError(int line_number, const std::string& reason)
      : std::runtime_error("line " + std::to_string(line_number) + ": " + reason), line(line_number) {}
  int line;  ///< from 1
};

using ColorMap = std::array<Color, 256>;

/// Entry i is line i, as (1/255) * value; unbounded values are kept, lines after the 256th are ignored,
/// missing ones are black. Throws ColorMapError.
ColorMap read_color_map(std::string_view text);

}  // namespace rayshade
