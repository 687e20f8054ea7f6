// SPDX-License-Identifier: MIT
// The blob (objects.md 4.11): the surface F = T of the field F(p) = sum of s (1 - |p - c|^2 / r^2)^2 over the
// metaballs with |p - c| < r; inside is F > T.
//
// Along a ray the field is a chain of quartics, one per interval between the boundaries of the balls' spheres
// of influence. Every interval is put into Bernstein form over itself, straight from the points at its ends,
// so that neither the distance of the origin nor the size of the blob matters. A walk over the intervals
// keeps the state "inside" or "outside"; a hit is where the state changes, so crossings are never lost or
// doubled at boundaries, and two neighbouring ones always differ in direction. Crossings are functions of the
// ray alone; `lo` selects.
#pragma once

#include <cstdint>
#include <vector>

#include "rayshade/geometry/ray.h"
#include "rayshade/math/bounds.h"
#include "rayshade/scene/shape.h"

namespace rayshade {

class Blob {
 public:
  explicit Blob(const shape::Blob& blob);

  /// The nearest t > lo with t <= hi where the field crosses the threshold.
  bool intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const;
  SurfacePoint surface_point(const Ray& ray, const ShapeHit& hit) const;
  bool entering(const Ray& ray, double lo, const ShapeHit& hit) const;
  TextureCoordinates texture_coordinates(const Vec3& x, const Vec3& facing_normal, const ShapeHit& hit) const;
  /// Of the parts of the spheres of influence that the surface can reach.
  Bounds3 bounds() const { return bounds_; }

 private:
  struct Ball {
    Vec3 center;
    double radius, inverse_square, strength;
  };
  /// A sphere around some neighbouring balls' spheres of influence: rays that miss it miss them all.
  struct Cluster {
    Vec3 center;
    double radius_square;
    std::uint32_t first, count;
  };
  /// Field minus threshold, outward normal (minus its gradient, unnormalised), and a bound on the field's
  /// rounding.
  struct Field {
    double value;
    Vec3 outward;
    double rounding;
    double curvature;  ///< bound on the second derivatives near the point
  };
  Field field(const Vec3& p) const;

  /// The part of a ray inside a sphere of influence; in the direction's length, from the ray's shifted
  /// origin.
  struct Span {
    double enter, exit;
    const Ball* ball;
  };
  class Spans;
  struct LocalRay;

  /// The spheres of influence that the ray meets. False where even all their peaks together stay below the
  /// threshold.
  bool collect(const LocalRay& ray, Spans& spans) const;
  bool first_crossing(const LocalRay& ray, Spans& spans, double lo, double hi, double& t) const;
  void make_clusters(std::uint32_t first, std::uint32_t count);
  void make_bounds();

  std::vector<Ball> balls_;
  std::vector<Cluster> clusters_;
  double threshold_;
  Vec3 middle_;  ///< of the spheres of influence
  Bounds3 bounds_;
};

}  // namespace rayshade
