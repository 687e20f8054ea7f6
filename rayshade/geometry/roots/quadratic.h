// SPDX-License-Identifier: MIT
// Real roots of quadratics without cancellation, and differences of products with full accuracy.
#pragma once

#include <cmath>
#include <utility>

namespace rayshade {

/// Roots in ascending order; either may be infinite or NaN where the quadratic has fewer: compare so that
/// these fail.
struct QuadraticRoots {
  double near, far;
};

/// Roots of a t^2 + 2 b t + c from the root of b^2 - a c, which the caller knows better than this function
/// could: q/a and c/q with q = -(b + sign(b) root), so that nothing cancels. a = 0 leaves the root of 2 b t +
/// c and an infinite (or NaN) one. b = root = 0 is a double root at zero.
inline QuadraticRoots quadratic_roots(double a, double b, double c, double root) {
  const double q = b < 0 ? root - b : -(root + b);
  if (q == 0) return {0 / a, 0 / a};
  const double large = q / a, small = c / q;
  // Not std::minmax: where one root is NaN (a = q = 0 was excluded, a = c = 0 is not) both must be kept.
  return large < small ? QuadraticRoots{large, small} : QuadraticRoots{small, large};
}

/// x y exactly, as an unevaluated sum (Dekker, 1971), for products away from over- and underflow.
struct ExactProduct {
  double high, low;
};
inline ExactProduct exact_product(double x, double y) {
  constexpr double kSplitter = 0x1p27 + 1;
  const auto split = [](double v) {
    const double big = kSplitter * v;
    const double head = big - (big - v);
    return std::pair{head, v - head};
  };
  const auto [xh, xl] = split(x);
  const auto [yh, yl] = split(y);
  const double high = x * y;
  return {high, ((xh * yh - high) + xh * yl + xl * yh) + xl * yl};
}

/// a b - c d, to within two roundings of the result.
inline double product_difference(double a, double b, double c, double d) {
  const ExactProduct p = exact_product(a, b), q = exact_product(c, d);
  return (p.high - q.high) + (p.low - q.low);
}

/// The real roots of a t^2 + 2 b t + c; false where it has none. The discriminant is computed as if in twice
/// the precision, so nearly equal roots are told apart, or from none, as the coefficients say.
inline bool solve_quadratic(double a, double b, double c, QuadraticRoots& roots) {
  const double discriminant = product_difference(b, b, a, c);
  if (!(discriminant >= 0)) return false;
  roots = quadratic_roots(a, b, c, std::sqrt(discriminant));
  return true;
}

}  // namespace rayshade
