// SPDX-License-Identifier: MIT
// The torus (objects.md 4.9): a tube of radius r whose centre line is a circle of radius R. For r > R it cuts
// itself; then the outer sheet ("apple") encloses an inner one ("lemon"), and rays hit both.
//
// With h the distance from the axis, z the height along it and R the swept radius, the surface is where
//   outer(p) = (h - R)^2 + z^2 - r^2   or   inner(p) = (h + R)^2 + z^2 - r^2
// vanishes. Their product is the usual quartic along a ray. The quartic only tells *where to look* (its
// stationary points split the ray into pieces with at most one crossing each); whether there is a crossing
// and where it is, is decided by the factors, which keep full accuracy for thin tubes. Signs at the ends of
// pieces are evaluated once, so a grazing ray crosses an even number of times or not at all. Roots are
// functions of the ray alone; `lo` selects.
#pragma once

#include "rayshade/geometry/ray.h"
#include "rayshade/geometry/shapes/frame.h"
#include "rayshade/math/bounds.h"
#include "rayshade/scene/shape.h"

namespace rayshade {

class Torus {
 public:
  explicit Torus(const shape::Torus& torus);

  /// The nearest t > lo with t <= hi. hit.part: 0 outer sheet, 1 inner sheet.
  bool intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const;
  SurfacePoint surface_point(const Ray& ray, const ShapeHit& hit) const;
  /// By the normal, which on the inner sheet is the outer sheet's formula (objects.md G19).
  bool entering(const Ray& ray, double lo, const ShapeHit& hit) const;
  TextureCoordinates texture_coordinates(const Vec3& x, const Vec3& facing_normal, const ShapeHit& hit) const;
  Bounds3 bounds() const { return bounds_; }

 private:
  /// The unnormalised outward normal of objects.md 4.9 at a local point.
  Vec3 local_normal(const Vec3& p) const;

  AxisFrame frame_;  ///< rows[2]: the axis; rows[0]: where u = 0
  Vec3 center_;
  double swept_;  ///< R
  double tube_;   ///< r
  Bounds3 bounds_;
};

}  // namespace rayshade
