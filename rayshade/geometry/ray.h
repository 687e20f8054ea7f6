// SPDX-License-Identifier: MIT
// Rays, and what a shape says of one that meets it.
#pragma once

#include <cstdint>

#include "rayshade/math/bounds.h"
#include "rayshade/math/vec.h"

namespace rayshade {

/// Points origin + t direction. Directions inside instances are not renormalised, so that t is the same
/// number in every space (rule 1); shapes must accept directions of any length.
struct Ray {
  Vec3 origin;
  Vec3 direction;
  double time = 0;
  /// False for a world ray whose direction is knowingly not of unit length (it left a surface under fbmbump,
  /// shading.md 2.3). Only the sphere without a transform cares (objects.md 4.2).
  bool unit = true;

  Vec3 at(double t) const { return origin + t * direction; }
};

inline Ray transformed(const Ray& ray, const Affine& map) {
  return {map.point(ray.origin), map.vector(ray.direction), ray.time, true};
}

/// Where a ray meets a shape, in the shape's own terms: enough to find point, normal and (u, v) later.
/// Nothing is ever kept in the shape (objects.md G20).
struct ShapeHit {
  double t = 0;
  double a = 0, b = 0;     ///< triangle: weights of p2 and p3; height field: coordinates within the cell
  std::uint32_t part = 0;  ///< box: face; height field: triangle number
};

/// The surface at a hit, in the space of the primitive.
struct SurfacePoint {
  Vec3 point;             ///< moved onto the surface as exactly as the shape can
  Vec3 normal;            ///< shading normal, unit, not flipped (objects.md 1.11.2)
  Vec3 geometric_normal;  ///< unit, not flipped; differs from `normal` on smooth triangles only
  double error = 0;     ///< bound on the distance of `point` from the true surface along its normal (rule 8)
  bool smooth = false;  ///< triangles with vertex normals
};

/// Surface coordinates and their tangents in primitive space (objects.md 4); 0, 0, x axis, y axis where there
/// are none.
struct TextureCoordinates {
  double u = 0, v = 0;
  Vec3 du{1, 0, 0}, dv{0, 1, 0};
};

}  // namespace rayshade
