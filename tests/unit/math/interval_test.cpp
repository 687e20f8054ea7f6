// SPDX-License-Identifier: MIT
// Interval operations must contain every computed value of their operands' members, and must not be wider
// than needed where the headers promise tight bounds.
#include "rayshade/math/interval.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "rayshade/math/functions.h"

namespace rayshade {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

/// Numbers of many sizes, with the special places of the functions among them.
class Numbers {
 public:
  explicit Numbers(unsigned seed) : random_(seed) {}

  double next() {
    static constexpr double kSpecial[] = {0.0, -0.0,    1,        -1,          2,      -2,
                                          0.5, fn::kPi, -fn::kPi, fn::kPi / 2, 1e-300, 1e300};
    const auto kind = random_() % 8;
    if (kind == 0) return kSpecial[random_() % std::size(kSpecial)];
    if (kind == 1) return std::round(uniform(-10, 10));
    if (kind == 2) return std::ldexp(uniform(-1, 1), static_cast<int>(random_() % 200) - 100);
    if (kind == 3) return uniform(-1, 1);
    return uniform(-20, 20);
  }

  Interval interval() {
    double a = next(), b = random_() % 4 == 0 ? a + uniform(0, 1) * std::fabs(a) * 1e-3 : next();
    if (random_() % 16 == 0) b = a;
    if (a > b) std::swap(a, b);
    return {a, b};
  }

  double member(const Interval& a) {
    const auto kind = random_() % 6;
    if (kind == 0) return a.lo;
    if (kind == 1) return a.hi;
    const double v = a.lo + uniform(0, 1) * (a.hi - a.lo);
    return std::min(std::max(v, a.lo), a.hi);
  }

  double uniform(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random_); }

 private:
  std::mt19937 random_;
};

double remainder_of(double a, double b) {
  return std::trunc(b) == 0 ? std::nan("") : std::fmod(std::trunc(a), std::trunc(b));
}

struct Binary {
  const char* name;
  std::function<Interval(const Interval&, const Interval&)> range;
  std::function<double(double, double)> value;
};

TEST(IntervalTest, BinaryOperationsContainTheirValues) {
  const Binary operations[] = {
      {"+", [](auto& a, auto& b) { return a + b; }, [](double a, double b) { return a + b; }},
      {"-", [](auto& a, auto& b) { return a - b; }, [](double a, double b) { return a - b; }},
      {"*", [](auto& a, auto& b) { return a * b; }, [](double a, double b) { return a * b; }},
      {"/", [](auto& a, auto& b) { return a / b; }, [](double a, double b) { return a / b; }},
      {"hypot", [](auto& a, auto& b) { return hypot(a, b); },
       [](double a, double b) { return fn::hypot(a, b); }},
      {"pow", [](auto& a, auto& b) { return pow(a, b); }, [](double a, double b) { return fn::pow(a, b); }},
      {"%", [](auto& a, auto& b) { return integer_remainder(a, b); }, remainder_of},
  };
  const unsigned seed = 20240611;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Numbers numbers(seed);
  for (const Binary& op : operations) {
    for (int i = 0; i < 6000; ++i) {
      const Interval a = numbers.interval(), b = numbers.interval();
      const Interval range = op.range(a, b);
      ASSERT_LE(range.lo, range.hi);
      for (int j = 0; j < 12; ++j) {
        const double x = numbers.member(a), y = numbers.member(b), value = op.value(x, y);
        if (std::isnan(value)) continue;
        ASSERT_TRUE(range.contains(value)) << op.name << " of " << x << " and " << y << " is " << value
                                           << ", not in [" << range.lo << ", " << range.hi << "]";
      }
    }
  }
}

TEST(IntervalTest, FunctionsContainTheirValues) {
  struct Unary {
    const char* name;
    Interval (*range)(const Interval&);
    double (*value)(double);
  };
  const Unary functions[] = {
      {"sin", sin, fn::sin},
      {"cos", cos, fn::cos},
      {"tan", tan, fn::tan},
      {"asin", asin, fn::asin},
      {"acos", acos, fn::acos},
      {"atan", atan, fn::atan},
      {"sqrt", sqrt, [](double x) { return std::sqrt(x); }},
  };
  const unsigned seed = 20240612;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Numbers numbers(seed);
  for (const Unary& f : functions) {
    for (int i = 0; i < 20000; ++i) {
      const Interval a = numbers.interval();
      const Interval range = f.range(a);
      ASSERT_LE(range.lo, range.hi);
      for (int j = 0; j < 8; ++j) {
        const double x = numbers.member(a), value = f.value(x);
        if (std::isnan(value)) continue;
        ASSERT_TRUE(range.contains(value)) << f.name << " of " << x << " is " << value;
      }
    }
  }
}

