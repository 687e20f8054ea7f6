// SPDX-License-Identifier: MIT
// The cylinder (objects.md 4.6): an open tube, hit from both sides.
#pragma once

#include "rayshade/geometry/shapes/wall.h"
#include "rayshade/scene/shape.h"

namespace rayshade {

class Cylinder {
 public:
  explicit Cylinder(const shape::Cylinder& cylinder);

  /// The smallest t >= lo on the wall, rims included, with t <= hi.
  bool intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const {
    return wall_.intersect(ray, lo, hi, hit);
  }
  SurfacePoint surface_point(const Ray& ray, const ShapeHit& hit) const {
    return wall_.surface_point(ray, hit);
  }
  /// By the normal.
  bool entering(const Ray& ray, double /*lo*/, const ShapeHit& hit) const { return wall_.entering(ray, hit); }
  /// v along the axis, u around it.
  TextureCoordinates texture_coordinates(const Vec3& x, const Vec3& facing_normal, const ShapeHit& hit) const;
  Bounds3 bounds() const { return wall_.bounds(); }
  const Wall& wall() const { return wall_; }

 private:
  Wall wall_;
  double radius_;
};

}  // namespace rayshade
