// SPDX-License-Identifier: MIT
// Fused multiply-add where it is meant: one rounding instead of two, the same bits on every machine (the C library
// computes it exactly where the processor cannot). The compiler never fuses on its own (docs/determinism.md).
#pragma once

#include <cmath>

#include "rayshade/math/vec.h"

namespace rayshade::fused {

/// a + s b with one rounding per component.
inline Vec3 add_scaled(const Vec3& a, double s, const Vec3& b) {
  return {std::fma(s, b.x, a.x), std::fma(s, b.y, a.y), std::fma(s, b.z, a.z)};
}

/// `a` over its length; the sum of squares is fused from x to z.
inline Vec3 normalize(const Vec3& a) {
  const double square = std::fma(a.z, a.z, std::fma(a.y, a.y, a.x * a.x));
  if (!(square > 1e-280 && square < 1e280)) return rayshade::normalize(a);
  return a / std::sqrt(square);
}

}  // namespace rayshade::fused
