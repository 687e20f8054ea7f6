// SPDX-License-Identifier: MIT
// The axis frame that cylinder, cone and torus share (objects.md 3.1): the smallest rotation that takes +z to a
// given axis. Its rows are kept as they are, so the inverse is the transpose and no determinant is ever asked; scales
// stay with the shapes. Also the angle that these shapes, the sphere and the disc use as u.
#pragma once

#include "rayshade/math/vec.h"

namespace rayshade {

struct AxisFrame {
  Vec3 x, y, z;  ///< images of the axes: orthonormal to within a few roundings; z is the axis

  AxisFrame() : x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1} {}
  /// The frame about `axis`, of any length but zero. Exact +z gives the identity; exact -z keeps x and negates y and
  /// z, which fixes where u begins there.
  explicit AxisFrame(const Vec3& axis);

  /// Components along the rows: from outside into the frame (directions, or points relative to the origin).
  Vec3 local(const Vec3& v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
  /// The inverse of local().
  Vec3 outward(const Vec3& v) const { return v.x * x + v.y * y + v.z * z; }
};

/// acos(c) in turns, 0 to 0.5, where c is clamped to [-1, 1].
double turns_of_cosine(double c);
/// The angle in turns of a point with cosine c on the side `mirrored` of the axis where it is counted downward from 1.
inline double turns(double c, bool mirrored) { return mirrored ? 1 - turns_of_cosine(c) : turns_of_cosine(c); }

}  // namespace rayshade
