// SPDX-License-Identifier: MIT
#include "rayshade/math/fused.h"

#include <cmath>

#include "rayshade/math/clones.h"

namespace rayshade::fused {

RAYSHADE_CLONES("fma") Vec3 add_scaled(const Vec3& a, double s, const Vec3& b) {
  return {std::fma(s, b.x, a.x), std::fma(s, b.y, a.y), std::fma(s, b.z, a.z)};
}

RAYSHADE_CLONES("fma")
void unit_of_sum(const Vec3& a, double s, const Vec3& b, double t, const Vec3& c, Vec3& out) {
  const Vec3 sum{std::fma(t, c.x, std::fma(s, b.x, a.x)), std::fma(t, c.y, std::fma(s, b.y, a.y)),
                 std::fma(t, c.z, std::fma(s, b.z, a.z))};
  const double square = std::fma(sum.z, sum.z, std::fma(sum.y, sum.y, sum.x * sum.x));
  if (!(square > 1e-280 && square < 1e280)) {
    out = normalize(sum);
    return;
  }
  const double length = std::sqrt(square);
  out.x = sum.x / length;
  out.y = sum.y / length;
  out.z = sum.z / length;
}

}  // namespace rayshade::fused
