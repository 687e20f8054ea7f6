// SPDX-License-Identifier: MIT
// Fused multiply-add where it is meant: one rounding instead of two, the same bits on every machine. Where
// the processor has the instruction it is used; elsewhere the C library computes the same value. The compiler
// never fuses on its own (docs/determinism.md).
#pragma once

#include "rayshade/math/vec.h"

namespace rayshade::fused {

/// a + s b with one rounding per component.
Vec3 add_scaled(const Vec3& a, double s, const Vec3& b);

/// (a + s b) + t c, each sum rounded once, over its length, whose sum of squares is fused from x to z.
/// Vectors whose squared length would under- or overflow are normalised with care instead.
/// The result is made where it stays: read back from a copy, it would be waited for.
void unit_of_sum(const Vec3& a, double s, const Vec3& b, double t, const Vec3& c, Vec3& out);

}  // namespace rayshade::fused
