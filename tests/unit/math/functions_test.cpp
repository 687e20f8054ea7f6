// SPDX-License-Identifier: MIT
// The functions that pixels see: close to the truth (long double on x86-64 has 11 more bits), and the same
// bits wherever they run. The bits are pinned by a hash over many arguments.
#include "rayshade/math/functions.h"

#include <gtest/gtest.h>
#include <sleef.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <random>
#include <vector>

namespace rayshade {
namespace {

/// Distance of `value` from `truth` in units of the last place of a double near the truth.
double ulps(double value, long double truth) {
  const double nearest = static_cast<double>(truth);
  const double unit =
      std::nextafter(std::fabs(nearest), std::numeric_limits<double>::infinity()) - std::fabs(nearest);
  return static_cast<double>(
      std::fabs((static_cast<long double>(value) - truth) / static_cast<long double>(unit)));
}

TEST(FunctionsTest, ErrorIsAtMostOneUlp) {
  static_assert(std::numeric_limits<long double>::digits >= 64);
  std::mt19937_64 random(42);
  const auto between = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  double worst[12] = {};
  const auto note = [&](int function, double value, long double truth) {
    worst[function] = std::max(worst[function], ulps(value, truth));
  };
  for (int i = 0; i < 20000; ++i) {
    const double x = between(-100, 100), y = between(-100, 100), unit = between(-1, 1),
                 positive = between(1e-10, 1e3);
    const long double lx = x, ly = y, lu = unit, lp = positive;
    note(0, fn::sin(x), std::sin(lx));
    note(1, fn::cos(x), std::cos(lx));
    note(2, fn::tan(x), std::tan(lx));
    note(3, fn::asin(unit), std::asin(lu));
    note(4, fn::acos(unit), std::acos(lu));
    note(5, fn::atan(x), std::atan(lx));
    note(6, fn::atan2(y, x), std::atan2(ly, lx));
    note(7, fn::exp(x), std::exp(lx));
    note(8, fn::log(positive), std::log(lp));
    note(9, fn::pow(positive, unit * 10), std::pow(lp, static_cast<long double>(unit * 10)));
    note(10, fn::hypot(x, y), std::hypot(lx, ly));
    note(11, fn::cbrt(x), std::cbrt(lx));
  }
  for (int f = 0; f < 12; ++f) EXPECT_LE(worst[f], 1.001) << "function " << f;
}

TEST(FunctionsTest, SpecialValues) {
  EXPECT_EQ(fn::pow(0, 0), 1);
  EXPECT_EQ(fn::pow(2, 10), 1024);
  EXPECT_EQ(fn::pow(-2, 3), -8);
  EXPECT_TRUE(std::isnan(fn::pow(-2, 0.5)));
  EXPECT_EQ(fn::exp(0), 1);
  EXPECT_EQ(fn::log(1), 0);
  EXPECT_EQ(fn::hypot(3, 4), 5);
  EXPECT_EQ(fn::sin(0), 0);
  EXPECT_EQ(fn::cos(0), 1);
  EXPECT_TRUE(std::isnan(fn::acos(1.5)));
  EXPECT_TRUE(std::isnan(fn::log(-1)));
}

TEST(FunctionsTest, BitsAreTheSameEverywhere) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto note = [&](double value) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3u;
  };
  for (int i = 1; i <= 4000; ++i) {
    const double x = i * 0.0371, unit = i / 4001.0;
    for (const double value :
         {fn::sin(x), fn::cos(x), fn::tan(x), fn::asin(unit), fn::acos(unit), fn::atan(x), fn::atan2(x, unit),
          fn::exp(-x), fn::log(x), fn::pow(unit, x), fn::hypot(x, unit), fn::cbrt(x)}) {
      note(value);
    }
  }
  EXPECT_EQ(hash, 0x46619d31709f0dbbu);
}

TEST(FunctionsTest, PowersByLogarithmsKeepTheirBound) {
  std::mt19937_64 random(43);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 100'000; ++i) {
    const double x = i % 2 ? unit(random) : 1 - 1e-4 * unit(random),
                 y = i % 3 ? 2 * unit(random) : 300 * unit(random);
    const long double truth = std::pow(static_cast<long double>(x), static_cast<long double>(y));
    if (truth < 1e-300L) continue;
    const long double error = std::fabs(static_cast<long double>(fn::pow_by_log(x, y)) / truth - 1);
    const auto bound = static_cast<long double>((3 + 2 * std::fabs(y * std::log(x))) * 0x1p-53);
    ASSERT_LE(error, bound) << x << " to the " << y;
  }
  EXPECT_EQ(fn::pow_by_log(0, 0), 1);
  EXPECT_EQ(fn::pow_by_log(0, 0.77), 0);
  EXPECT_EQ(fn::pow_by_log(1, 7.5), 1);
  EXPECT_TRUE(std::isinf(fn::pow_by_log(0, -2)));
}

// Whatever the width of the processor's vectors: the bits of one power.
TEST(FunctionsTest, PowersTogetherAreThoseOneByOne) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kSpecial[] = {0,   -0.0, 1,    -1,     2,          -2,          .5,
                                 3,   -3,   0.3,  0x1p60, 0x1p-1074,  1e308,       kInfinity,
                                 4.8, -0.5, 1e16, 1e-9,   -kInfinity, std::nan("")};
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  std::uniform_int_distribution<std::size_t> pick(0, std::size(kSpecial) - 1);
  for (std::size_t round = 0; round < 20'000; ++round) {
    const std::size_t count = round % 37;
    std::vector<double> x(count), y(count), out(count, -7);
    for (std::size_t i = 0; i < count; ++i) {
      x[i] = round % 3 == 0 ? kSpecial[pick(random)] : unit(random);
      y[i] = round % 3 == 1 ? 50 * unit(random) : kSpecial[pick(random)];
    }
    fn::pow_each(x.data(), y.data(), out.data(), count);
    for (std::size_t i = 0; i < count; ++i) {
      const double one = fn::pow(x[i], y[i]), scalar = Sleef_cinz_powd1_u10purec(x[i], y[i]);
      if (std::isnan(scalar)) {
        ASSERT_TRUE(std::isnan(one) && std::isnan(out[i])) << x[i] << " to the " << y[i];
        continue;
      }
      ASSERT_EQ(std::bit_cast<std::uint64_t>(out[i]), std::bit_cast<std::uint64_t>(scalar))
          << x[i] << " to the " << y[i] << ", " << i << " of " << count;
      ASSERT_EQ(std::bit_cast<std::uint64_t>(one), std::bit_cast<std::uint64_t>(scalar));
    }
  }
}

}  // namespace
}  // namespace rayshade
