// SPDX-License-Identifier: MIT
// How a light stands to many hits at once (shading.md 2.4, 4), before shadows. What every lane computes, it
// would compute alone: + - * / and square roots in one order (rule 3).
#pragma once

#include <cstddef>

#include "rayshade/shading/lights.h"

namespace rayshade {

/// Up to 64 hits side by side.
struct LightAims {
  static constexpr std::size_t kMost = 64;

  std::size_t count = 0;
  alignas(64) double point[3][kMost];
  alignas(64) double normal[3][kMost];
  alignas(64) double mirror[3][kMost];  ///< R, the direction of mirror reflection
  // Of the light at hand:
  alignas(64) double place[3][kMost];      ///< in: the point of the light that each hit sees; see aim_at()
  alignas(64) double direction[3][kMost];  ///< unit, from the hit
  alignas(64) double distance[kMost];      ///< kFar for directional lights; 0: the light sits on the point
  alignas(64) double cosine[kMost];        ///< between direction and normal
  alignas(64) double highlight[kMost];     ///< R . direction

  void set_hit(std::size_t i, const Vec3& at, const Vec3& n, const Vec3& r) {
    for (int axis = 0; axis < 3; ++axis)
      point[axis][i] = at[axis], normal[axis][i] = n[axis], mirror[axis][i] = r[axis];
  }
  void set_place(std::size_t i, const Vec3& at) {
    for (int axis = 0; axis < 3; ++axis) place[axis][i] = at[axis];
  }
  Vec3 direction_of(std::size_t i) const { return {direction[0][i], direction[1][i], direction[2][i]}; }
};

/// Finds what stands under "of the light at hand". Area lights are aimed at in `place`, all others at their
/// position.
void aim_at(const ShadingLight& light, LightAims& aims);

}  // namespace rayshade
