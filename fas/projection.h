// SPDX-License-Identifier: MIT
// Rays without extent in space, seen flat. All rays through one point (an eye, a point light) that leave
// through one face of the direction cube, and all parallel rays, are points of a plane (u, v); a primitive is
// an area there, with a range of depths. This file knows these planes and gives the conservative area of a
// primitive: a rectangle and up to three half-planes.
//
// Why areas are conservative: every bound is computed in double precision for hulls grown by `slack`, a
// distance in space that covers what the ray misses the point by, what the exact tests round, and what the
// bounds themselves round (see View::slack); divisions get the error of their operands on top.
#pragma once

#include "fas/fas.h"

namespace fas {

/// A class of rays without extent in space.
struct View {
  enum class Kind : std::uint8_t { kPoint, kParallel };
  Kind kind = Kind::kPoint;
  Point apex{};       ///< kPoint: where all rays pass
  Point direction{};  ///< kParallel: where all rays go, unit length
  /// Distance in space by which hulls are grown: twice what the exact tests may be off by (an absolute
  /// distance), plus what rays may miss the apex by (see `aim`), plus rounding. make_view() in tree.h gives
  /// it.
  double slack = 0;
  /// Rays may pass the apex at this distance.
  double aim = 0;
  /// Rays that start beyond this coordinate are not for this view: their own rounding would exceed the slack.
  double reach = 0;
  int faces() const { return kind == Kind::kPoint ? 6 : 1; }
};

/// An area of the (u, v) plane of one face, and depths. Depth is measured from the apex along the axis of the
/// face, or against the direction of parallel rays (so that in both cases rays toward a light go to smaller
/// depths).
struct Footprint {
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  double z0 = 0, z1 = 0;
  int cuts = 0;
  double cut[3][3];  ///< a u + b v + c >= 0 everywhere in the area
  /// Whether the area of a cover holds every (u, v) with a u + b v + c >= `inside` for all three cuts.
  bool covers = false;
  double inside[3];
};

/// One face of a view as a coordinate system.
class Plane {
 public:
  Plane(const View& view, int face);

  /// x, y, z of a point: u = x / z and v = y / z for a point view, u = x and v = y for a parallel one.
  Point local(const Point& p) const;
  /// The area of a primitive; false if no ray of this face can meet it.
  bool project(const Geometry& geometry, Footprint& out) const;
  /// The same for a box.
  bool project(const Bounds& box, Footprint& out) const;

  /// (u, v) of a ray of this face with direction `d` (kPoint) ...
  void of_direction(const double* d, double& u, double& v) const {
    const double inverse = sign_ / d[axis_];
    u = d[axis_u_] * inverse;
    v = d[axis_v_] * inverse;
  }
  /// A direction through (u, v) of a point view: what of_direction() maps there.
  Point direction(double u, double v) const {
    Point d{};
    d[axis_] = sign_;
    d[axis_u_] = u;
    d[axis_v_] = v;
    return d;
  }
  const View& view() const { return view_; }

 private:
  bool project_points(const Geometry& geometry, Footprint& out) const;
  bool project_spheres(const Geometry& geometry, Footprint& out) const;
  void add_polygon_cuts(const Geometry& geometry, Footprint& out) const;
  void add_sphere_cuts(const Geometry& geometry, Footprint& out) const;

  View view_;
  int axis_ = 2, axis_u_ = 0, axis_v_ = 1;
  double sign_ = 1;
  Point row_[3];  ///< kParallel
  double slack_;
};

/// The face through which a direction leaves the unit cube: 2 axis + (negative ? 1 : 0).
inline int face_of(const double* d) {
  const double x = d[0] < 0 ? -d[0] : d[0], y = d[1] < 0 ? -d[1] : d[1], z = d[2] < 0 ? -d[2] : d[2];
  const int axis = x >= y ? (x >= z ? 0 : 2) : (y >= z ? 1 : 2);
  return 2 * axis + (d[axis] < 0 ? 1 : 0);
}

}  // namespace fas
