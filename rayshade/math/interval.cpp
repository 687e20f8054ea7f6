// SPDX-License-Identifier: MIT
// Interval arithmetic with outward rounding.
//
// Soundness: rounding to nearest is monotone, so the rounded bounds of an operation already enclose every
// rounded result of that operation on members of its operands; the further ulp outward encloses the exact
// results too. The functions of math/functions.h are within one ulp of the truth but need not be monotone in
// their last bits: their bounds are moved out by four ulps and by kTiny, which covers twice their error on
// either side and the flushing of denormals.
#include "rayshade/math/interval.h"

#include <bit>
#include <cmath>
#include <cstdint>

#include "rayshade/math/functions.h"

namespace rayshade {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kTiny = 1e-300;
constexpr double kHalfPi = fn::kPi / 2;

/// The next double above `x`; +inf and NaN stay. Same as std::nextafter, without the call.
double next_up(double x) {
  if (!(x < kInf)) return x;
  if (x == 0) return std::numeric_limits<double>::denorm_min();
  const auto bits = std::bit_cast<std::uint64_t>(x);
  return std::bit_cast<double>(x > 0 ? bits + 1 : bits - 1);
}

double next_down(double x) { return -next_up(-x); }

/// One ulp outward; a NaN bound (inf - inf, 0 * inf of the ends) says nothing, hence becomes infinite.
Interval widened(double lo, double hi) {
  return {std::isnan(lo) ? -kInf : next_down(lo), std::isnan(hi) ? kInf : next_up(hi)};
}

/// Outward by the error of a transcendental function at either end.
Interval widened_function(double lo, double hi) {
  for (int i = 0; i < 4; ++i) {
    lo = next_down(lo);
    hi = next_up(hi);
  }
  return {std::isnan(lo) ? -kInf : lo - kTiny, std::isnan(hi) ? kInf : hi + kTiny};
}

bool valid(const Interval& a) { return a.lo <= a.hi; }

/// Whether some phase + k * period (k an integer) may lie in `a`. The quotients are wrong by less than 1e-6
/// below the size that is tested first.
bool may_contain_phase(const Interval& a, double phase, double period) {
  if (!(std::fabs(a.lo) < 1e8 && std::fabs(a.hi) < 1e8)) return true;
  const double margin = 1e-6;
  return std::floor((a.hi - phase) / period + margin) != std::floor((a.lo - phase) / period - margin);
}

/// The range of a function of period 2 pi and values in [-1, 1], from its values at the ends and the phase of
/// its maximum; the minimum is half a period away.
Interval periodic_range(const Interval& a, double at_lo, double at_hi, double maximum_phase) {
  Interval out = widened_function(std::min(at_lo, at_hi), std::max(at_lo, at_hi));
  const Interval unit = widened_function(-1, 1);
  if (may_contain_phase(a, maximum_phase, 2 * fn::kPi)) out.hi = unit.hi;
  if (may_contain_phase(a, maximum_phase - fn::kPi, 2 * fn::kPi)) out.lo = unit.lo;
  return {std::max(out.lo, unit.lo), std::min(out.hi, unit.hi)};
}

/// 0 * inf is 0 here: the infinite end stands for values without bound, and zero times any of those is zero.
double end_product(double a, double b) { return a == 0 || b == 0 ? 0 : a * b; }

double magnitude_min(const Interval& a) { return a.lo > 0 ? a.lo : a.hi < 0 ? -a.hi : 0; }
double magnitude_max(const Interval& a) { return std::max(std::fabs(a.lo), std::fabs(a.hi)); }

/// x^n for an integer n > 0 over a base that may be negative.
Interval positive_integer_power(const Interval& a, double n) {
  if (std::fmod(n, 2) != 0) return widened_function(fn::pow(a.lo, n), fn::pow(a.hi, n));
  Interval out = widened_function(fn::pow(magnitude_min(a), n), fn::pow(magnitude_max(a), n));
  out.lo = std::max(out.lo, 0.0);
  return out;
}

}  // namespace

Interval operator+(const Interval& a, const Interval& b) { return widened(a.lo + b.lo, a.hi + b.hi); }

Interval operator-(const Interval& a, const Interval& b) { return widened(a.lo - b.hi, a.hi - b.lo); }

Interval operator-(const Interval& a) { return {-a.hi, -a.lo}; }

Interval operator*(const Interval& a, const Interval& b) {
  // A factor that is exactly zero or one leaves nothing to round: matrices are full of them.
  if ((a.lo == 0 && a.hi == 0) || (b.lo == 0 && b.hi == 0)) return {0, 0};
  if (a.lo == 1 && a.hi == 1) return b;
  if (b.lo == 1 && b.hi == 1) return a;
  const double p = end_product(a.lo, b.lo), q = end_product(a.lo, b.hi);
  const double r = end_product(a.hi, b.lo), s = end_product(a.hi, b.hi);
  if (std::isnan(p) || std::isnan(q) || std::isnan(r) || std::isnan(s)) return Interval::everything();
  return widened(std::min(std::min(p, q), std::min(r, s)), std::max(std::max(p, q), std::max(r, s)));
}

