// SPDX-License-Identifier: MIT
// What CSG does ray by ray and in packs: from hit to hit along a ray (objects.md 7.2).
#pragma once

#include <algorithm>
#include <cmath>

#include "rayshade/geometry/compiled_scene.h"

namespace rayshade::csg_steps {

/// A pair of operands that cross more often along one ray is taken as missed; every step of the loop
/// advances, so this only bounds the time.
inline constexpr int kMost = 10'000;

/// The tolerance in t of a ray; `inverse` leads into the object's own space, null where that is the ray's.
inline double tolerance(const Csg& csg, const Ray& ray, const Affine* inverse) {
  return csg.tolerance / length(inverse ? inverse->vector(ray.direction) : ray.direction);
}

/// What rounding of the origin needs, in t.
inline double rounding(const Ray& ray) { return 0x1p-48 * max_abs(ray.origin) / max_abs(ray.direction); }

/// Where next(X, t) begins: beyond t by the tolerance, and in any case by what rounding needs.
inline double beyond(double t, double tolerance, double rounding) {
  const double next = t + std::max(tolerance, rounding + 0x1p-48 * std::fabs(t));
  return next > t ? next : std::nextafter(t, kFar);
}

}  // namespace rayshade::csg_steps
