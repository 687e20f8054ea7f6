// SPDX-License-Identifier: MIT
// The disc (objects.md 4.8): flat, two-sided, its rim included.
#pragma once

#include "rayshade/geometry/ray.h"
#include "rayshade/geometry/shapes/flat.h"
#include "rayshade/math/bounds.h"
#include "rayshade/scene/shape.h"

namespace rayshade {

class Disc {
 public:
  explicit Disc(const shape::Disc& disc)
      : center_(disc.center), normal_(normalize(disc.normal)), radius_(disc.radius) {}

  /// t >= lo, t <= hi.
  bool intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const {
    const double slope = dot(normal_, ray.direction);
    const Vec3 from_center = ray.origin - center_;
    const double t = -dot(normal_, from_center) / slope;
    if (!(t >= lo && t <= hi)) return false;
    if (!(length_squared(from_center + t * ray.direction) <= radius_ * radius_)) return false;
    if (!hit_squarely(t, slope, 1, dot(ray.direction, ray.direction))) return false;
    hit.t = t;
    return true;
  }
  SurfacePoint surface_point(const Ray& ray, const ShapeHit& hit) const;
  /// By the normal.
  bool entering(const Ray& ray, double /*lo*/, const ShapeHit& /*hit*/) const {
    return dot(normal_, ray.direction) < 0;
  }
  /// v is the distance from the centre over the radius, u the angle, but from absolute coordinates
  /// (objects.md G15).
  TextureCoordinates texture_coordinates(const Vec3& x, const Vec3& facing_normal, const ShapeHit& hit) const;
  Bounds3 bounds() const;
  const Vec3& center() const { return center_; }
  const Vec3& normal() const { return normal_; }
  double radius() const { return radius_; }

 private:
  Vec3 center_, normal_;
  double radius_;
};

/// The tight box of a circle's disc, grown by its rounding; `normal` is a unit vector.
Bounds3 disc_bounds(const Vec3& center, const Vec3& normal, double radius);

}  // namespace rayshade
