// SPDX-License-Identifier: MIT
// The polygon (objects.md 4.5): any number of vertices, inside by the winding number, two-sided. Vertices off
// its plane are taken as projected onto it along the axis that the winding test drops.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "rayshade/geometry/ray.h"
#include "rayshade/math/bounds.h"
#include "rayshade/scene/shape.h"

namespace rayshade {

class Polygon {
 public:
  /// `flip`: the option -f, which negates the normal.
  explicit Polygon(const shape::Polygon& polygon, bool flip = false);

  /// t >= lo, t <= hi.
  bool intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const;
  SurfacePoint surface_point(const Ray& ray, const ShapeHit& hit) const;
  /// By the normal.
  bool entering(const Ray& ray, double /*lo*/, const ShapeHit& /*hit*/) const {
    return dot(normal_, ray.direction) < 0;
  }
  /// u = x, v = y in primitive space, whatever the orientation.
  TextureCoordinates texture_coordinates(const Vec3& x, const Vec3& facing_normal, const ShapeHit& hit) const;
  Bounds3 bounds() const { return bounds_; }
  std::size_t corners() const { return vertices_.size(); }
  /// A vertex moved into the plane, as the inside test sees it.
  Vec3 corner(std::size_t i) const;
  const Vec3& normal() const { return normal_; }
  /// The plane of the polygon, the axes of the inside test, and whether a point of the plane is inside.
  const Vec3& point() const { return point_; }
  int u_axis() const { return u_axis_; }
  int v_axis() const { return v_axis_; }
  bool contains(double u, double v) const {
    return u >= lo_.u && u <= hi_.u && v >= lo_.v && v <= hi_.v && winds_around({u, v});
  }
  /// The vertices as the inside test sees them, and their box.
  struct Point2 {
    double u, v;
  };
  const std::vector<Point2>& outline() const { return vertices_; }
  const Point2& lo() const { return lo_; }
  const Point2& hi() const { return hi_; }
  /// Whether the inside test looks at every edge; otherwise only at those that a table gives.
  bool takes_every_edge() const { return !buckets_; }

 private:
  struct Buckets;
  void make_buckets();
  /// Non-zero winding number about c; "right" and "above" are closed.
  bool winds_around(Point2 c) const;

  Vec3 point_;   ///< the first vertex, in the plane
  Vec3 normal_;  ///< unit
  int u_axis_, v_axis_;
  Point2 lo_, hi_;       ///< box of the projected vertices
  double normal_error_;  ///< bound on the error of `normal_`, in radians
  std::vector<Point2> vertices_;
  std::shared_ptr<const Buckets> buckets_;  ///< of polygons with more than a few vertices
  Bounds3 bounds_;
};

}  // namespace rayshade
