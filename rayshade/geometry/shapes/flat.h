// SPDX-License-Identifier: MIT
// What plane, disc, triangle and polygon share.
#pragma once

#include <cmath>

#include "rayshade/geometry/shapes/rounding.h"
#include "rayshade/math/vec.h"

namespace rayshade {

/// Whether a flat shape may be hit at `t` (objects.md 2): not where it is seen edge-on, |normal . direction|
/// < kEpsilon for unit vectors (this takes the squares of their lengths, so that neither needs to be of unit
/// length), and not where the numbers are beyond all measure.
inline bool hit_squarely(double t, double normal_dot_direction, double normal_square,
                         double direction_square) {
  return normal_dot_direction * normal_dot_direction >=
             kEpsilon * kEpsilon * normal_square * direction_square &&
         std::isfinite(t);
}

/// A point moved onto a plane, and a bound on the distance that remains.
struct OnPlane {
  Vec3 point;
  double error;
};

/// `p` moved along `unit_normal` onto the plane through `on`. `normal_error`: bound on the length of the
/// error of `unit_normal`.
///
/// The distance s = n.(p - on) is computed to within 4 roundings (difference, product, two sums) of |p - on|,
/// the same distance along the true normal differs by normal_error |p - on|, s n costs 2 more and a change of
/// the length of n normal_error again, and the difference p - s n one of |p|. The distances are taken before
/// the move, where they are larger.
inline OnPlane onto_plane(const Vec3& p, const Vec3& on, const Vec3& unit_normal, double normal_error) {
  const Vec3 from = p - on;
  const Vec3 moved = p - dot(unit_normal, from) * unit_normal;
  return {moved, (8 * kRoundoff + 2 * normal_error) * length(from) + 2 * storage_error(moved)};
}

}  // namespace rayshade
