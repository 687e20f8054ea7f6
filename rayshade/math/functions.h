// SPDX-License-Identifier: MIT
// The one header through which pixels see transcendental functions.
//
// The C library picks other code on other processors, so the last bits of its sin, pow, ... differ from
// machine to machine. These are SLEEF's "cinz" functions: no fused operations, the same bits on every
// x86-64 processor, error at most 1.0 ulp (hypot 0.5). sqrt, floor, fabs and ldexp are exact in IEEE
// arithmetic and come from <cmath>.
#pragma once

#include <cstddef>

namespace rayshade::fn {

inline constexpr double kPi = 3.14159265358979323846;

double sin(double x);
double cos(double x);
double tan(double x);
double asin(double x);
double acos(double x);
double atan(double x);
double atan2(double y, double x);
double exp(double x);
double log(double x);
double pow(double x, double y);
/// pow(x, y) for x >= 0 in half the time, for colours: exp(y log x), whose relative error is up to
/// 3 + 2 |y log x| units of 2^-53. 1 for y = 0.
double pow_by_log(double x, double y);
/// out[i] = pow(x[i], y[i]), to the same bits, at a fraction of the time. `out` may be `x` or `y`.
void pow_each(const double* x, const double* y, double* out, std::size_t count);
double hypot(double x, double y);
double cbrt(double x);

}  // namespace rayshade::fn
