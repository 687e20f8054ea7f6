// SPDX-License-Identifier: MIT
// Lights made ready for shading (shading.md 4): in the order in which they are evaluated (the reverse of
// their definition), area lights split into their cells, constants computed once.
#pragma once

#include <string>
#include <vector>

#include "rayshade/geometry/intersector.h"
#include "rayshade/scene/light.h"
#include "rayshade/scene/scene.h"

namespace rayshade {

struct ShadingLight {
  LightKind kind = LightKind::kPoint;
  bool no_shadow = false;
  bool black = false;  ///< intensity exactly zero: only its effect on translucency is left
  Color intensity;
  Vec3 position;  ///< corner of the cell for area lights; unit direction for directional ones
  Vec3 axis;      ///< spot: unit, from the light to its target
  double exponent = 0;
  bool cone = false;  ///< spot: inner angle below 90 degrees
  double cos_inner = -1, cos_outer = -1;
  double radius = 0;    ///< extended
  Vec3 edge_u, edge_v;  ///< area: edges of the cell
  /// Area and extended: the random numbers are those for light `sequence`, turn by turn for each eye sample.
  std::uint32_t sequence = 0, turn = 0, turns = 1;
};

/// All lights of the scene (the default light where it defines none), in evaluation order. Under
/// SamplingKind::kSobol an area light is not split into cells: all samples of a pixel share it, each of them
/// taking so many points of the whole light that a pixel with all its samples meets no fewer than the light
/// has cells.
std::vector<ShadingLight> prepare_lights(const Scene& scene, const RenderSettings& settings);

/// What a light is called in reports, as "light 2 (spot)": numbered from 1 in the order of definition, every
/// cell of an area light by itself. `light`: index in `lights`.
std::string light_name(const std::vector<ShadingLight>& lights, std::size_t light);

/// The class of the shadow rays toward a light, for the intersector.
RayClass shadow_class(const ShadingLight& light);

/// The spot factor of shading.md 4.1 for x = cosine of the angle off the axis.
double spot_factor(const ShadingLight& light, double x);

/// The point of an area light's cell for `xi`, `zeta` uniform in [0,1) (shading.md 4.3 with FIX 5).
inline Vec3 area_place(const ShadingLight& light, double xi, double zeta) {
  return light.position + xi * light.edge_u + zeta * light.edge_v;
}

/// The point of an extended light toward which the shadow ray of a sample goes, relative to the shaded point
/// (shading.md 4.2): stratified over `side` x `side` cells by the sample number.
Vec3 extended_target(const ShadingLight& light, const Vec3& point, int sample_number, int side, double xi,
                     double zeta);

}  // namespace rayshade
