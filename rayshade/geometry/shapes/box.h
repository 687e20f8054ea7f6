// SPDX-License-Identifier: MIT
// The axis-aligned box (objects.md 4.3), by slabs, on its exact extent.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "rayshade/geometry/ray.h"
#include "rayshade/math/bounds.h"
#include "rayshade/scene/shape.h"

namespace rayshade {

class Box {
 public:
  explicit Box(const shape::Box& box) : lo_(box.lo), hi_(box.hi) {
    const Vec3 extent = hi_ - lo_;
    const double smallest = std::min({extent.x, extent.y, extent.z});
    band_ = std::min(kEpsilon * std::min(1.0, max_abs(extent)), 0.25 * smallest);
  }

  /// The entry t0 if t0 > lo, else the exit t1 if t1 >= lo; t <= hi. hit.part: 2 * axis, plus 1 for the high
  /// face.
  ///
  /// Divisions, not reciprocals: a face that two boxes share gives both the same t, rounded once.
  bool intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const {
    const Vec3 &o = ray.origin, &d = ray.direction;
    Slab x{(lo_.x - o.x) / d.x, (hi_.x - o.x) / d.x};
    Slab y{(lo_.y - o.y) / d.y, (hi_.y - o.y) / d.y};
    Slab z{(lo_.z - o.z) / d.z, (hi_.z - o.z) / d.z};
    if (d.x * d.y * d.z == 0) {  // or the product underflows; then nothing changes here
      if (d.x == 0) x = parallel_slab(o.x, lo_.x, hi_.x);
      if (d.y == 0) y = parallel_slab(o.y, lo_.y, hi_.y);
      if (d.z == 0) z = parallel_slab(o.z, lo_.z, hi_.z);
    }
    const double entry = std::max(std::max(x.near(), y.near()), z.near());
    const double exit = std::min(std::min(x.far(), y.far()), z.far());
    if (!(entry <= exit && exit >= lo)) return false;
    const bool from_outside = entry > lo;
    const double t = from_outside ? entry : exit;
    if (!(t <= hi && t < std::numeric_limits<double>::infinity())) return false;
    hit.t = t;
    const std::uint32_t axis = from_outside ? (t == x.near()   ? 0
                                               : t == y.near() ? 1
                                                               : 2)
                                            : (t == x.far()   ? 0
                                               : t == y.far() ? 1
                                                              : 2);
    hit.part = 2 * axis + (from_outside == (d[static_cast<int>(axis)] < 0) ? 1 : 0);
    return true;
  }
  SurfacePoint surface_point(const Ray& ray, const ShapeHit& hit) const;
  /// By position: the point at the ray's lower limit is outside the closed box, so that the face hit is one
  /// that the ray goes in through. The face says so whatever rounding did to that point.
  bool entering(const Ray& ray, double /*lo*/, const ShapeHit& hit) const {
    const bool high_face = (hit.part & 1) != 0;
    return high_face == (ray.direction[static_cast<int>(hit.part / 2)] < 0);
  }
  /// None (objects.md 3).
  TextureCoordinates texture_coordinates(const Vec3& /*x*/, const Vec3& /*facing_normal*/,
                                         const ShapeHit& /*hit*/) const {
    return {};
  }
  Bounds3 bounds() const { return {lo_, hi_}; }

 private:
  /// Where the ray meets the planes of the low and the high face.
  struct Slab {
    double low, high;
    double near() const { return std::min(low, high); }
    double far() const { return std::max(low, high); }
  };
  /// For a component of exactly zero, of either sign: all of the ray if the origin is within the closed slab,
  /// or nothing.
  static Slab parallel_slab(double origin, double low, double high) {
    constexpr double kInf = std::numeric_limits<double>::infinity();
    return origin >= low && origin <= high ? Slab{-kInf, kInf} : Slab{kInf, kInf};
  }

  Vec3 lo_, hi_;
  double band_;  ///< how near to an edge the first of its faces gives the normal (objects.md G17)
};

}  // namespace rayshade
