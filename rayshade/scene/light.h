// SPDX-License-Identifier: MIT
// Light sources as written (language.md 3.5, shading.md 4).
#pragma once

#include <cstdint>

#include "rayshade/math/vec.h"
#include "rayshade/scene/location.h"

namespace rayshade {

enum class LightKind : std::uint8_t { kPoint, kDirectional, kSpot, kExtended, kArea };

/// The keyword of the language.
constexpr const char* name_of(LightKind kind) {
  constexpr const char* kNames[] = {"point", "directional", "spot", "extended", "area"};
  return kNames[static_cast<int>(kind)];
}

struct Light {
  LightKind kind = LightKind::kPoint;
  Color intensity{1, 1, 1};
  bool no_shadow = false;
  Vec3 position;        ///< point, spot, extended: position; directional: direction toward the light, as
                        ///< written; area: corner
  Vec3 target;          ///< spot: the point it looks at
  double exponent = 0;  ///< spot: coef
  double inner = 180, outer = 180;   ///< spot: angles in degrees; 180 180 where none were written (FIX)
  double radius = 0;                 ///< extended
  Vec3 u_end, v_end;                 ///< area: end points of the two edges
  int u_samples = 1, v_samples = 1;  ///< area
  Location location;
};

}  // namespace rayshade
