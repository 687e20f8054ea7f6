// SPDX-License-Identifier: MIT
// The plane (objects.md 4.1): unbounded, two-sided, one hit per ray.
#pragma once

#include "rayshade/geometry/ray.h"
#include "rayshade/geometry/shapes/flat.h"
#include "rayshade/math/bounds.h"
#include "rayshade/scene/shape.h"

namespace rayshade {

class Plane {
 public:
  explicit Plane(const shape::Plane& plane) : point_(plane.point), normal_(normalize(plane.normal)) {}

  /// t > lo, t <= hi.
  bool intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const {
    const double slope = dot(normal_, ray.direction);
    const double t = dot(normal_, point_ - ray.origin) / slope;
    if (!(t > lo && t <= hi) || !hit_squarely(t, slope, 1, dot(ray.direction, ray.direction))) return false;
    hit.t = t;
    return true;
  }
  SurfacePoint surface_point(const Ray& ray, const ShapeHit& hit) const;
  /// By the normal.
  bool entering(const Ray& ray, double /*lo*/, const ShapeHit& /*hit*/) const {
    return dot(normal_, ray.direction) < 0;
  }
  /// Cartesian, from the plane's point; mirrored when seen from behind (objects.md G16).
  TextureCoordinates texture_coordinates(const Vec3& x, const Vec3& facing_normal, const ShapeHit& hit) const;
  Bounds3 bounds() const { return Bounds3::everything(); }
  const Vec3& point() const { return point_; }
  const Vec3& normal() const { return normal_; }

 private:
  Vec3 point_, normal_;
};

}  // namespace rayshade
