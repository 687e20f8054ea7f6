// SPDX-License-Identifier: MIT
// Closed intervals with outward rounding, for conservative bounds of animated values.
//
// Every operation widens its result by one ulp on both sides (four for transcendental functions), which
// contains both the exact range of the operation and every rounded result that rayshade/math computes for
// members of its operands. Members for which an operation has no value (the root of a negative number, 0/0)
// are left out of its range; a range of which nothing is known is everything().
#pragma once

#include <limits>

#include "rayshade/math/vec.h"

namespace rayshade {

struct Interval {
  double lo = 0, hi = 0;

  static Interval point(double v) { return {v, v}; }
  static Interval everything() {
    constexpr double inf = std::numeric_limits<double>::infinity();
    return {-inf, inf};
  }
  bool is_point() const { return lo == hi; }
  bool contains(double v) const { return v >= lo && v <= hi; }
};

Interval operator+(const Interval& a, const Interval& b);
Interval operator-(const Interval& a, const Interval& b);
Interval operator-(const Interval& a);
Interval operator*(const Interval& a, const Interval& b);
/// Everything where `b` contains zero.
Interval operator/(const Interval& a, const Interval& b);
Interval join(const Interval& a, const Interval& b);

/// Ranges of the expression functions of language.md 3.2; conservative, tight where the function is monotone.
Interval sin(const Interval& a);
Interval cos(const Interval& a);
Interval tan(const Interval& a);
Interval asin(const Interval& a);
Interval acos(const Interval& a);
Interval atan(const Interval& a);
Interval sqrt(const Interval& a);
Interval hypot(const Interval& a, const Interval& b);
Interval pow(const Interval& a, const Interval& b);
/// C remainder of the operands truncated to integers.
Interval integer_remainder(const Interval& a, const Interval& b);

}  // namespace rayshade
