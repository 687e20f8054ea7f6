// SPDX-License-Identifier: MIT
// Where secondary rays start: the one place that knows their tolerance (rule 8).
#include <algorithm>
#include <limits>

#include "rayshade/geometry/resolve.h"

namespace rayshade {
namespace {

/// How many error bounds the origin is moved off the surface: one for the point, one for the next test's own
/// rounding, and as much again for tests near the silhouette.
constexpr double kSafety = 4;
/// Lower limits relative to the size of what is left, for rays and for shadow rays (objects.md 2).
constexpr double kRayTolerance = kEpsilon, kShadowTolerance = 4 * kEpsilon;

}  // namespace

RayStarts::RayStarts(const WorldHit& hit, double leaf_extent)
    : point(hit.point), normal(hit.geometric_normal), extent(std::min(1.0, leaf_extent)) {
  constexpr double kUnit = std::numeric_limits<double>::epsilon();
  const double coordinates = max_abs(hit.point);
  step = kSafety * std::max(hit.error, 2 * kUnit * coordinates);
  rounding = 4 * kUnit * coordinates;
}

RayStart RayStarts::toward(const Vec3& direction, double length_of_direction, bool shadow) const {
  const bool behind = dot(direction, normal) < 0;
  RayStart out;
  out.origin = point + (behind ? -step : step) * normal;
  const double tolerance = shadow ? kShadowTolerance : kRayTolerance;
  out.lo = std::max(tolerance * extent, length_of_direction > 0 ? rounding / length_of_direction : 0);
  return out;
}

RayStart secondary_start(const WorldHit& hit, const Vec3& direction, double extent, bool shadow) {
  return RayStarts(hit, extent).toward(direction, length(direction), shadow);
}

}  // namespace rayshade
