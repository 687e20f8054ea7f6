// SPDX-License-Identifier: MIT
#include "rayshade/geometry/shapes/cone.h"

#include <utility>

namespace rayshade {
namespace {

/// The end with the smaller radius becomes the bottom.
shape::Cone ordered(shape::Cone cone) {
  if (cone.bottom_radius <= 0 && cone.top_radius <= 0) {
    cone.bottom_radius = -cone.bottom_radius;
    cone.top_radius = -cone.top_radius;
  }
  if (cone.top_radius < cone.bottom_radius) {
    std::swap(cone.bottom_radius, cone.top_radius);
    std::swap(cone.bottom, cone.top);
  }
  return cone;
}

Wall wall_of(const shape::Cone& cone) { return {cone.bottom, cone.bottom_radius, cone.top, cone.top_radius}; }

}  // namespace

Cone::Cone(const shape::Cone& cone)
    : wall_(wall_of(ordered(cone))),
      small_radius_(ordered(cone).bottom_radius),
      large_radius_(ordered(cone).top_radius) {}

TextureCoordinates Cone::texture_coordinates(const Vec3& x, const Vec3& /*facing_normal*/,
                                             const ShapeHit& /*hit*/) const {
  const Vec3 p = wall_.local(x);
  // In the original's canonical space, where the cone is x^2 + y^2 = z^2 and the large rim is at z = 1.
  const Vec3 canonical{p.x / large_radius_, p.y / large_radius_, wall_.radius_at(p.z) / large_radius_};
  const double height =
      wall_.length() / (1 - small_radius_ / large_radius_);  // from the apex to the large rim
  const auto outward = [&](const Vec3& v) {
    return wall_.frame().outward({v.x * large_radius_, v.y * large_radius_, v.z * height});
  };
  TextureCoordinates out;
  if (!(canonical.z < kEpsilon)) {
    out.u = turns(canonical.x / canonical.z, canonical.y / canonical.z, canonical.y < 0);
  }
  out.v = p.z / wall_.length();
  out.du = normalize(outward(outward({-canonical.y, canonical.x, 0})));
  out.dv = normalize(canonical);
  return out;
}

}  // namespace rayshade
