// SPDX-License-Identifier: MIT
// Affine maps on row vectors: p' = p M + t (objects.md 1.3). The rows of M are the images of the axes.
#pragma once

#include <optional>

#include "rayshade/math/vec.h"

namespace rayshade {

struct Affine {
  Vec3 rows[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Vec3 translation;

  constexpr Vec3 vector(const Vec3& v) const { return v.x * rows[0] + v.y * rows[1] + v.z * rows[2]; }
  constexpr Vec3 point(const Vec3& p) const { return vector(p) + translation; }
  /// v M^T: with the inverse map this takes normals outward, n' = n (M^-1)^T, not normalised.
  constexpr Vec3 transposed_vector(const Vec3& v) const {
    return {dot(v, rows[0]), dot(v, rows[1]), dot(v, rows[2])};
  }
  constexpr bool operator==(const Affine&) const = default;
};

/// `first`, then `second`.
constexpr Affine then(const Affine& first, const Affine& second) {
  Affine out;
  for (int i = 0; i < 3; ++i) out.rows[i] = second.vector(first.rows[i]);
  out.translation = second.point(first.translation);
  return out;
}

constexpr double determinant(const Affine& a) { return dot(a.rows[0], cross(a.rows[1], a.rows[2])); }

/// The inverse by adjugate over determinant; nothing where the linear part is singular relative to its own
/// size
/// (|det| <= 1e-14 times the product of the row lengths: rounding decides below that) or not finite.
inline std::optional<Affine> inverse(const Affine& a) {
  const double det = determinant(a);
  const double size = length(a.rows[0]) * length(a.rows[1]) * length(a.rows[2]);
  if (!(std::fabs(det) > 1e-14 * size) || !std::isfinite(det) || det == 0) return std::nullopt;
  const Vec3 c0 = cross(a.rows[1], a.rows[2]) / det;
  const Vec3 c1 = cross(a.rows[2], a.rows[0]) / det;
  const Vec3 c2 = cross(a.rows[0], a.rows[1]) / det;
  Affine out;
  out.rows[0] = {c0.x, c1.x, c2.x};
  out.rows[1] = {c0.y, c1.y, c2.y};
  out.rows[2] = {c0.z, c1.z, c2.z};
  out.translation = -out.vector(a.translation);
  if (!is_finite(out.rows[0]) || !is_finite(out.rows[1]) || !is_finite(out.rows[2])) return std::nullopt;
  return out;
}

/// A map and its inverse, computed once.
struct AffinePair {
  Affine forward;  ///< primitive -> outside
  Affine inverse;  ///< outside -> primitive

  /// A normal taken outward by the inverse transpose and normalised (objects.md 1.3).
  Vec3 normal(const Vec3& n) const { return normalize(inverse.transposed_vector(n)); }
};

constexpr Affine scaling(const Vec3& s) { return {{{s.x, 0, 0}, {0, s.y, 0}, {0, 0, s.z}}, {}}; }
constexpr Affine translation(const Vec3& t) { return {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, t}; }
/// Right-handed turn about a unit axis (objects.md 1.4).
Affine rotation(const Vec3& unit_axis, double radians);
/// Turn by degrees about any axis; identity for a zero axis (objects.md 1.7, FIX).
Affine rotation_degrees(const Vec3& axis, double degrees);

}  // namespace rayshade
