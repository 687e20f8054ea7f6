// SPDX-License-Identifier: MIT
#include "rayshade/image/encode.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rayshade/math/clones.h"
#include "rayshade/math/functions.h"
#include "rayshade/math/vec.h"

namespace rayshade {
namespace {

// IEC 61966-2-1, with its printed constants.
double to_srgb(double linear) {
  if (!(linear > 0.0031308)) return 12.92 * linear;
  const double stored = 1.055 * fn::pow(linear, 1 / 2.4) - 0.055;
  return linear >= 1 ? std::max(stored, 1.0) : stored;  // 1.055 - 0.055 is a little less than 1
}

double from_srgb(double stored) {
  if (stored <= 0.04045) return stored / 12.92;
  return fn::pow((stored + 0.055) / 1.055, 2.4);
}

// Between the limits truncation is the conversion to int; not-a-number fails both comparisons.
template <int kMax>
int to_code(double v) {
  const double limited = v > 0 ? (v < 1 ? v : 1.0) : 0.0;
  return static_cast<int>(kMax * limited);
}

RAYSHADE_CLONES("avx2")
void linear_bytes(const double* values, std::size_t count, std::uint8_t* __restrict out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = static_cast<std::uint8_t>(to_code<255>(values[i]));
}

// Both directions of the transfer function are good to some units in the last place of a double, about 1e-15
// of the value, times the logarithm of the value and the gamma, at most 25 or so. Outside this margin around
// a threshold the formula cannot give another code than the table.
constexpr double kMargin = 1e-12;

}  // namespace

double gamma_exponent(double gamma) { return std::fabs(gamma) <= kEpsilon ? kFar : 1 / gamma; }

std::uint8_t to_byte(double v) { return static_cast<std::uint8_t>(to_code<255>(v)); }

std::uint16_t to_word(double v) { return static_cast<std::uint16_t>(to_code<65535>(v)); }

std::array<std::uint8_t, 4> to_exponential(double r, double g, double b) {
  double values[3] = {r, g, b};
  int exponent = std::numeric_limits<int>::min();
  for (double& v : values) {
    v = v > 0 ? std::min(v, 0x1p200) : 0.0;
    int own = 0;  // a zero counts as exponent 0
    if (v > 0) std::frexp(v, &own);
    exponent = std::max(exponent, own);
  }
  exponent = std::clamp(exponent, -127, 128);
  std::array<std::uint8_t, 4> out{};
  for (int i = 0; i < 3; ++i)
    out[i] = static_cast<std::uint8_t>(std::min(255.0, std::trunc(std::ldexp(values[i], 8 - exponent))));
  out[3] = static_cast<std::uint8_t>(exponent + 127);
  return out;
}

ColorEncoder::ColorEncoder(const ColorEncoding& encoding) : encoding_(encoding) {
  if (!encoding.srgb) {
    exponent_ = gamma_exponent(encoding.gamma);
    identity_ = exponent_ == 1;
  } else {
    identity_ = false;
  }
  tabled_ = encoding.srgb || (!identity_ && encoding.gamma >= 0.25 && encoding.gamma <= 4);
  if (!tabled_) return;
  certain_from_[0] = 0;
  for (int k = 1; k <= 255; ++k) {
    const double threshold = encoding.srgb ? from_srgb(k / 255.0) : fn::pow(k / 255.0, encoding.gamma);
    certain_from_[k] = threshold * (1 + kMargin);
    certain_to_[k - 1] = threshold * (1 - kMargin);
  }
  certain_to_[255] = std::numeric_limits<double>::infinity();
  certain_from_[256] = std::numeric_limits<double>::infinity();
  int code = 0;
  for (int bucket = 0; bucket <= kBuckets; ++bucket) {
    while (certain_from_[code + 1] <= bucket / double{kBuckets}) ++code;
    first_[bucket] = static_cast<std::uint8_t>(code);
  }
}

double ColorEncoder::value(double linear) const {
  if (identity_) return linear;
  return encoding_.srgb ? to_srgb(linear) : fn::pow(linear, exponent_);
}

std::uint8_t ColorEncoder::byte(double linear) const {
  if (identity_) return to_byte(linear);
  if (!tabled_ || !(linear >= 0)) return to_byte(value(linear));
  return table_byte(linear);
}

std::uint8_t ColorEncoder::table_byte(double linear) const {
  if (linear >= 1) {
    // Exactly 1 stays 1 under any power.
    if (linear == 1 || linear >= certain_from_[255]) return 255;
    return to_byte(value(linear));
  }
  const int bucket = static_cast<int>(linear * kBuckets);
  // A bucket holds one threshold or none, but for the darkest ones.
  std::size_t code = first_[bucket];
  while (linear >= certain_from_[code + 1]) ++code;
  if (linear <= certain_to_[code]) return static_cast<std::uint8_t>(code);
  return to_byte(value(linear));
}

void ColorEncoder::bytes(const double* rgba, std::size_t count, std::uint8_t* out) const {
  if (identity_) {
    linear_bytes(rgba, 4 * count, out);
    return;
  }
  for (std::size_t i = 0; i < count; ++i, rgba += 4, out += 4) {
    for (int c = 0; c < 3; ++c) out[c] = byte(rgba[c]);
    out[3] = to_byte(rgba[3]);
  }
}

void ColorEncoder::words(const double* rgba, std::size_t count, std::uint16_t* out) const {
  for (std::size_t i = 0; i < count; ++i, rgba += 4, out += 4) {
    for (int c = 0; c < 3; ++c) out[c] = word(rgba[c]);
    out[3] = to_word(rgba[3]);
  }
}

}  // namespace rayshade
