// SPDX-License-Identifier: MIT
// What textures do to surface records and normals (textures.md 0, 1.6): small pure functions shared by all of
// them.
#pragma once

#include "rayshade/math/vec.h"
#include "rayshade/scene/surface.h"

namespace rayshade {

/// S becomes a S + b B, every colour and scalar; nothing where b < kEpsilon. Weights are not clamped.
/// no_shadow is B's where a < kEpsilon, else that of both.
void blend(Surface& s, const Surface& other, double a, double b);

/// The normal of a surface raised by a height whose slopes along du and dv are fu and fv: a height that grows
/// with u tilts the normal toward -du.
inline Vec3 make_bump(const Vec3& n, const Vec3& du, const Vec3& dv, double fu, double fv) {
  return normalize_above_epsilon(n + fu * cross(n, dv) - fv * cross(n, du));
}

/// To [0, 1]; NaN passes.
constexpr double clamp01(double x) { return x < 0 ? 0 : x > 1 ? 1 : x; }

/// trunc(x) limited to 0 .. last, for any x at all (NaN gives 0): an index that cannot leave its table.
constexpr int truncated_index(double x, int last) {
  if (!(x >= 1)) return 0;
  return x < last ? static_cast<int>(x) : last;
}

}  // namespace rayshade
