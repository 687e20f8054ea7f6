// SPDX-License-Identifier: MIT
// A box that rays are clipped to, and a ray that is clipped to boxes, each with what that takes worked out
// once.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "fas/fas.h"

namespace fas {

struct ClipBox {
  Point planes[2] = {};  ///< low and high
  Point center{};
  double size = 0;    ///< largest coordinate of the low corner plus that of the high one, without signs
  double extent = 0;  ///< largest side
  bool empty = true;

  ClipBox() = default;
  explicit ClipBox(const Bounds& box);
};

struct ClipRay {
  Point origin{}, direction{}, inverse{};  ///< of components of 0: infinity of their sign
  Point sign{};                            ///< of the direction: 1 or -1
  std::uint8_t near_side[3] = {};          ///< 0: the low plane comes first
  double size = 0;                         ///< largest coordinate of the origin, without sign

  ClipRay() = default;
  ClipRay(const double* from, const double* along) {
    for (std::size_t i = 0; i < 3; ++i) {
      origin[i] = from[i];
      direction[i] = along[i];
      inverse[i] = 1 / along[i];
      near_side[i] = std::signbit(along[i]) ? 1 : 0;
      sign[i] = near_side[i] == 0 ? 1 : -1;
      size = std::max(size, std::fabs(from[i]));
    }
  }
};

/// What exact tests that are off by no more than 64 `condition` units of rounding of the coordinates at hand
/// may be off by: rounding of the origin taken into the space of a primitive and back.
inline double exact_slack(const ClipBox& box, double condition, const ClipRay& ray) {
  return 64 * std::numeric_limits<double>::epsilon() * condition * (ray.size + box.size);
}

/// The slab test in double precision on the box widened by `slack`: whether the ray stays within it somewhere
/// in (lo, hi), and from where on. Where a component of the direction is 0 and the origin is in the plane
/// itself, a slab says NaN, which narrows nothing.
inline bool clip(const ClipBox& box, double slack, const ClipRay& ray, double lo, double hi, double& entry) {
  double first = lo, last = hi;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t near = ray.near_side[axis];
    const double outward = ray.sign[axis] * slack;
    const double in = (box.planes[near][axis] - outward - ray.origin[axis]) * ray.inverse[axis];
    const double out = (box.planes[1 - near][axis] + outward - ray.origin[axis]) * ray.inverse[axis];
    first = std::max(first, in);
    last = std::min(last, out);
  }
  entry = first;
  return first <= last + 8 * std::numeric_limits<double>::epsilon() * std::fabs(last);
}

/// Whether the ray may meet `box` within (lo, hi), whatever the exact tests round.
inline bool may_meet(const ClipBox& box, double condition, const ClipRay& ray, double lo, double hi) {
  double entry = 0;
  return !box.empty && clip(box, exact_slack(box, condition, ray), ray, lo, hi, entry);
}

}  // namespace fas
