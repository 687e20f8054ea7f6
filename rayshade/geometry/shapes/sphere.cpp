// SPDX-License-Identifier: MIT
#include "rayshade/geometry/shapes/sphere.h"

#include "rayshade/geometry/shapes/frame.h"
#include "rayshade/geometry/shapes/rounding.h"
#include "rayshade/math/functions.h"

namespace rayshade {
namespace {

/// Whether o + t d is within the box for some t >= lo. A zero component asks for the origin.
bool reaches(const Ray& ray, double lo, const Bounds3& box) {
  double entry = lo, exit = Bounds3::kInf;
  for (int axis = 0; axis < 3; ++axis) {
    const double o = ray.origin[axis], d = ray.direction[axis];
    if (d == 0) {
      if (o < box.lo[axis] || o > box.hi[axis]) return false;
      continue;
    }
    const double a = (box.lo[axis] - o) / d, b = (box.hi[axis] - o) / d;
    entry = std::max(entry, std::min(a, b));
    exit = std::min(exit, std::max(a, b));
  }
  return entry <= exit;
}

}  // namespace

bool Sphere::intersect_as_written(const Ray& ray, double lo, double hi, ShapeHit& hit) const {
  // An object without a transform has its bounds enlarged twice (objects.md 9).
  const Bounds3 box = grown(bounds(), 2 * kEpsilon);
  if (!box.contains(ray.at(lo)) && !reaches(ray, lo, box)) return false;
  const Vec3 q = center_ - ray.origin;
  const double b = dot(q, ray.direction);
  const double discriminant = b * b - dot(q, q) + radius_ * radius_;
  if (!(discriminant >= 0)) return false;
  const double root = std::sqrt(discriminant);
  const double t = b - root > lo ? b - root : b + root;
  if (!(t > lo && t <= hi && t < Bounds3::kInf)) return false;
  hit.t = t;
  return true;
}

SurfacePoint Sphere::surface_point(const Ray& ray, const ShapeHit& hit) const {
  const Vec3 p = ray.at(hit.t);
  if (!ray.unit) {
    // The formula as written does not end on the sphere; shading goes on from where it ends.
    const Vec3 normal = (p - center_) / radius_;
    return {p, normal, normal, 4 * kRoundoff * (length(ray.origin) + length(p)), false};
  }
  const Vec3 e = normalize(p - center_);
  const Vec3 on = center_ + radius_ * e;
  // |e| is 1 to within 4 roundings, its product with the radius one more, the sum one of the point.
  return {on, e, e, 6 * kRoundoff * radius_ + 2 * storage_error(on), false};
}

TextureCoordinates Sphere::texture_coordinates(const Vec3& x, const Vec3& /*facing_normal*/,
                                               const ShapeHit& /*hit*/) const {
  const Vec3 e = normalize(x - center_);
  TextureCoordinates out;
  // By tangents: cosines lose half of their digits near 1.
  const double across = std::sqrt(e.x * e.x + e.y * e.y);
  out.v = fn::atan2(across, -e.z) / fn::kPi;
  if (!(std::fabs(out.v) < kEpsilon || std::fabs(out.v - 1) < kEpsilon)) {
    out.u = turns(e.x / across, e.y / across, !(e.y > 0));
  }
  out.du = normalize({-e.y, e.x, 0});
  out.dv = normalize(cross(e, out.du));
  return out;
}

Bounds3 Sphere::bounds() const {
  const Vec3 r{radius_, radius_, radius_};
  return grown({center_ - r, center_ + r}, kRoundoff * (max_abs(center_) + radius_));
}

}  // namespace rayshade
