// SPDX-License-Identifier: MIT
// The unit of the error bounds that shapes report (SurfacePoint::error).
//
// Bounds are first-order sums in the manner of Higham (Accuracy and Stability of Numerical Algorithms, ch.
// 3): a computed product, quotient, sum or root is the exact one times (1 + e) with |e| <= kRoundoff, so n
// operations in a row cost at most n kRoundoff of the sizes that took part. The terms of second order are
// covered by rounding every count up. A bound speaks of the distance along the normal only: where on the
// surface the point lies does not matter.
#pragma once

#include "rayshade/math/vec.h"

namespace rayshade {

inline constexpr double kRoundoff = 0x1p-53;

/// Half an ulp in each coordinate of a stored point: at most kRoundoff |p| along any unit normal.
inline double storage_error(const Vec3& p) { return kRoundoff * length_bound(p); }

/// Relative error of each component of what normalize() returns: two squares' sums, root and quotient
/// cost 3.5.
inline constexpr double kNormalizeError = 4 * kRoundoff;

}  // namespace rayshade
