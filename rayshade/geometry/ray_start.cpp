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

RayStart secondary_start(const WorldHit& hit, const Vec3& direction, double extent, bool shadow) {
  constexpr double kUnit = std::numeric_limits<double>::epsilon();
  const double coordinates = max_abs(hit.point);
  const double step = kSafety * std::max(hit.error, 2 * kUnit * coordinates);
  const bool behind = dot(direction, hit.geometric_normal) < 0;
  RayStart out;
  out.origin = hit.point + (behind ? -step : step) * hit.geometric_normal;
  const double tolerance = shadow ? kShadowTolerance : kRayTolerance;
  const double speed = length(direction);
  const double rounding = speed > 0 ? 4 * kUnit * coordinates / speed : 0;
  out.lo = std::max(tolerance * std::min(1.0, extent), rounding);
  return out;
}

}  // namespace rayshade
