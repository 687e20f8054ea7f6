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
  const Vec3 extent = hi_ - lo_;
  const double smallest = std::min({extent.x, extent.y, extent.z});
  const double band = std::min(kEpsilon * std::min(1.0, max_abs(extent)), 0.25 * smallest);
  SurfacePoint out;
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool high : {true, false}) {
      const double distance = std::fabs(p[axis] - (high ? hi_ : lo_)[axis]);
      if (!(distance < band || distance == 0)) continue;
      out.point = p;
      out.normal = {};
      out.normal[axis] = high ? 1 : -1;
      out.geometric_normal = out.normal;
      out.error = distance;  // zero except where the normal is that of a neighbouring face
      return out;
    }
  }
  return out;
}

}  // namespace rayshade
