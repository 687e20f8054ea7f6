// SPDX-License-Identifier: MIT
// The same bits whether by SLEEF's scalar code or by a vector of it: the quicker of the two.
#include "rayshade/math/functions.h"

#include <emmintrin.h>
#include <sleef.h>

namespace rayshade::fn {
namespace {

/// One lane of two; the other is given something harmless.
inline __m128d wide(double x) { return _mm_set_pd(1, x); }
inline double narrow(__m128d x) { return _mm_cvtsd_f64(x); }

}  // namespace

double sin(double x) { return narrow(Sleef_cinz_sind2_u10sse2(wide(x))); }
double cos(double x) { return narrow(Sleef_cinz_cosd2_u10sse2(wide(x))); }
double tan(double x) { return narrow(Sleef_cinz_tand2_u10sse2(wide(x))); }
double asin(double x) { return Sleef_cinz_asind1_u10purec(x); }
double acos(double x) { return Sleef_cinz_acosd1_u10purec(x); }
double atan(double x) { return Sleef_cinz_atand1_u10purec(x); }
double atan2(double y, double x) { return Sleef_cinz_atan2d1_u10purec(y, x); }
double exp(double x) { return narrow(Sleef_cinz_expd2_u10sse2(wide(x))); }
double log(double x) { return narrow(Sleef_cinz_logd2_u10sse2(wide(x))); }
double pow_by_log(double x, double y) { return y == 0 ? 1 : exp(y * log(x)); }
double hypot(double x, double y) { return Sleef_cinz_hypotd1_u05purec(x, y); }
double cbrt(double x) { return Sleef_cinz_cbrtd1_u10purec(x); }

}  // namespace rayshade::fn
