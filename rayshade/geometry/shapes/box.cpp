// SPDX-License-Identifier: MIT
#include "rayshade/geometry/shapes/box.h"

namespace rayshade {

SurfacePoint Box::surface_point(const Ray& ray, const ShapeHit& hit) const {
  Vec3 p = ray.at(hit.t);
  for (int axis = 0; axis < 3; ++axis) p[axis] = std::clamp(p[axis], lo_[axis], hi_[axis]);
  const int hit_axis = static_cast<int>(hit.part / 2);
  p[hit_axis] = hit.part % 2 ? hi_[hit_axis] : lo_[hit_axis];

  // Near an edge the first face within the tolerance gives the normal, in the order +x, -x, +y, ...
  // (objects.md G17). The tolerance shrinks with small boxes, and never reaches across a thin one. The face
  // that was hit always matches.
  SurfacePoint out;
  out.point = p;
  for (int axis = 0; axis < 3; ++axis) {
    const double to_high = std::fabs(p[axis] - hi_[axis]), to_low = std::fabs(p[axis] - lo_[axis]);
    const bool high = to_high < band_ || to_high == 0;
    if (!high && !(to_low < band_ || to_low == 0)) continue;
    out.normal[axis] = high ? 1 : -1;
    out.error = high ? to_high : to_low;  // zero except where the normal is that of a neighbouring face
    break;
  }
  out.geometric_normal = out.normal;
  return out;
}

}  // namespace rayshade
