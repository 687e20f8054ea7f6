// SPDX-License-Identifier: MIT
// Noise with AVX2: the three axes of the point in the lanes of one vector, then the four corners of either
// z plane of its lattice cell. No fused operations; every lane is the scalar computation.
#include <immintrin.h>

#include <array>
#include <cstdint>

#include "rayshade/texture/noise_kernels.h"
#include "rayshade/texture/noise_tables.h"

#define RAYSHADE_AVX2 __attribute__((target("avx2")))

namespace rayshade::noise_detail {
namespace {

using noise_tables::kGradients;
using noise_tables::kLowBytes;
using noise_tables::kPermutation;

/// The cell of a point: where the gradients of its corners start, index a + 2 b + 4 c, and, for the corners
/// (a, b) of a z plane lane by lane, offsets and weights.
struct Cell {
  std::array<std::uint32_t, 8> m;
  __m256d dx, dy, wxy;
  __m256d dz[2], wz[2];
};

/// False where a coordinate is too large for 32-bit cells, or not a number.
RAYSHADE_AVX2 inline bool cell_of(const Vec3& point, Cell& cell) {
  const __m256d x = _mm256_add_pd(_mm256_setr_pd(point.x, point.y, point.z, 0), _mm256_set1_pd(1000000));
  const __m256d magnitude = _mm256_andnot_pd(_mm256_set1_pd(-0.0), x);
  if (_mm256_movemask_pd(_mm256_cmp_pd(magnitude, _mm256_set1_pd(0x1p30), _CMP_LT_OQ)) != 0xf) return false;
  const __m256d floor = _mm256_floor_pd(x);
  const __m256d one = _mm256_set1_pd(1);
  const __m128i low_cell = _mm256_cvtpd_epi32(floor);
  const __m128i mask = _mm_set1_epi32(4095);
  alignas(16) std::uint32_t low[4], high[4];
  _mm_store_si128(reinterpret_cast<__m128i*>(low), _mm_and_si128(low_cell, mask));
  _mm_store_si128(reinterpret_cast<__m128i*>(high),
                  _mm_and_si128(_mm_add_epi32(low_cell, _mm_set1_epi32(1)), mask));
  const __m256d d0 = _mm256_sub_pd(x, floor);
  const __m256d d1 = _mm256_sub_pd(x, _mm256_add_pd(floor, one));
  const __m256d w1 = _mm256_mul_pd(_mm256_mul_pd(d0, d0),
                                   _mm256_sub_pd(_mm256_set1_pd(3), _mm256_mul_pd(_mm256_set1_pd(2), d0)));
  const __m256d w0 = _mm256_sub_pd(one, w1);

  // (x0, x1, z0, z1) and (y0, y1, -, -).
  const __m256d dxz = _mm256_unpacklo_pd(d0, d1), dyy = _mm256_unpackhi_pd(d0, d1);
  const __m256d wxz = _mm256_unpacklo_pd(w0, w1), wyy = _mm256_unpackhi_pd(w0, w1);
  cell.dx = _mm256_permute2f128_pd(dxz, dxz, 0x00);
  cell.dy = _mm256_permute4x64_pd(dyy, 0x50);
  cell.wxy = _mm256_mul_pd(_mm256_permute2f128_pd(wxz, wxz, 0x00), _mm256_permute4x64_pd(wyy, 0x50));
  cell.dz[0] = _mm256_permute4x64_pd(dxz, 0xaa);
  cell.dz[1] = _mm256_permute4x64_pd(dxz, 0xff);
  cell.wz[0] = _mm256_permute4x64_pd(wxz, 0xaa);
  cell.wz[1] = _mm256_permute4x64_pd(wxz, 0xff);

  const std::uint32_t x0 = kPermutation[low[0]], x1 = kPermutation[high[0]];
  const std::uint32_t x0y0 = kPermutation[x0 ^ low[1]], x1y0 = kPermutation[x1 ^ low[1]];
  const std::uint32_t x0y1 = kPermutation[x0 ^ high[1]], x1y1 = kPermutation[x1 ^ high[1]];
  cell.m = {kLowBytes[x0y0 ^ low[2]],  kLowBytes[x1y0 ^ low[2]],  kLowBytes[x0y1 ^ low[2]],
            kLowBytes[x1y1 ^ low[2]],  kLowBytes[x0y0 ^ high[2]], kLowBytes[x1y0 ^ high[2]],
            kLowBytes[x0y1 ^ high[2]], kLowBytes[x1y1 ^ high[2]]};
  return true;
}

/// The contributions of the corners of a z plane, lane a + 2 b, with gradients `shift` further on.
RAYSHADE_AVX2 inline __m256d contributions(const Cell& cell, int plane, std::uint32_t shift) {
  const std::uint32_t* m = cell.m.data() + 4 * plane;
  const __m256d r0 = _mm256_loadu_pd(&kGradients[m[0] + shift]);
  const __m256d r1 = _mm256_loadu_pd(&kGradients[m[1] + shift]);
  const __m256d r2 = _mm256_loadu_pd(&kGradients[m[2] + shift]);
  const __m256d r3 = _mm256_loadu_pd(&kGradients[m[3] + shift]);
  const __m256d a = _mm256_unpacklo_pd(r0, r1), b = _mm256_unpackhi_pd(r0, r1);
  const __m256d c = _mm256_unpacklo_pd(r2, r3), d = _mm256_unpackhi_pd(r2, r3);
  const __m256d constant = _mm256_permute2f128_pd(a, c, 0x20), along_x = _mm256_permute2f128_pd(b, d, 0x20);
  const __m256d along_y = _mm256_permute2f128_pd(a, c, 0x31), along_z = _mm256_permute2f128_pd(b, d, 0x31);
  __m256d sum = _mm256_add_pd(_mm256_mul_pd(_mm256_set1_pd(0.5), constant), _mm256_mul_pd(along_x, cell.dx));
  sum = _mm256_add_pd(sum, _mm256_mul_pd(along_y, cell.dy));
  sum = _mm256_add_pd(sum, _mm256_mul_pd(along_z, cell.dz[plane]));
  return _mm256_mul_pd(_mm256_mul_pd(cell.wxy, cell.wz[plane]), sum);
}

/// Lanes in the order given added to `sum` one after the other.
template <int first, int second, int third, int fourth>
RAYSHADE_AVX2 inline double add_lanes(double sum, __m256d v) {
  alignas(32) double lane[4];
  _mm256_store_pd(lane, v);
  sum += lane[first];
  sum += lane[second];
  sum += lane[third];
  sum += lane[fourth];
  return sum;
}

/// Around the cell edge by edge, not in the order of noise3.
RAYSHADE_AVX2 inline double component(const Cell& cell, std::uint32_t shift) {
  const double sum = add_lanes<0, 1, 3, 2>(0.0, contributions(cell, 0, shift));
  return add_lanes<2, 3, 1, 0>(sum, contributions(cell, 1, shift));
}

}  // namespace

RAYSHADE_AVX2 double noise3_avx2(const Vec3& point) {
  Cell cell;
  if (!cell_of(point, cell)) return noise3_scalar(point);
  // Adding the first corner to -0 changes no bit of it.
  const double sum = add_lanes<0, 1, 2, 3>(-0.0, contributions(cell, 0, 0));
  return add_lanes<0, 1, 2, 3>(sum, contributions(cell, 1, 0));
}

RAYSHADE_AVX2 Vec3 dnoise3_avx2(const Vec3& point) {
  Cell cell;
  if (!cell_of(point, cell)) return dnoise3_scalar(point);
  return {component(cell, 0), component(cell, 4), component(cell, 8)};
}

}  // namespace rayshade::noise_detail
