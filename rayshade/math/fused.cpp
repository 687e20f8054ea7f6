// SPDX-License-Identifier: MIT
#include "rayshade/math/fused.h"

#include <cmath>

// Each function is compiled twice, for processors with and without the instruction; both round alike. Not
// under the thread sanitizer: it would watch the resolver, which runs before the sanitizer is ready, and
// crash.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__)
#define RAYSHADE_BOTH_WAYS __attribute__((target_clones("fma", "default")))
#else
#define RAYSHADE_BOTH_WAYS
#endif

namespace rayshade::fused {

RAYSHADE_BOTH_WAYS Vec3 add_scaled(const Vec3& a, double s, const Vec3& b) {
  return {std::fma(s, b.x, a.x), std::fma(s, b.y, a.y), std::fma(s, b.z, a.z)};
}

RAYSHADE_BOTH_WAYS void unit_of_sum(const Vec3& a, double s, const Vec3& b, double t, const Vec3& c,
                                    Vec3& out) {
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
