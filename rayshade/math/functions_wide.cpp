// SPDX-License-Identifier: MIT
// Many powers at once. SLEEF's "cinz" functions give the same bits in a vector of any length as one by one,
// and its scalar form is the slowest of them by far.
#include <immintrin.h>
#include <sleef.h>

#include <algorithm>

#include "rayshade/math/functions.h"

// The header declares these only where every file is compiled for such a processor; clang wants to be told
// that they are.
extern "C" {
__attribute__((target("avx"))) __m256d Sleef_cinz_powd4_u10avx(__m256d, __m256d);
__attribute__((target("avx512f"))) __m512d Sleef_cinz_powd8_u10avx512fnofma(__m512d, __m512d);
}

namespace rayshade::fn {
namespace {

void pow2(const double* x, const double* y, double* out) {
  _mm_storeu_pd(out, Sleef_cinz_powd2_u10sse2(_mm_loadu_pd(x), _mm_loadu_pd(y)));
}

__attribute__((target("avx"))) void pow4(const double* x, const double* y, double* out) {
  _mm256_storeu_pd(out, Sleef_cinz_powd4_u10avx(_mm256_loadu_pd(x), _mm256_loadu_pd(y)));
}

__attribute__((target("avx512f"))) void pow8(const double* x, const double* y, double* out) {
  _mm512_storeu_pd(out, Sleef_cinz_powd8_u10avx512fnofma(_mm512_loadu_pd(x), _mm512_loadu_pd(y)));
}

struct Wide {
  std::size_t lanes;
  void (*pow)(const double*, const double*, double*);
};

Wide widest() {
  if (__builtin_cpu_supports("avx512f")) return {8, pow8};
  if (__builtin_cpu_supports("avx")) return {4, pow4};
  return {2, pow2};
}

}  // namespace

double pow(double x, double y) {
  // One lane of two; the other is given something harmless.
  return _mm_cvtsd_f64(Sleef_cinz_powd2_u10sse2(_mm_set_pd(1, x), _mm_set_pd(1, y)));
}

void pow_each(const double* x, const double* y, double* out, std::size_t count) {
  static const Wide wide = widest();
  std::size_t i = 0;
  for (; count - i >= wide.lanes; i += wide.lanes) wide.pow(x + i, y + i, out + i);
  const std::size_t left = count - i;
  if (left == 0) return;
  constexpr std::size_t kMost = 8;
  double base[kMost], exponent[kMost], result[kMost];
  std::fill_n(base, kMost, 1.0);
  std::fill_n(exponent, kMost, 1.0);
  std::copy_n(x + i, left, base);
  std::copy_n(y + i, left, exponent);
  if (left <= 2)
    pow2(base, exponent, result);
  else
    wide.pow(base, exponent, result);
  std::copy_n(result, left, out + i);
}

}  // namespace rayshade::fn
