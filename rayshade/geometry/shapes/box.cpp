// SPDX-License-Identifier: MIT
#include "rayshade/geometry/shapes/box.h"

namespace rayshade {

SurfacePoint Box::surface_point(const Ray& ray, const ShapeHit& hit) const {
  // No component is chosen by a number: a vector read back after that waits for its own store.
  const bool high_face = hit.part % 2 != 0;
  const std::uint32_t hit_axis = hit.part / 2;
  const Vec3 along = ray.at(hit.t);
  const auto component = [&](std::uint32_t axis, double at, double lo, double hi) {
    return axis != hit_axis ? std::clamp(at, lo, hi) : high_face ? hi : lo;
  };
  const Vec3 p{component(0, along.x, lo_.x, hi_.x), component(1, along.y, lo_.y, hi_.y),
               component(2, along.z, lo_.z, hi_.z)};

  // Near an edge the first face within the tolerance gives the normal, in the order +x, -x, +y, ...
  // (objects.md G17). The tolerance shrinks with small boxes, and never reaches across a thin one. The face
  // that was hit always matches.
  SurfacePoint out;
  out.point = p;
  const auto face = [&](double at, double lo, double hi) {
    const double to_high = std::fabs(at - hi), to_low = std::fabs(at - lo);
    const bool high = to_high < band_ || to_high == 0;
    if (!high && !(to_low < band_ || to_low == 0)) return 0.0;
    out.error = high ? to_high : to_low;  // zero except where the normal is that of a neighbouring face
    return high ? 1.0 : -1.0;
  };
  const double x = face(p.x, lo_.x, hi_.x), y = x == 0 ? face(p.y, lo_.y, hi_.y) : 0;
  const double z = x == 0 && y == 0 ? face(p.z, lo_.z, hi_.z) : 0;
  out.normal = {x, y, z};
  out.geometric_normal = {x, y, z};
  return out;
}

}  // namespace rayshade
