// SPDX-License-Identifier: MIT
// From linear colours to the numbers that picture files hold (shading.md 8.1 and 8.3).
//
// The conversion is the original's: no rounding but truncation, so that only 1 or more gives the largest
// code, and not-a-number gives 0. It is applied once, to the filtered pixel; alpha never passes through the
// transfer function.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace rayshade {

/// The transfer function between linear colours and stored ones. The default stores colours as they are.
struct ColorEncoding {
  double gamma = 1;   ///< display gamma (-G): stored = linear ^ (1 / gamma)
  bool srgb = false;  ///< the sRGB transfer function; `gamma` is then ignored

  bool operator==(const ColorEncoding&) const = default;
};

/// The power that colours are raised to: 1 / gamma, or 1e14 where |gamma| <= 1e-5.
double gamma_exponent(double gamma);

/// trunc(255 v); 0 for v below 0 and for not-a-number, 255 for v above 1. No transfer function.
std::uint8_t to_byte(double v);

/// trunc(65535 v), with the limits of to_byte.
std::uint16_t to_word(double v);

/// The four bytes of the Utah toolkit's exponential format for three (unclamped) values: r, g, b mantissas
/// and the exponent + 127. Negative values and not-a-number become 0; infinite ones the largest the format
/// holds.
std::array<std::uint8_t, 4> to_exponential(double r, double g, double b);

/// Applies one ColorEncoding to many colours. Bytes are found by table wherever the table provably agrees
/// with the formula, so that a gamma costs no power function per pixel. Immutable: may be shared by threads.
class ColorEncoder {
 public:
  explicit ColorEncoder(const ColorEncoding& encoding = {});

  const ColorEncoding& encoding() const { return encoding_; }

  /// The stored value of a linear one, before it is turned into an integer. Not-a-number for a negative base
  /// with a fractional power.
  double value(double linear) const;
  std::uint8_t byte(double linear) const;
  std::uint16_t word(double linear) const { return to_word(value(linear)); }
  std::array<std::uint8_t, 4> exponential(double r, double g, double b) const {
    return to_exponential(value(r), value(g), value(b));
  }

  /// `count` pixels of linear red, green, blue, alpha become `count` times four bytes.
  void bytes(const double* rgba, std::size_t count, std::uint8_t* out) const;
  /// ... times four 16-bit words.
  void words(const double* rgba, std::size_t count, std::uint16_t* out) const;

 private:
  std::uint8_t table_byte(double linear) const;

  ColorEncoding encoding_;
  double exponent_ = 1;
  bool identity_ = true;
  bool tabled_ = false;
  // A value from certain_from_[k] to certain_to_[k] has code k; the narrow gaps between are left to the
  // formula.
  static constexpr int kBuckets = 4096;
  std::array<double, 257> certain_from_{}, certain_to_{};
  std::array<std::uint8_t, kBuckets + 1> first_{};  // the code at the lower end of each bucket of values
};

}  // namespace rayshade
