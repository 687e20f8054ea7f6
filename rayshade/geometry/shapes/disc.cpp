// SPDX-License-Identifier: MIT
#include "rayshade/geometry/shapes/disc.h"

#include <algorithm>

#include "rayshade/geometry/shapes/frame.h"

namespace rayshade {

SurfacePoint Disc::surface_point(const Ray& ray, const ShapeHit& hit) const {
  const OnPlane on = onto_plane(ray.at(hit.t), center_, normal_, kNormalizeError);
  return {on.point, normal_, normal_, on.error, false};
}

TextureCoordinates Disc::texture_coordinates(const Vec3& x, const Vec3& facing_normal,
                                             const ShapeHit& /*hit*/) const {
  const Vec3 from_center = x - center_;
  const double square = length_squared(from_center);
  // The original's 1e-5 is for discs of about one unit; smaller ones would lose their pattern to it.
  if (square < kEpsilon * std::min(1.0, radius_ * radius_)) return {};
  const double distance = std::sqrt(square);
  const double cosine = x.x / distance;
  TextureCoordinates out;
  out.u = std::fabs(cosine) > 1 ? 0.5 : turns(cosine, x.y / distance, x.y < 0);
  out.v = distance / radius_;
  out.dv = from_center;
  out.du = cross(out.dv, facing_normal);
  return out;
}

Bounds3 Disc::bounds() const { return disc_bounds(center_, normal_, radius_); }

Bounds3 disc_bounds(const Vec3& center, const Vec3& normal, double radius) {
  // sqrt(1 - n_i^2), from the two other components so that nothing cancels.
  const Vec3 reach{std::sqrt(normal.y * normal.y + normal.z * normal.z),
                   std::sqrt(normal.z * normal.z + normal.x * normal.x),
                   std::sqrt(normal.x * normal.x + normal.y * normal.y)};
  // Components of the normal are good to 4 roundings, the root, product and sum cost as many again.
  const double margin = 16 * kRoundoff * (radius + max_abs(center));
  return grown({center - radius * reach, center + radius * reach}, margin);
}

}  // namespace rayshade
