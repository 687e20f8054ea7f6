// SPDX-License-Identifier: MIT
// What CSG does ray by ray (csg.cpp) and in packs (csg_pack.cpp): from hit to hit along a ray, as objects.md
// 7 says: U1/U2, I1/I2 and the two branches of the difference. Works for lists as solids and for open
// operands as the original does, which sorted intervals of closed solids would not.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "rayshade/geometry/compiled_scene.h"

namespace rayshade::csg_steps {

/// A pair of operands that cross more often along one ray is taken as missed; every step of the loop
/// advances, so this only bounds the time.
inline constexpr int kMost = 10'000;

/// What a ray asks for next.
struct Next {
  enum class What : std::uint8_t {
    kMiss,   ///< nothing before the far limit
    kHit,    ///< the latest hit with the operand; its t may lie beyond the limit
    kSearch  ///< the next hit with the operand, beyond() the latest one with the other
  };
  What what = What::kMiss;
  bool second = false;    ///< which operand
  bool entering = false;  ///< the solid, by the hit
};

/// `state` knows the latest hit with operand 0 and 1: whether one was found(i), at t(i), and whether the ray
/// enters(i) the operand there (objects.md 7.2). `hi`: the far limit. What the latest search did not find was
/// the last of its operand.
template <class State>
Next next_step(NodeKind operation, const State& state, double hi) {
  using What = Next::What;
  const bool first = state.found(0), second = state.found(1);
  if (operation == NodeKind::kDifference) {
    if (!first) return {};
    if (!second) return {What::kHit, false, state.enters(0)};
    if (std::min(state.t(0), state.t(1)) > hi) return {};
    if (state.t(0) < state.t(1)) {
      if (!state.enters(1)) return {What::kSearch, false};
      return {What::kHit, false, state.enters(0)};
    }
    if (state.enters(0)) return {What::kSearch, true};
    return {What::kHit, true, !state.enters(1)};
  }
  const bool is_union = operation == NodeKind::kUnion;
  if (is_union ? !first && !second : !first || !second) return {};
  const bool near = second && (!first || state.t(1) < state.t(0)), other = !near;
  if (state.t(near) > hi) return {};
  // Within the other operand a union has no surface, and an intersection has one there alone.
  const bool inside = state.found(other) && !state.enters(other);
  if (inside == is_union) return {What::kSearch, near};
  return {What::kHit, near, state.enters(near)};
}

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
