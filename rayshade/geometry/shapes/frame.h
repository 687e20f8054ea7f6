// SPDX-License-Identifier: MIT
// The axis frame that cylinder, cone and torus share (objects.md 3.1): the smallest rotation that takes +z to
// a given axis. Its rows are kept as they are, so the inverse is the transpose and no determinant is ever
// asked; scales stay with the shapes. Also the angle that these shapes, the sphere and the disc use as u.
#pragma once

#include "rayshade/math/vec.h"

namespace rayshade {

struct AxisFrame {
  Vec3 rows[3];  ///< images of the axes: orthonormal to within a few roundings; rows[2] is the axis

  /// Components along the rows: from outside into the frame (directions, or points relative to the origin).
  Vec3 local(const Vec3& v) const { return {dot(v, rows[0]), dot(v, rows[1]), dot(v, rows[2])}; }
  /// The inverse of local().
  Vec3 outward(const Vec3& v) const { return v.x * rows[0] + v.y * rows[1] + v.z * rows[2]; }
};

/// The frame about `axis`, of any length but zero. Exact +z gives the identity; exact -z keeps x and negates
/// y and z, which fixes where u begins there.
AxisFrame axis_frame(const Vec3& axis);

/// The angle in turns of a point with cosine `c` and sine `s`; `mirrored` on the side where it counts
/// downward from 1. The original knows the cosine alone, clamped to [-1, 1], and that is what counts for
/// points off the surface, where textures of their own transforms ask. On it, where the squares add up to 1,
/// the sine has the digits that the cosine loses as it nears 1 - all but half of them.
double turns(double c, double s, bool mirrored);

}  // namespace rayshade
