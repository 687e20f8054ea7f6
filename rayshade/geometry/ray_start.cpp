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

}  // namespace

void RayStarts::leave(const WorldHit& hit, double leaf_extent) {
  point = hit.point;
  normal = hit.geometric_normal;
  extent = std::min(1.0, leaf_extent);
  constexpr double kUnit = std::numeric_limits<double>::epsilon();
  const double coordinates = max_abs(hit.point);
  step = kSafety * std::max(hit.error, 2 * kUnit * coordinates);
  rounding = 4 * kUnit * coordinates;
}

RayStart secondary_start(const WorldHit& hit, const Vec3& direction, double extent, bool shadow) {
  return RayStarts(hit, extent).toward(direction, length(direction), shadow);
}

}  // namespace rayshade
