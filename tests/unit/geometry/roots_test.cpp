// SPDX-License-Identifier: MIT
// Root finding: brackets, stationary points of quartics, sign changes of quartics in Bernstein form.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "rayshade/geometry/roots/quartic.h"
#include "tests/unit/geometry/quad_reference.h"

namespace rayshade::roots {
namespace {

using reference::Quad;
using reference::Random;

std::vector<double> changes(const BernsteinQuartic& q) {
  std::vector<double> out;
  sign_changes(q, [&](double x) {
    out.push_back(x);
    return false;
  });
  return out;
}

/// The product of (x - zeros[i]) and `factor` over [0, 1].
BernsteinQuartic from_zeros(const std::vector<double>& zeros, double factor) {
  std::vector<Quad> power{factor};  // coefficients of x^0, x^1, ...
  for (const double zero : zeros) {
    power.push_back(0);
    for (std::size_t i = power.size(); i-- > 0;)
      power[i] = (i > 0 ? power[i - 1] : Quad(0)) - zero * power[i];
  }
  power.resize(5);
  static constexpr int kChoose[5][5] = {{1}, {1, 1}, {1, 2, 1}, {1, 3, 3, 1}, {1, 4, 6, 4, 1}};
  BernsteinQuartic out{};
  for (int i = 0; i < 5; ++i) {
    Quad sum = 0;
    for (int j = 0; j <= i; ++j) sum += power[j] * kChoose[i][j] / kChoose[4][j];
    out.b[i] = static_cast<double>(sum);
  }
  return out;
}

TEST(Bracket, FindsTheZeroToTheLastPlaces) {
  const auto square = [](double x) { return ValueAndSlope{x * x - 2, 2 * x}; };
  EXPECT_NEAR(bracketed_root(square, 0, 2, false, 1.9, 1e-16), std::sqrt(2.0), 3e-16);
  EXPECT_NEAR(bracketed_root(square, 0, 2, false, 77, 1e-16), std::sqrt(2.0), 3e-16) << "a guess outside";
  EXPECT_NEAR(bracketed_root(square, 0, 2, false, 1e-9, 1e-16), std::sqrt(2.0), 3e-16)
      << "a step far outside";
}

TEST(Bracket, SurvivesFlatAndJumpingFunctions) {
  const auto cubic = [](double x) { return ValueAndSlope{x * x * x, 3 * x * x}; };
  EXPECT_NEAR(bracketed_root(cubic, -1, 3, false, 1, 1e-16), 0, 1e-5);
  const auto step = [](double x) { return ValueAndSlope{x < 0.3 ? -1.0 : 1.0, 0}; };
  EXPECT_NEAR(bracketed_root(step, 0, 1, false, 0.5, 1e-15), 0.3, 1e-14);
  const auto wrong_slope = [](double x) { return ValueAndSlope{x - 0.3, -1e-3}; };
  EXPECT_NEAR(bracketed_root(wrong_slope, 0, 1, false, 0.5, 1e-15), 0.3, 1e-14);
}

TEST(Bracket, StaysInside) {
  // The caller's word about the ends counts, also where the function never changes sign.
  const auto positive = [](double x) { return ValueAndSlope{x * x + 1, 2 * x}; };
  const double x = bracketed_root(positive, 2, 3, true, 2.5, 1e-16);
  EXPECT_GE(x, 2);
  EXPECT_LE(x, 3);
}

TEST(DepressedCubic, FindsAllSimpleZeros) {
  SCOPED_TRACE("seed 11");
  Random random(11);
  int three = 0;
  for (int i = 0; i < 2000; ++i) {
    const double z1 = random.between(-0.7, 0.7), z2 = random.between(-0.7, 0.7), z3 = -z1 - z2;
    std::vector<double> expected;
    for (const double z : {z1, z2, z3}) {
      if (std::fabs(z) < 0.99) expected.push_back(z);
    }
    std::sort(expected.begin(), expected.end());
    double gap = 1;
    for (std::size_t k = 1; k < expected.size(); ++k) gap = std::min(gap, expected[k] - expected[k - 1]);
    if (gap < 1e-3 || std::fabs(std::fabs(z3) - 1) < 0.02) continue;
    DepressedCubicZeros zeros(z1 * z2 + z1 * z3 + z2 * z3, -z1 * z2 * z3, -1, 1);
    double zero = 0;
    for (const double z : expected) {
      ASSERT_TRUE(zeros.next(zero));
      ASSERT_NEAR(zero, z, 1e-12 / gap);
    }
    ASSERT_FALSE(zeros.next(zero));
    three += expected.size() == 3;
  }
  EXPECT_GT(three, 500);
}

TEST(DepressedCubic, MonotoneOnesHaveAtMostOne) {
  DepressedCubicZeros zeros(0.5, -0.2, -1, 1);
  double zero = 0;
  ASSERT_TRUE(zeros.next(zero));
  EXPECT_NEAR(zero * zero * zero + 0.5 * zero - 0.2, 0, 1e-15);
  EXPECT_FALSE(zeros.next(zero));
  DepressedCubicZeros outside(0.5, -0.2, 0.5, 1);
  EXPECT_FALSE(outside.next(zero));
}

TEST(Bernstein, EvaluatesLikeThePolynomial) {
  const BernsteinQuartic q = from_zeros({0.1, 0.35, 0.6, 2}, 3);
  for (double x = 0; x <= 1; x += 0.05) {
    const auto v = q.at(x);
    EXPECT_NEAR(v.value, 3 * (x - 0.1) * (x - 0.35) * (x - 0.6) * (x - 2), 1e-14);
    EXPECT_NEAR(v.slope, (q.at(x + 1e-6).value - q.at(x - 1e-6).value) / 2e-6, 1e-7);
  }
  BernsteinQuartic left, right;
  q.split(left, right);
  EXPECT_EQ(left.b[4], right.b[0]);
  EXPECT_NEAR(left.at(0.6).value, q.at(0.3).value, 1e-15);
  EXPECT_NEAR(right.at(0.6).value, q.at(0.8).value, 1e-15);
}

TEST(Bernstein, FindsEverySignChange) {
  SCOPED_TRACE("seed 12");
  Random random(12);
  double worst = 0;
  for (int i = 0; i < 4000; ++i) {
    std::vector<double> zeros;
    for (int k = random.below(5); k > 0; --k) zeros.push_back(random.between(-0.5, 1.5));
    std::vector<double> inside;
    for (const double z : zeros) {
      if (z > 0 && z < 1) inside.push_back(z);
    }
    std::sort(inside.begin(), inside.end());
    const BernsteinQuartic q = from_zeros(zeros, random.below(2) ? 1 : -1);
    const std::vector<double> found = changes(q);
    double gap = 1;
    std::vector<double> ends = zeros;
    ends.push_back(0);
    ends.push_back(1);
    std::sort(ends.begin(), ends.end());
    for (std::size_t k = 1; k < ends.size(); ++k) gap = std::min(gap, ends[k] - ends[k - 1]);
    ASSERT_EQ(found.size() % 2, static_cast<std::size_t>((q.b[0] > 0) != (q.b[4] > 0)));
    if (gap < 1e-4) continue;
    ASSERT_EQ(found.size(), inside.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
      double slope = 1, size = 1;
      for (const double z : zeros) {
        if (z != inside[k]) slope *= std::fabs(inside[k] - z);
        size *= std::max(std::fabs(z), std::fabs(1 - z));
      }
      worst = std::max(worst, std::fabs(found[k] - inside[k]) * slope / (size * 0x1p-52));
    }
  }
  // In units of the rounding of the coefficients over the slope.
  EXPECT_LT(worst, 8);
  RecordProperty("worst", std::to_string(worst));
}

TEST(Bernstein, TouchingIsEvenOrNothing) {
  for (int exponent = 1; exponent < 60; ++exponent) {
    for (const double sign : {1.0, -1.0}) {
      BernsteinQuartic q = from_zeros({0.3, 0.3, 1.5, -0.7}, 1);
      for (double& b : q.b) b += sign * std::ldexp(1.0, -exponent);
      EXPECT_EQ(changes(q).size() % 2, (q.b[0] > 0) != (q.b[4] > 0) ? 1U : 0U);
    }
  }
}

TEST(Bernstein, StopsWhenTold) {
  const BernsteinQuartic q = from_zeros({0.2, 0.4, 0.6, 0.8}, 1);
  int calls = 0;
  EXPECT_TRUE(sign_changes(q, [&](double) { return ++calls == 2; }));
  EXPECT_EQ(calls, 2);
  EXPECT_FALSE(sign_changes(q, [&](double) { return false; }));
}

}  // namespace
}  // namespace rayshade::roots
