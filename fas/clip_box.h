// SPDX-License-Identifier: MIT
// A box that rays are clipped to, with what that takes worked out once.
#pragma once

#include "fas/fas.h"

namespace fas {

struct ClipBox {
  Point lo{}, hi{}, center{};
  double size = 0;    ///< largest coordinate of `lo` plus that of `hi`, without signs
  double extent = 0;  ///< largest side
  bool empty = true;

  ClipBox() = default;
  explicit ClipBox(const Bounds& box);
};

/// Whether the ray from `origin` along `direction` may meet `box` within (lo, hi), whatever exact tests that
/// are off by no more than 64 `condition` units of rounding of the coordinates at hand say.
bool may_meet(const ClipBox& box, double condition, const double* origin, const double* direction, double lo,
              double hi);

}  // namespace fas
