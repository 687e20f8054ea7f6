// SPDX-License-Identifier: MIT
// Polygons cut into triangles, for structures that know no others.
#pragma once

#include <array>
#include <vector>

#include "fas/fas.h"

namespace rayshade::bench {

/// Ear clipping; holes joined by bridges are fine. Gives corner numbers, count - 2 triangles.
std::vector<std::array<std::uint32_t, 3>> triangulate(const std::vector<fas::Point>& corners);

}  // namespace rayshade::bench
