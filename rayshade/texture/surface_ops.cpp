// SPDX-License-Identifier: MIT
// The blend of two surfaces.
#include "rayshade/texture/surface_ops.h"

namespace rayshade {

void blend(Surface& s, const Surface& other, double a, double b) {
  if (b < kEpsilon) return;
  const auto mix = [a, b](auto& mine, const auto& theirs) { mine = a * mine + b * theirs; };
  mix(s.ambient, other.ambient);
  mix(s.diffuse, other.diffuse);
  mix(s.specular, other.specular);
  mix(s.translucent, other.translucent);
  mix(s.body, other.body);
  mix(s.specular_exponent, other.specular_exponent);
  mix(s.transmitted_exponent, other.transmitted_exponent);
  mix(s.reflectance, other.reflectance);
  mix(s.transparency, other.transparency);
  mix(s.translucency, other.translucency);
  mix(s.extinction, other.extinction);
  mix(s.index, other.index);
  s.no_shadow = a < kEpsilon ? other.no_shadow : s.no_shadow && other.no_shadow;
}

}  // namespace rayshade
