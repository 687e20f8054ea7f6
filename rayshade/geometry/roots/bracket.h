// SPDX-License-Identifier: MIT
// The zero of a function inside a bracket: Newton steps as long as they behave, halving where they do not.
#pragma once

#include <cmath>

namespace rayshade::roots {

struct ValueAndSlope {
  double value, slope;
};

/// The point where `f` changes sign in [a, b]. `positive_at_a` is the state at a; the state at b is taken to
/// be the opposite one (callers decide signs at the ends of brackets once, so that neighbouring brackets
/// agree). `guess` is any point, used where it lies inside. `f(x)` returns a ValueAndSlope; zero counts as
/// "not positive". `tolerance`: the error wanted, a few units in the last place of the numbers at hand.
template <class F>
double bracketed_root(const F& f, double a, double b, bool positive_at_a, double guess, double tolerance) {
  double x = guess > a && guess < b ? guess : 0.5 * (a + b);
  double last_step = b - a;
  bool newton = false;  // the last step was one of Newton's
  // Halving alone ends long before.
  for (int i = 0; i < 200; ++i) {
    const ValueAndSlope v = f(x);
    const bool positive = v.value > 0;
    (positive == positive_at_a ? a : b) = x;
    double next = x - v.value / v.slope;  // not a number or infinite for a zero slope: fails the next test
    const double step = std::fabs(next - x);
    if (next > a && next < b && step <= 0.5 * last_step) {
      // Newton's steps shrink quadratically: the next one would be about step * (step / last_step)^2.
      const double ratio = step / last_step;
      if (step <= tolerance || (newton && step * ratio * ratio <= 0.25 * tolerance)) return next;
      newton = true;
    } else {
      if (v.value == 0 || next == x) return x;
      // Steps that no longer shrink are rounding.
      if (newton && next > a && next < b && last_step <= 4096 * tolerance) return next;
      next = 0.5 * (a + b);
      if (!(next > a && next < b) || b - a <= tolerance) return next;
      newton = false;
    }
    last_step = std::fabs(next - x);
    x = next;
  }
  return x;
}

}  // namespace rayshade::roots
