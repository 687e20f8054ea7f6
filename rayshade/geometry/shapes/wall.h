// SPDX-License-Identifier: MIT
// The wall of a cylinder or cone: the surface swept by a straight line that turns about an axis,
//
//   x^2 + y^2 = (r + k z)^2,  0 <= z <= L,
//
// in a frame with unit axes at one end of the axis. The original's canonical space, whose origin is the apex
// of the cone, would lose all accuracy for slightly tapered ones. With o the point of the ray nearest to the
// middle of the wall, h the horizontal part (x, y) of a vector, R = r + k o.z and s = k d.z, a ray o + t d
// meets the infinite wall where A t^2 + 2 B t + C = 0 with
//
//   A = |h_d|^2 - s^2,  B = h_o.h_d - R s,  C = |h_o|^2 - R^2,
//   B^2 - A C = |R h_d - s h_o|^2 - (h_o x h_d)^2:
//
// as with the sphere, the distance of the ray from the axis enters directly. For k = 0 this is a cylinder.
// Radii may be negative: then both nappes of a double cone are there. No absolute tolerance: only rays
// exactly parallel to a cylinder's axis are missed as such, others by the length of the wall.
#pragma once

#include "rayshade/geometry/ray.h"
#include "rayshade/geometry/shapes/frame.h"
#include "rayshade/math/bounds.h"

namespace rayshade {

class Wall {
 public:
  /// From the end with radius `radius`, the origin, to the end with radius `end_radius`.
  Wall(const Vec3& origin, double radius, const Vec3& end, double end_radius);

  /// The smallest t >= lo within the closed range of z, with t <= hi.
  bool intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const;
  /// The normal is outward from the axis, except on the nappe of negative radius, where it is inward
  /// (objects.md 4.7).
  SurfacePoint surface_point(const Ray& ray, const ShapeHit& hit) const;
  /// By the normal.
  bool entering(const Ray& ray, const ShapeHit& hit) const;
  /// Tight: of the two rims.
  Bounds3 bounds() const;

  /// A point in the frame, not scaled.
  Vec3 local(const Vec3& point) const { return frame_.local(point - origin_); }
  double radius_at(double z) const { return radius_ + slope_ * z; }
  double length() const { return length_; }
  const Vec3& origin() const { return origin_; }
  Vec3 end() const { return origin_ + length_ * frame_.rows[2]; }
  double start_radius() const { return radius_; }
  double end_radius() const { return end_radius_; }
  double slope() const { return slope_; }
  double reach_square() const { return reach_square_; }
  const AxisFrame& frame() const { return frame_; }

 private:
  Vec3 origin_;
  AxisFrame frame_;
  double radius_, end_radius_;
  double length_;
  double reach_square_;   ///< of the ball about the middle that holds the wall
  double slope_;          ///< k
  double cosine_, sine_;  ///< of the angle between axis and wall: k = sine / cosine
};

}  // namespace rayshade
