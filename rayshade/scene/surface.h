// SPDX-License-Identifier: MIT
// Surface descriptions (shading.md 0.1).
#pragma once

#include "rayshade/math/vec.h"

namespace rayshade {

/// What light does at a surface. The defaults are those of a surface that is described but leaves a component
/// out.
struct Surface {
  Color ambient;
  Color diffuse;
  Color specular;
  Color body{1, 1, 1};
  Color translucent;                 ///< colour of diffusely transmitted light
  double specular_exponent = 15;     ///< specpow
  double transmitted_exponent = 15;  ///< third part of translu
  double reflectance = 0;
  double transparency = 0;
  double translucency = 0;
  double extinction = 1;  ///< share of light left after one unit of length
  double index = 1;
  bool no_shadow = false;  ///< receives no shadows

  bool operator==(const Surface&) const = default;
};

/// The surface of an object that has none on its whole path (language.md 5).
inline Surface default_surface() {
  Surface s;
  s.ambient = {0.1, 0.1, 0.1};
  s.diffuse = {0.6, 0.6, 0.6};
  s.specular = {0.5, 0.5, 0.5};
  s.specular_exponent = 12;
  s.transmitted_exponent = 12;
  return s;
}

}  // namespace rayshade
