// SPDX-License-Identifier: MIT
#include "rayshade/geometry/shapes/cylinder.h"

namespace rayshade {

Cylinder::Cylinder(const shape::Cylinder& cylinder)
    : wall_(cylinder.bottom, cylinder.radius, cylinder.top, cylinder.radius), radius_(cylinder.radius) {}

TextureCoordinates Cylinder::texture_coordinates(const Vec3& x, const Vec3& /*facing_normal*/,
                                                 const ShapeHit& /*hit*/) const {
  const Vec3 p = wall_.local(x);
  TextureCoordinates out;
  out.u = turns(p.x / radius_, p.y / radius_, p.y < 0);
  out.v = p.z / wall_.length();
  out.du = normalize(wall_.frame().outward({-p.y, p.x, 0}));
  out.dv = wall_.frame().rows[2];
  return out;
}

}  // namespace rayshade
