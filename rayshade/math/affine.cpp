// SPDX-License-Identifier: MIT
#include "rayshade/math/affine.h"

#include "rayshade/math/functions.h"

namespace rayshade {

Affine rotation(const Vec3& n, double radians) {
  const double c = fn::cos(radians), s = fn::sin(radians), k = 1 - c;
  Affine out;
  out.rows[0] = {n.x * n.x + (1 - n.x * n.x) * c, n.x * n.y * k + n.z * s, n.x * n.z * k - n.y * s};
  out.rows[1] = {n.x * n.y * k - n.z * s, n.y * n.y + (1 - n.y * n.y) * c, n.y * n.z * k + n.x * s};
  out.rows[2] = {n.x * n.z * k + n.y * s, n.y * n.z * k - n.x * s, n.z * n.z + (1 - n.z * n.z) * c};
  return out;
}

Affine rotation_degrees(const Vec3& axis, double degrees) {
  const double largest = max_abs(axis);
  if (!(largest > 0) || !std::isfinite(largest)) return {};
  return rotation(normalize(axis), degrees * (fn::kPi / 180));
}

}  // namespace rayshade
