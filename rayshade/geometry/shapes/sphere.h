// SPDX-License-Identifier: MIT
// The sphere (objects.md 4.2).
//
// The discriminant is r^2 |d|^2 - |L x d|^2, with L from the centre to the origin of the ray: the distance of
// the ray from the centre enters directly, not as a difference of squares of distances of the origin, so that
// origins far away cost no more accuracy than their own coordinates have lost. Roots are taken without
// cancellation.
#pragma once

#include <cmath>
#include <limits>

#include "rayshade/geometry/ray.h"
#include "rayshade/geometry/roots/quadratic.h"
#include "rayshade/math/bounds.h"
#include "rayshade/scene/shape.h"

namespace rayshade {

class Sphere {
 public:
  explicit Sphere(const shape::Sphere& sphere) : center_(sphere.center), radius_(sphere.radius) {}

  /// The near root if it is > lo (then the far one is never asked), else the far one; t <= hi.
  bool intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const {
    if (!ray.unit) return intersect_as_written(ray, lo, hi, hit);
    QuadraticRoots roots{};
    if (!solve(ray, roots)) return false;
    const double t = roots.near > lo ? roots.near : roots.far;
    if (!(t > lo && t <= hi && t < std::numeric_limits<double>::infinity())) return false;
    hit.t = t;
    return true;
  }
  SurfacePoint surface_point(const Ray& ray, const ShapeHit& hit) const;
  /// By position: the point at the ray's lower limit is strictly outside. Asked as `intersect` does, by the
  /// roots: far from the origin, the point at the limit is not known well
  /// enough.
  bool entering(const Ray& ray, double lo, const ShapeHit& /*hit*/) const {
    if (!ray.unit) return length_squared(ray.at(lo) - center_) > radius_ * radius_;
    QuadraticRoots roots{};
    return !(solve(ray, roots) && roots.near <= lo && lo <= roots.far);
  }
  /// v from the -z pole to the +z pole, u around from +x over +y; on the seam u = 1 (objects.md G16).
  TextureCoordinates texture_coordinates(const Vec3& x, const Vec3& facing_normal, const ShapeHit& hit) const;
  Bounds3 bounds() const;
  const Vec3& center() const { return center_; }
  double radius() const { return radius_; }

 private:
  /// Where the line meets the sphere; false where it does not.
  bool solve(const Ray& ray, QuadraticRoots& roots) const {
    const Vec3 l = ray.origin - center_;
    const Vec3& d = ray.direction;
    const double a = dot(d, d);
    const double discriminant = a * (radius_ * radius_) - length_squared(cross(l, d));
    if (!(discriminant >= 0)) return false;
    roots = quadratic_roots(a, dot(l, d), dot(l, l) - radius_ * radius_, std::sqrt(discriminant));
    return true;
  }
  /// Directions that are knowingly not of unit length: the original's formula as it stands, behind the
  /// original's box pre-test, which shows here because that formula does not find points of the sphere. The
  /// pre-test asks only whether the box is hit at all, not whether nearer than the best hit so far: answers
  /// may not depend on that.
  bool intersect_as_written(const Ray& ray, double lo, double hi, ShapeHit& hit) const;

  Vec3 center_;
  double radius_;
};

}  // namespace rayshade
