// SPDX-License-Identifier: MIT
// Where something was written.
#pragma once

#include <cstdint>

namespace rayshade {

/// A place in a scene file. `file` indexes Scene::file_names; line and column count from 1, 0 = unknown.
struct Location {
  std::uint32_t line = 0;
  std::uint16_t column = 0;
  std::uint16_t file = 0;
  constexpr bool operator==(const Location&) const = default;
};

}  // namespace rayshade
