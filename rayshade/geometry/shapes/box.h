// SPDX-License-Identifier: MIT
// The axis-aligned box (objects.md 4.3), by slabs, on its exact extent.
#pragma once

#include <cstdint>
#include <limits>

#include "rayshade/geometry/ray.h"
#include "rayshade/math/bounds.h"
#include "rayshade/scene/shape.h"

namespace rayshade {

class Box {
 public:
  explicit Box(const shape::Box& box) : lo_(box.lo), hi_(box.hi) {}

  /// The entry t0 if t0 > lo, else the exit t1 if t1 >= lo; t <= hi. hit.part: 2 * axis, plus 1 for the high
  /// face.
  bool intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const {
    double entry = -std::numeric_limits<double>::infinity(), exit = -entry;
    std::uint32_t entry_face = 0, exit_face = 0;
    const bool meets =
        clip(ray.origin.x, ray.direction.x, lo_.x, hi_.x, 0, entry, exit, entry_face, exit_face) &&
        clip(ray.origin.y, ray.direction.y, lo_.y, hi_.y, 2, entry, exit, entry_face, exit_face) &&
        clip(ray.origin.z, ray.direction.z, lo_.z, hi_.z, 4, entry, exit, entry_face, exit_face);
    if (!meets || !(exit >= lo)) return false;
    const double t = entry > lo ? entry : exit;
    if (!(t <= hi && t < std::numeric_limits<double>::infinity())) return false;
    hit.t = t;
    hit.part = entry > lo ? entry_face : exit_face;
    return true;
  }
  SurfacePoint surface_point(const Ray& ray, const ShapeHit& hit) const;
  /// By position: the point at the ray's lower limit is outside the closed box.
  bool entering(const Ray& ray, double lo, const ShapeHit& /*hit*/) const {
    return !bounds().contains(ray.at(lo));
  }
  /// None (objects.md 3).
  TextureCoordinates texture_coordinates(const Vec3& /*x*/, const Vec3& /*facing_normal*/,
                                         const ShapeHit& /*hit*/) const {
    return {};
  }
  Bounds3 bounds() const { return {lo_, hi_}; }

 private:
  /// Narrows [entry, exit] to the slab [a, b]; false where nothing remains. A component of exactly zero, of
  /// either sign, asks whether the origin is within the closed slab. Division, not a reciprocal: a shared
  /// face of two boxes gives both the same t, rounded once.
  static bool clip(double o, double d, double a, double b, std::uint32_t face, double& entry, double& exit,
                   std::uint32_t& entry_face, std::uint32_t& exit_face) {
    if (d == 0) return o >= a && o <= b;
    const bool forward = d > 0;
    const double in = ((forward ? a : b) - o) / d, out = ((forward ? b : a) - o) / d;
    if (in > entry) entry = in, entry_face = face + (forward ? 0 : 1);
    if (out < exit) exit = out, exit_face = face + (forward ? 1 : 0);
    return entry <= exit;
  }

  Vec3 lo_, hi_;
};

}  // namespace rayshade
