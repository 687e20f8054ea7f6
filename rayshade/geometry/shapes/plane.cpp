// SPDX-License-Identifier: MIT
#include "rayshade/geometry/shapes/plane.h"

namespace rayshade {

SurfacePoint Plane::surface_point(const Ray& ray, const ShapeHit& hit) const {
  const OnPlane on = onto_plane(ray.at(hit.t), point_, normal_, kNormalizeError);
  return {on.point, normal_, normal_, on.error, false};
}

TextureCoordinates Plane::texture_coordinates(const Vec3& x, const Vec3& facing_normal,
                                              const ShapeHit& /*hit*/) const {
  TextureCoordinates out;
  coordinate_system(facing_normal, out.du, out.dv);
  out.u = dot(x - point_, out.du);
  out.v = dot(x - point_, out.dv);
  return out;
}

}  // namespace rayshade
