// SPDX-License-Identifier: MIT
// Height field files (objects.md 5.2): a 32-bit count n, then n * n 32-bit floats, in either byte order.
#pragma once

#include <stdexcept>
#include <string_view>
#include <vector>

namespace rayshade {

/// A height field that cannot be read; what() is the reason without the file's name.
struct HeightFieldError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The altitude that marks a missing point; smaller ones become equal to it.
inline constexpr float kUnsetAltitude = -1000;

struct HeightFieldData {
  int size = 0;                  ///< points per side, at least 2
  std::vector<float> altitudes;  ///< size * size; number i stands at x = i mod size, y = i div size

  float at(int x, int y) const { return altitudes[static_cast<std::size_t>(y) * size + x]; }
  static bool is_set(float altitude) { return altitude > kUnsetAltitude; }
};

/// Little-endian unless only the other order fits the length of the file. Trailing bytes are ignored. Values
/// that are not a number count as unset, infinite ones are an error. Throws HeightFieldError.
HeightFieldData read_height_field(std::string_view bytes);

}  // namespace rayshade
