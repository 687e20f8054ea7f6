// SPDX-License-Identifier: MIT
// A beam: all rays that start in a box of origins and leave, through one face of the direction cube, within a
// rectangle of directions (J. Arvo, D. Kirk, "Fast ray tracing by ray classification", SIGGRAPH 1987). In
// space it is bounded by five planes: behind it, and one for each side of the rectangle.
//
// A ray of the beam is at origin + z (u, v, 1), written for the axis of the face last, with z >= 0. It can be
// in a box only while z is between the least and the largest distance, along that axis, of the box from the
// origins; there, its other coordinates lie between those of the least origin with the least direction and
// the largest with the largest. A box that is beyond one of these limits is not met. Everything is rounded to
// the nearest in double precision; the caller grows the box of origins by a slack that is far more than that
// (see BeamTree).
#pragma once

#include <algorithm>
#include <cstdint>

#include "fas/hierarchy.h"

namespace fas {

struct Beam {
  int face = 0;           ///< 2 axis + (negative ? 1 : 0)
  Bounds origins;         ///< relative to the centre of the hierarchy
  double u0 = 0, u1 = 0;  ///< direction along the next axis, by the size of that along the face's own
  double v0 = 0, v1 = 0;  ///< and along the one after that

  /// Which lanes of a node may be met, as bits.
  std::uint32_t meets(const Hierarchy::Node& node) const {
    const auto k = static_cast<std::size_t>(face >> 1), i = k == 2 ? 0 : k + 1, j = i == 2 ? 0 : i + 1;
    const bool negative = (face & 1) != 0;
    const double behind = negative ? -origins.lo[k] : origins.hi[k],
                 front = negative ? -origins.hi[k] : origins.lo[k];
    std::uint32_t met = 0;
    for (int lane = 0; lane < Hierarchy::kWidth; ++lane) {
      const double lo = static_cast<double>(node.planes[0][k][lane]),
                   hi = static_cast<double>(node.planes[1][k][lane]);
      const double far = (negative ? -lo : hi) - front, near = std::max(0.0, (negative ? -hi : lo) - behind);
      const bool outside =
          !(far >= 0) || beyond(node, lane, i, u0, u1, near, far) || beyond(node, lane, j, v0, v1, near, far);
      if (!outside && node.opacity[lane] != 0) met |= 1u << lane;
    }
    return met;
  }

 private:
  bool beyond(const Hierarchy::Node& node, int lane, std::size_t axis, double least, double most, double near,
              double far) const {
    return static_cast<double>(node.planes[1][axis][lane]) <
               origins.lo[axis] + least * (least >= 0 ? near : far) ||
           static_cast<double>(node.planes[0][axis][lane]) >
               origins.hi[axis] + most * (most >= 0 ? far : near);
  }
};

}  // namespace fas
