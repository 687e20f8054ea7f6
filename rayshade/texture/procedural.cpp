// SPDX-License-Identifier: MIT
// The formulas of the procedural textures.
#include "rayshade/texture/procedural.h"

#include <cmath>
#include <cstdint>

#include "rayshade/math/functions.h"
#include "rayshade/texture/surface_ops.h"

namespace rayshade {
namespace {

/// trunc(c) above zero, trunc(1 - c) below. Beyond 2^52 every cell counts as even.
std::int64_t checker_cell(double c) {
  const double cell = c > 0 ? c : 1 - c;
  return cell < 0x1p52 ? static_cast<std::int64_t>(cell) : 0;
}

/// The fraction of u within its period, exactly 1 (from tiny negative u) excluded by the comparisons of its
/// users.
double fraction(double u) { return u - std::floor(u); }

}  // namespace

bool checker_is_odd(const Vec3& q) {
  return ((checker_cell(q.x) + checker_cell(q.y) + checker_cell(q.z)) & 1) != 0;
}

double blotch_share(const Vec3& q, double mix) {
  if (mix == 1) return 0;
  const double value = noise3(q);
  return value > mix ? (value - mix) / (1 - mix) : 0;
}

double fbm_value(const Vec3& q, const FbmParameters& parameters, double offset, double scale,
                 double threshold) {
  const double value = parameters.at(q);
  return value < threshold ? offset : offset + scale * (value - threshold);
}

Color wood_color(const Vec3& q) {
  const double c = chaos(q, 7);
  const double t = std::fabs(fn::sin(fn::sin(8 * c + 7 * q.x + 3 * q.y)));
  const double e = std::fabs(fn::sin(40 * c + 50 * q.z));
  const double brown_shade = 0.6 * e + 0.3;
  const double green_shade = 0.2 * e + 0.8;
  const double grain_shade = 0.15 * e + 0.85;
  double powers[2] = {t, 0.5 * (t + 1)};
  constexpr double kExponents[2] = {0.3, 0.6};
  fn::pow_each(powers, kExponents, powers, 2);
  const double base = 0.5 * powers[0];
  const double power = powers[1];
  const double brown = power * brown_shade;
  const double green = power * green_shade;
  return {(0.5 * brown + 0.35 * green) * 2 * base, base * (brown > green ? brown : green) * grain_shade,
          (0.25 * brown + 0.35 * green) * 2 * base};
}

Vec3 gloss_normal(const Vec3& n, double glossiness, const std::array<double, 2>& draws, int sample_number,
                  int samples_per_side) {
  const double k = 1 - glossiness;
  Vec3 u, w;
  coordinate_system(n, u, w);
  double x = 2 * draws[0] - 1, y = 2 * draws[1] - 1;
  if (sample_number >= 0 && samples_per_side > 0) {
    const double step = 2.0 / samples_per_side;
    const int column = sample_number % samples_per_side, row = sample_number / samples_per_side;
    x = draws[0] * step - 1 + column * step;
    y = draws[1] * step - 1 + row * step;
  }
  return normalize_above_epsilon(n + (k * x) * u + (k * y) * w);
}

double sky_intensity(const Vec3& q, const FbmParameters& parameters, double exponent, double opaque_threshold,
                     double transparent_threshold) {
  const double limit = 1 / (1 - parameters.omega);
  // omega 1 has no limit: the normalised sum tends to one half.
  double intensity = std::isfinite(limit) ? (limit + parameters.at(q)) * 0.5 / limit : 0.5;
  if (opaque_threshold == transparent_threshold) {
    intensity = intensity > transparent_threshold ? 1 : 0;
  } else {
    intensity = clamp01((intensity - transparent_threshold) / (opaque_threshold - transparent_threshold));
  }
  // Most of a sky is clear or covered: 1 to any power is 1, and 0 to a positive one 0.
  const bool unchanged = exponent == 0 || intensity == 1 || (intensity == 0 && exponent > 0);
  return unchanged ? intensity : fn::pow_by_log(intensity, exponent);
}

CloudValue cloud_value(const Vec3& q, const Vec3& origin, const Vec3& direction, const CloudParameters& p) {
  const double square = dot(origin, origin);
  if (square < 1 + kEpsilon) return {};
  const double beta = 1 + 2 * p.h;
  const double limit = 1 / (1 - beta);
  const double intensity = std::isfinite(limit) ? clamp01((limit + p.fbm.at(q)) * 0.5 / limit) : 0.5;
  const double distance = std::sqrt(square);
  const double b = std::sqrt(square - 1) / distance;
  const double a = -dot(origin, direction) / distance;
  const double limb = (a - b) / (1 - b);
  const double opacity = intensity - p.threshold - (p.limb_threshold - p.threshold) * (1 - limb);
  const double transparency =
      p.transparency_scale == 0 ? (opacity > 0 ? 0.0 : 1.0) : clamp01(1 - opacity / p.transparency_scale);
  return {transparency, (1 - transparency) * (1 - p.scale + p.scale * intensity), 1 - transparency};
}

StripeValue stripe_value(double u, double v, double width, double bump) {
  u = fraction(u);
  v = fraction(v);
  if (u > 2 * width && v > 2 * width && u <= 1 - width && v <= 1 - width) return {};
  if (u < width || v < width) return {StripePart::kBand, 0, 0};
  u = (u - width) / (1 - width);
  v = (v - width) / (1 - width);
  if (v < u) {
    if (v < 1 - u) return {StripePart::kBevel, 0, -bump};
    return {StripePart::kBevel, bump, 0};
  }
  if (v < 1 - u) return {StripePart::kBevel, -bump, 0};
  return {StripePart::kBevel, 0, bump};
}

int mount_index(const Vec3& q, double turbulence, double slope, double normal_z) {
  return truncated_index((q.z + turbulence * chaos(q, 7) - slope * (1 - normal_z)) * 256, 255);
}

int color_index(double value) { return truncated_index(255 * value, 255); }

}  // namespace rayshade