Interval operator/(const Interval& a, const Interval& b) {
  if (!valid(a) || !valid(b) || b.contains(0)) return Interval::everything();
  const double p = a.lo / b.lo, q = a.lo / b.hi, r = a.hi / b.lo, s = a.hi / b.hi;
  if (std::isnan(p) || std::isnan(q) || std::isnan(r) || std::isnan(s)) return Interval::everything();
  return widened(std::min(std::min(p, q), std::min(r, s)), std::max(std::max(p, q), std::max(r, s)));
}

Interval join(const Interval& a, const Interval& b) { return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)}; }

Interval sin(const Interval& a) {
  if (!std::isfinite(a.lo) || !std::isfinite(a.hi)) return widened_function(-1, 1);
  return periodic_range(a, fn::sin(a.lo), fn::sin(a.hi), kHalfPi);
}

Interval cos(const Interval& a) {
  if (!std::isfinite(a.lo) || !std::isfinite(a.hi)) return widened_function(-1, 1);
  return periodic_range(a, fn::cos(a.lo), fn::cos(a.hi), 0);
}

Interval tan(const Interval& a) {
  if (!std::isfinite(a.lo) || !std::isfinite(a.hi) || may_contain_phase(a, kHalfPi, fn::kPi)) {
    return Interval::everything();
  }
  return widened_function(fn::tan(a.lo), fn::tan(a.hi));
}

Interval asin(const Interval& a) {
  if (!valid(a) || a.hi < -1 || a.lo > 1) return Interval::everything();
  return widened_function(fn::asin(std::max(a.lo, -1.0)), fn::asin(std::min(a.hi, 1.0)));
}

Interval acos(const Interval& a) {
  if (!valid(a) || a.hi < -1 || a.lo > 1) return Interval::everything();
  return widened_function(fn::acos(std::min(a.hi, 1.0)), fn::acos(std::max(a.lo, -1.0)));
}

Interval atan(const Interval& a) {
  if (!valid(a)) return Interval::everything();
  return widened_function(fn::atan(a.lo), fn::atan(a.hi));
}

Interval sqrt(const Interval& a) {
  if (!valid(a) || a.hi < 0) return Interval::everything();
  const Interval out = widened(std::sqrt(std::max(a.lo, 0.0)), std::sqrt(a.hi));
  return {std::max(out.lo, 0.0), out.hi};
}

Interval hypot(const Interval& a, const Interval& b) {
  if (!valid(a) || !valid(b)) return Interval::everything();
  const Interval out = widened_function(fn::hypot(magnitude_min(a), magnitude_min(b)),
                                        fn::hypot(magnitude_max(a), magnitude_max(b)));
  return {std::max(out.lo, 0.0), out.hi};
}

Interval pow(const Interval& a, const Interval& b) {
  if (!valid(a) || !valid(b)) return Interval::everything();
  if (b.is_point() && b.lo == std::trunc(b.lo) && std::fabs(b.lo) < 1e9) {
    if (b.lo == 0) return Interval::point(1);
    if (b.lo > 0) return positive_integer_power(a, b.lo);
    if (a.contains(0)) return Interval::everything();
    if (a.hi < 0) {  // monotone on the negative side; the order of the ends depends on the parity
      const double p = fn::pow(a.lo, b.lo), q = fn::pow(a.hi, b.lo);
      return widened_function(std::min(p, q), std::max(p, q));
    }
  }
  // x^y is monotone in x for a fixed y and in y for a fixed x wherever x > 0, and for x = 0 if y >= 0: its
  // extremes over a rectangle are at corners. A negative base has a value at isolated integers only.
  if (!(a.lo > 0 || (a.lo == 0 && b.lo >= 0))) return Interval::everything();
  const double p = fn::pow(a.lo, b.lo), q = fn::pow(a.lo, b.hi), r = fn::pow(a.hi, b.lo),
               s = fn::pow(a.hi, b.hi);
  if (std::isnan(p) || std::isnan(q) || std::isnan(r) || std::isnan(s)) return Interval::everything();
  const Interval out =
      widened_function(std::min(std::min(p, q), std::min(r, s)), std::max(std::max(p, q), std::max(r, s)));
  return {std::max(out.lo, 0.0), out.hi};
}

Interval integer_remainder(const Interval& a, const Interval& b) {
  if (!valid(a) || !valid(b)) return Interval::everything();
  const double lo = std::trunc(a.lo), hi = std::trunc(a.hi);
  const double divisor_lo = std::trunc(b.lo), divisor_hi = std::trunc(b.hi);
  const double largest_divisor = std::max(std::fabs(divisor_lo), std::fabs(divisor_hi));
  // |r| < |divisor| and |r| <= |dividend|, with the sign of the dividend; a divisor of zero has no value at
  // all.
  Interval out{lo < 0 ? -std::min(-lo, std::max(largest_divisor - 1, 0.0)) : 0,
               hi > 0 ? std::min(hi, std::max(largest_divisor - 1, 0.0)) : 0};
  if (divisor_lo == divisor_hi && divisor_lo != 0 && std::isfinite(lo) && std::isfinite(hi) &&
      std::isfinite(divisor_lo) && (lo >= 0 || hi <= 0)) {
    // Within one period the remainder grows with the dividend.
    const double first = std::fmod(lo, divisor_lo), last = std::fmod(hi, divisor_lo);
    if (hi - lo < std::fabs(divisor_lo) && first <= last) out = {first, last};
  }
  return out;
}

}  // namespace rayshade