TEST(IntervalTest, ExtremesInsideAnIntervalAreFound) {
  // Narrow intervals around each extreme: the ends alone would miss it.
  for (int k = -50; k <= 50; ++k) {
    const double maximum = fn::kPi / 2 + 2 * fn::kPi * k;
    EXPECT_GE(sin(Interval{maximum - 1e-3, maximum + 1e-3}).hi, 1);
    EXPECT_LE(sin(Interval{maximum + fn::kPi - 1e-3, maximum + fn::kPi + 1e-3}).lo, -1);
    EXPECT_GE(cos(Interval{maximum - fn::kPi / 2 - 1e-3, maximum - fn::kPi / 2 + 1e-3}).hi, 1);
    EXPECT_EQ(tan(Interval{maximum - 1e-3, maximum + 1e-3}).hi, kInf);
  }
}

TEST(IntervalTest, CommonRangesAreTight) {
  const auto expect_near = [](const Interval& a, double lo, double hi) {
    EXPECT_NEAR(a.lo, lo, 1e-14);
    EXPECT_NEAR(a.hi, hi, 1e-14);
  };
  expect_near(sin(Interval{0.25, 0.5}), fn::sin(0.25), fn::sin(0.5));
  expect_near(cos(Interval{0.25, 0.5}), fn::cos(0.5), fn::cos(0.25));
  expect_near(sin(Interval{0, fn::kPi}), 0, 1);
  expect_near(Interval{-2, 3} * Interval{-5, 4}, -15, 12);
  expect_near(Interval{1, 2} / Interval{4, 5}, 0.2, 0.5);
  expect_near(pow(Interval{-2, 1}, Interval::point(2)), 0, 4);
  expect_near(pow(Interval{-2, 1}, Interval::point(3)), -8, 1);
  expect_near(pow(Interval{1, 4}, Interval::point(-1)), 0.25, 1);
  expect_near(pow(Interval{1, 4}, Interval{0.5, 1}), 1, 4);
  expect_near(hypot(Interval{-3, 1}, Interval{-4, 2}), 0, 5);
  expect_near(sqrt(Interval{-1, 4}), 0, 2);  // the root of a negative number is no value
  expect_near(asin(Interval{-3, 0}), -fn::kPi / 2, 0);
  expect_near(integer_remainder({13.5, 17.2}, Interval::point(10)), 3, 7);
  expect_near(integer_remainder({8, 13}, Interval::point(10)), 0, 9);
  expect_near(integer_remainder({-7, -7}, Interval::point(3)), -1, -1);
}

TEST(IntervalTest, ZeroAndOneAreExactFactors) {
  const Interval a{-0.1, 0.3};
  EXPECT_EQ((Interval::point(0) * a).lo, 0);
  EXPECT_EQ((Interval::point(0) * Interval::everything()).hi, 0);
  EXPECT_EQ((Interval::point(1) * a).lo, a.lo);
  EXPECT_EQ((a * Interval::point(1)).hi, a.hi);
}

TEST(IntervalTest, UnknownRangesAreEverything) {
  for (const Interval& a :
       {Interval{1, 2} / Interval{-1, 1}, Interval{1, 2} / Interval{0, 1}, tan(Interval{1, 2}),
        pow(Interval{-1, 1}, Interval::point(-1)), pow(Interval{-1, 1}, Interval{0.5, 0.6}),
        tan(Interval::everything()), sqrt(Interval{-2, -1}), acos(Interval{2, 3})}) {
    EXPECT_EQ(a.lo, -kInf);
    EXPECT_EQ(a.hi, kInf);
  }
}

TEST(IntervalTest, HugeArgumentsOfPeriodicFunctionsStayBounded) {
  for (const Interval& a :
       {sin(Interval{1e15, 1e15 + 1}), cos(Interval::everything()), sin(Interval{-kInf, 0})}) {
    EXPECT_LE(a.hi, 1.0000001);
    EXPECT_GE(a.hi, 1);
    EXPECT_LE(a.lo, -1);
  }
}

}  // namespace
}  // namespace rayshade
