// SPDX-License-Identifier: MIT
// Conversion of colours to codes against the formulas of shading.md 8.1 and 8.3.
#include "rayshade/image/encode.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "rayshade/math/functions.h"

namespace rayshade {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

ColorEncoder with_gamma(double gamma) { return ColorEncoder({gamma, false}); }

TEST(Encode, TruncatesAndLimits) {
  EXPECT_EQ(to_byte(0), 0);
  EXPECT_EQ(to_byte(-0.1), 0);
  EXPECT_EQ(to_byte(-kInf), 0);
  EXPECT_EQ(to_byte(kNan), 0);
  EXPECT_EQ(to_byte(0.25), 63);
  EXPECT_EQ(to_byte(0.5), 127);
  EXPECT_EQ(to_byte(std::nextafter(1, 0)), 254);
  EXPECT_EQ(to_byte(1), 255);
  EXPECT_EQ(to_byte(1.5), 255);
  EXPECT_EQ(to_byte(kInf), 255);
  EXPECT_EQ(to_word(0.25), 16383);
  EXPECT_EQ(to_word(std::nextafter(1, 0)), 65534);
  EXPECT_EQ(to_word(1), 65535);
  EXPECT_EQ(to_word(kNan), 0);
  for (int k = 0; k <= 255; ++k) {
    EXPECT_EQ(to_byte((k + 0.5) / 255), k);
    EXPECT_EQ(to_byte(std::nextafter((k + 1) / 255.0 - 1e-15, 0)), k);
  }
}

TEST(Encode, ValuesMeasuredFromTheOriginal) {
  // language.md 11: an 8 x 8 picture without gamma and with -G 2.
  EXPECT_EQ(ColorEncoder().byte(0.25), 63);
  EXPECT_EQ(ColorEncoder().byte(1.5), 255);
  const ColorEncoder two = with_gamma(2);
  EXPECT_EQ(two.byte(0.25), 127);
  EXPECT_EQ(two.byte(0.5), 180);
  EXPECT_EQ(two.byte(1.5), 255);
  EXPECT_EQ(two.byte(0.1), 80);
  EXPECT_EQ(two.byte(0.2), 114);
  EXPECT_EQ(two.byte(0.3), 139);
  // shading.md 8.1: a negative value to an even power is positive, to a fractional one not a number.
  EXPECT_EQ(with_gamma(0.5).byte(-0.25), 15);
  EXPECT_EQ(two.byte(-0.25), 0);
}

TEST(Encode, GammaNearZeroIsAStep) {
  EXPECT_EQ(gamma_exponent(0), 1e14);
  EXPECT_EQ(gamma_exponent(-1e-5), 1e14);
  EXPECT_EQ(gamma_exponent(2e-5), 1 / 2e-5);
  const ColorEncoder step = with_gamma(0);
  EXPECT_EQ(step.byte(0.999), 0);
  EXPECT_EQ(step.byte(1), 255);
  EXPECT_EQ(step.byte(1.001), 255);
  // A negative gamma inverts: the original has no check.
  EXPECT_EQ(with_gamma(-1).byte(4), 63);
  EXPECT_EQ(with_gamma(-1).byte(0), 255);
}

class EncodeTable : public testing::TestWithParam<ColorEncoding> {};

// The table must be invisible: every code equals the formula's, at the thresholds most of all.
TEST_P(EncodeTable, AgreesWithTheFormula) {
  const ColorEncoder encoder(GetParam());
  const auto check = [&](double v) {
    ASSERT_EQ(encoder.byte(v), to_byte(encoder.value(v))) << std::hexfloat << v;
  };
  for (const double v : {0.0, -0.0, 1.0, 2.0, 1e300, 5e-324, -0.5, kNan, kInf, -kInf}) check(v);
  for (int k = 1; k <= 255; ++k) {
    // Bisect for the first value whose code by the formula is k.
    double below = 0, above = 2;
    while (std::nextafter(below, 2) < above) {
      const double middle = below + (above - below) / 2;
      (to_byte(encoder.value(middle)) < k ? below : above) = middle;
    }
    double up = above, down = above;
    for (int i = 0; i < 200; ++i) {
      check(up);
      check(down);
      up = std::nextafter(up, 2);
      down = std::nextafter(down, 0);
    }
    for (const double relative : {1e-13, 9e-13, 1.1e-12, 1e-11, 1e-9}) {
      check(above * (1 + relative));
      check(above * (1 - relative));
    }
  }
  constexpr unsigned kSeed = 20260101;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> any(-0.1, 1.2);
  for (int i = 0; i < 100000; ++i) check(any(random));
  for (int i = 0; i < 4096; ++i) check(i / 4096.0);
}

INSTANTIATE_TEST_SUITE_P(Encodings, EncodeTable,
                         testing::Values(ColorEncoding{1, false}, ColorEncoding{0.25, false},
                                         ColorEncoding{0.45, false}, ColorEncoding{1.8, false},
                                         ColorEncoding{2, false}, ColorEncoding{2.2, false},
                                         ColorEncoding{4, false}, ColorEncoding{7, false},
                                         ColorEncoding{1, true}));

TEST(Encode, SrgbFollowsTheStandard) {
  const ColorEncoder srgb({1, true});
  EXPECT_DOUBLE_EQ(srgb.value(0.001), 0.01292);
  EXPECT_DOUBLE_EQ(srgb.value(1), 1);
  EXPECT_NEAR(srgb.value(0.5), 0.7353569830524495, 1e-15);
  EXPECT_NEAR(srgb.value(0.214041140482232), 0.5, 1e-12);
  EXPECT_NEAR(srgb.value(0.0031308), srgb.value(0.00313081), 1e-6);  // the two pieces meet
  EXPECT_EQ(srgb.byte(-0.5), 0);
}

TEST(Encode, ArraysEqualSingleValuesAndLeaveAlphaAlone) {
  for (const ColorEncoding encoding :
       {ColorEncoding{1, false}, ColorEncoding{2.2, false}, ColorEncoding{1, true}}) {
    const ColorEncoder encoder(encoding);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(-0.2, 1.3);
    std::vector<double> rgba(4 * 999);
    for (double& v : rgba) v = any(random);
    rgba[5] = kNan;
    rgba[7] = kNan;
    std::vector<std::uint8_t> bytes(rgba.size());
    std::vector<std::uint16_t> words(rgba.size());
    encoder.bytes(rgba.data(), rgba.size() / 4, bytes.data());
    encoder.words(rgba.data(), rgba.size() / 4, words.data());
    for (std::size_t i = 0; i < rgba.size(); ++i) {
      EXPECT_EQ(bytes[i], i % 4 == 3 ? to_byte(rgba[i]) : encoder.byte(rgba[i]));
      EXPECT_EQ(words[i], i % 4 == 3 ? to_word(rgba[i]) : encoder.word(rgba[i]));
    }
  }
}

TEST(Encode, ExponentialBytes) {
  using Bytes = std::array<std::uint8_t, 4>;
  // 1 = 0.5 * 2^1; 0.5 = 0.5 * 2^0.
  EXPECT_EQ(to_exponential(1, 0.5, 0.25), (Bytes{128, 64, 32, 128}));
  EXPECT_EQ(to_exponential(0.5, 0.5, 0.5), (Bytes{128, 128, 128, 127}));
  EXPECT_EQ(to_exponential(0.999, 0.1, 0.2), (Bytes{255, 25, 51, 127}));
  EXPECT_EQ(to_exponential(100, 50, 1), (Bytes{200, 100, 2, 134}));
  // Three small values keep their precision; a zero among them counts as exponent 0.
  EXPECT_EQ(to_exponential(0.125, 0.0625, 0.125), (Bytes{128, 64, 128, 125}));
  EXPECT_EQ(to_exponential(0.125, 0, 0.125), (Bytes{32, 0, 32, 127}));
  EXPECT_EQ(to_exponential(0, 0, 0), (Bytes{0, 0, 0, 127}));
  // The exponent is limited to -127 .. 128.
  EXPECT_EQ(to_exponential(0x1p-140, 0x1p-140, 0x1p-140), (Bytes{0, 0, 0, 0}));
  EXPECT_EQ(to_exponential(0x1p-128, 0x1p-128, 0x1p-128), (Bytes{128, 128, 128, 0}));
  EXPECT_EQ(to_exponential(0x1p127, 0x1p126, 0x1p120), (Bytes{128, 64, 1, 255}));
  EXPECT_EQ(to_exponential(kInf, 1e300, 0x1p127), (Bytes{255, 255, 128, 255}));
  EXPECT_EQ(to_exponential(kNan, -1, 0.5), (Bytes{0, 0, 128, 127}));
  // Gamma comes first.
  EXPECT_EQ(with_gamma(2).exponential(0.25, 4, 1), to_exponential(0.5, 2, 1));
}

TEST(Encode, ExponentialKeepsEightBitsOfTheLargest) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> magnitude(-30, 30), part(0.001, 1);
  for (int i = 0; i < 10000; ++i) {
    const double scale = std::ldexp(1.0, static_cast<int>(magnitude(random)));
    const double v[3] = {scale * part(random), scale * part(random), scale * part(random)};
    const auto bytes = to_exponential(v[0], v[1], v[2]);
    const double largest = std::max({v[0], v[1], v[2]});
    EXPECT_GE(std::max({bytes[0], bytes[1], bytes[2]}), 128);
    for (std::size_t c = 0; c < 3; ++c) {
      const double back = std::ldexp(bytes[c], bytes[3] - 127 - 8);
      EXPECT_LE(back, v[c]);
      EXPECT_LT(v[c] - back, largest / 128);
    }
  }
}

}  // namespace
}  // namespace rayshade
