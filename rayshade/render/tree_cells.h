// SPDX-License-Identifier: MIT
// The subdivision of the tree of eye rays as the screen shows it: cells are squares of the planes of the
// faces around the eye, and convex polygons on the screen.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "fas/tree.h"
#include "rayshade/sampling/camera.h"
#include "rayshade/scene/settings.h"

namespace rayshade {

/// A cell that has a leaf, and is at least partly within the window.
struct TreeCell {
  /// In pixels from the upper left corner of the window; what is beyond the window is cut off.
  std::vector<std::array<double, 2>> corners;
  std::uint32_t candidates = 0;
  int depth = 0;  ///< halvings of the side of the face's root square
};

struct TreeCells {
  std::vector<TreeCell> visible;
  std::uint64_t outside = 0;  ///< further cells that have a leaf, none of them within the window
};

/// The cells of `tree`, whose apex is the eye of `camera`. No thread may be tracing.
TreeCells tree_cells(const fas::HyperTree& tree, const Camera& camera, const RenderSettings& settings);

/// In square pixels.
double area_of(const TreeCell& cell);

}  // namespace rayshade
