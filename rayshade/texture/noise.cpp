// SPDX-License-Identifier: MIT
// The noise functions. They are the hot spot of textured scenes: the eight corners share the first two
// look-ups of the hash (14 table reads instead of 24), and everything else is straight-line arithmetic, four
// corners at once where the processor can (noise_avx2.cpp).
#include "rayshade/texture/noise.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "rayshade/math/functions.h"
#include "rayshade/texture/noise_kernels.h"
#include "rayshade/texture/noise_tables.h"

namespace rayshade {
namespace {

using noise_tables::kGradients;
using noise_tables::kLowBytes;
using noise_tables::kPermutation;

/// One coordinate within its lattice cell.
struct Axis {
  std::uint32_t low, high;  ///< table indices of the two lattice planes
  double d0, d1;            ///< offsets from them: in [0, 1) and [-1, 0)
  double w0, w1;            ///< their smooth weights
};

inline Axis axis_of(double coordinate) {
  // The shift of the original; its rounding is part of the result.
  const double x = coordinate + 1000000;
  Axis axis;
  // A conversion is much cheaper than floor() on processors without a rounding instruction.
  if (std::fabs(x) < 0x1p62) {
    std::int64_t cell = static_cast<std::int64_t>(x);
    if (static_cast<double>(cell) > x) --cell;
    axis.low = static_cast<std::uint32_t>(cell & 4095);
    axis.high = static_cast<std::uint32_t>((cell + 1) & 4095);
    axis.d0 = x - static_cast<double>(cell);
    axis.d1 = x - static_cast<double>(cell + 1);
  } else {
    // So large that every number is an integer; or not a number, which must come through.
    const double cell = std::fmod(x, 4096);
    axis.low = std::isfinite(cell) ? static_cast<std::uint32_t>(cell < 0 ? cell + 4096 : cell) : 0;
    axis.high = (axis.low + 1) & 4095;
    axis.d0 = x - x;
    axis.d1 = axis.d0 - 1;
  }
  axis.w1 = axis.d0 * axis.d0 * (3 - 2 * axis.d0);
  axis.w0 = 1 - axis.w1;
  return axis;
}

/// Where the gradients of the eight corners start: index a + 2 b + 4 c.
struct Corners {
  std::uint32_t m[8];
};

inline Corners corners_of(const Axis& x, const Axis& y, const Axis& z) {
  const std::uint32_t x0 = kPermutation[x.low], x1 = kPermutation[x.high];
  const std::uint32_t x0y0 = kPermutation[x0 ^ y.low], x1y0 = kPermutation[x1 ^ y.low];
  const std::uint32_t x0y1 = kPermutation[x0 ^ y.high], x1y1 = kPermutation[x1 ^ y.high];
  return {{kLowBytes[x0y0 ^ z.low], kLowBytes[x1y0 ^ z.low], kLowBytes[x0y1 ^ z.low], kLowBytes[x1y1 ^ z.low],
           kLowBytes[x0y0 ^ z.high], kLowBytes[x1y0 ^ z.high], kLowBytes[x0y1 ^ z.high],
           kLowBytes[x1y1 ^ z.high]}};
}

constexpr double kHighestFrequency = 1e200;

inline double contribution(std::uint32_t m, double w, double dx, double dy, double dz) {
  const double* r = &kGradients[m];
  return w * (0.5 * r[0] + r[1] * dx + r[2] * dy + r[3] * dz);
}

/// Sum of weight^i f(frequency^i point), the factors by repeated multiplication as the original has them.
/// Ends early where the weight falls below `least`, and before the coordinates overflow.
template <typename Value, typename Function>
inline Value sum_octaves(const Vec3& point, double weight, double frequency, int octaves, Function f,
                         double least = -std::numeric_limits<double>::infinity()) {
  octaves = std::min(octaves, kMaxOctaves);
  Value sum{};
  double w = 1, s = 1;
  for (int i = 0; i < octaves; ++i) {
    sum += w * f(point * s);
    s *= frequency;
    w *= weight;
    if (w < least || std::fabs(s) > kHighestFrequency) break;
  }
  return sum;
}

const NoiseKernel& kernel() {
  static const NoiseKernel best = best_noise_kernel();
  return best;
}

}  // namespace

namespace noise_detail {

double noise3_scalar(const Vec3& point) {
  const Axis x = axis_of(point.x), y = axis_of(point.y), z = axis_of(point.z);
  const Corners corner = corners_of(x, y, z);
  const std::uint32_t* m = corner.m;
  const double w00 = x.w0 * y.w0, w10 = x.w1 * y.w0, w01 = x.w0 * y.w1, w11 = x.w1 * y.w1;
  double sum = contribution(m[0], w00 * z.w0, x.d0, y.d0, z.d0);
  sum += contribution(m[1], w10 * z.w0, x.d1, y.d0, z.d0);
  sum += contribution(m[2], w01 * z.w0, x.d0, y.d1, z.d0);
  sum += contribution(m[3], w11 * z.w0, x.d1, y.d1, z.d0);
  sum += contribution(m[4], w00 * z.w1, x.d0, y.d0, z.d1);
  sum += contribution(m[5], w10 * z.w1, x.d1, y.d0, z.d1);
  sum += contribution(m[6], w01 * z.w1, x.d0, y.d1, z.d1);
  sum += contribution(m[7], w11 * z.w1, x.d1, y.d1, z.d1);
  return sum;
}

Vec3 dnoise3_scalar(const Vec3& point) {
  const Axis x = axis_of(point.x), y = axis_of(point.y), z = axis_of(point.z);
  const Corners corner = corners_of(x, y, z);
  const double w00 = x.w0 * y.w0, w10 = x.w1 * y.w0, w01 = x.w0 * y.w1, w11 = x.w1 * y.w1;
  Vec3 sum;
  const auto add = [&](std::uint32_t m, double w, double dx, double dy, double dz) {
    sum.x += contribution(m, w, dx, dy, dz);
    sum.y += contribution(m + 4, w, dx, dy, dz);
    sum.z += contribution(m + 8, w, dx, dy, dz);
  };
  // Around the cell edge by edge, not in the order of noise3.
  add(corner.m[0], w00 * z.w0, x.d0, y.d0, z.d0);
  add(corner.m[1], w10 * z.w0, x.d1, y.d0, z.d0);
  add(corner.m[3], w11 * z.w0, x.d1, y.d1, z.d0);
  add(corner.m[2], w01 * z.w0, x.d0, y.d1, z.d0);
  add(corner.m[6], w01 * z.w1, x.d0, y.d1, z.d1);
  add(corner.m[7], w11 * z.w1, x.d1, y.d1, z.d1);
  add(corner.m[5], w10 * z.w1, x.d1, y.d0, z.d1);
  add(corner.m[4], w00 * z.w1, x.d0, y.d0, z.d1);
  return sum;
}

}  // namespace noise_detail

NoiseKernel scalar_noise_kernel() { return {noise_detail::noise3_scalar, noise_detail::dnoise3_scalar}; }

NoiseKernel best_noise_kernel() {
  if (__builtin_cpu_supports("avx2")) return {noise_detail::noise3_avx2, noise_detail::dnoise3_avx2};
  return scalar_noise_kernel();
}

double noise3(const Vec3& point) { return kernel().value(point); }
Vec3 dnoise3(const Vec3& point) { return kernel().vector(point); }

double chaos(const Vec3& point, int octaves) {
  return sum_octaves<double>(point, 0.5, 2, octaves, kernel().value);
}

double abs_chaos(const Vec3& point, int octaves) {
  return sum_octaves<double>(point, 0.5, 2, octaves,
                             [value = kernel().value](const Vec3& p) { return std::fabs(value(p)); });
}

double fbm(const Vec3& point, double omega, double lambda, int octaves) {
  return sum_octaves<double>(point, omega, lambda, octaves, kernel().value);
}

Vec3 vfbm(const Vec3& point, double omega, double lambda, int octaves) {
  return sum_octaves<Vec3>(point, omega, lambda, octaves, kernel().vector, kEpsilon);
}

double marble(const Vec3& point) {
  return fn::pow_by_log(0.5 * (fn::sin(8 * chaos(point, 6) + 7 * point.z) + 1), 0.77);
}

double fbm_omega(double h, double lambda) { return fn::pow(lambda, -(1 + 2 * h) / 2); }

Vec3 windy_bump(const Vec3& point, const WindyParameters& p) {
  const double force = p.chaos_scale != 0 ? p.chaos_scale * chaos(p.wind_scale * point, 7) : 1;
  Vec3 bump = p.bump_scale * dnoise3(point);
  double frequency = 1, height = force;
  const int octaves = std::min(p.octaves, kMaxOctaves);
  for (int i = 0; i < octaves; ++i) {
    frequency *= p.frequency_scale;
    if (std::fabs(frequency) > kHighestFrequency) break;
    bump += height * dnoise3(frequency * point);
    height *= p.height_scale;
  }
  return bump * (force + p.offset);
}

}  // namespace rayshade
