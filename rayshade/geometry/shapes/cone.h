// SPDX-License-Identifier: MIT
// The cone (objects.md 4.7): an open, possibly truncated one, hit from both sides. A radius of either sign
// makes a double cone; two negative radii make the same cone as two positive ones.
#pragma once

#include "rayshade/geometry/shapes/wall.h"
#include "rayshade/scene/shape.h"

namespace rayshade {

class Cone {
 public:
  explicit Cone(const shape::Cone& cone);

  /// The smallest t >= lo on the wall, rims included, with t <= hi.
  bool intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const {
    return wall_.intersect(ray, lo, hi, hit);
  }
  SurfacePoint surface_point(const Ray& ray, const ShapeHit& hit) const {
    return wall_.surface_point(ray, hit);
  }
  /// By the normal.
  bool entering(const Ray& ray, double /*lo*/, const ShapeHit& hit) const { return wall_.entering(ray, hit); }
  /// v from the end with the smaller radius to the other, u around the axis; the tangents as the original has
  /// them (objects.md G18).
  TextureCoordinates texture_coordinates(const Vec3& x, const Vec3& facing_normal, const ShapeHit& hit) const;
  Bounds3 bounds() const { return wall_.bounds(); }
  const Wall& wall() const { return wall_; }

 private:
  Wall wall_;  ///< from the smaller radius to the larger
  double small_radius_, large_radius_;
};

}  // namespace rayshade
