// SPDX-License-Identifier: MIT
// When pixels stop: rounds, what the surroundings suggest, and what agreeing samples are worth.
#include "rayshade/sampling/stop.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace rayshade {
namespace {

SampleSums samples(std::initializer_list<double> values) {
  SampleSums out;
  for (const double v : values) out.add({v, v, v}, true);
  return out;
}

/// Pixels whose four samples are all `value(x, y)`.
template <class Value>
Color prior_of(const Value& value) {
  std::vector<SampleMoments> moments;
  for (int i = 0; i < 9; ++i) {
    const double v = value(i % 3 - 1, i / 3 - 1);
    moments.emplace_back(samples({v, v, v, v}));
  }
  std::array<const SampleMoments*, 9> around;
  for (std::size_t i = 0; i < 9; ++i) around[i] = &moments[i];
  return StopRule::prior(around, 4);
}

TEST(StopRule, RoundsDoubleAndEndWithAllSamples) {
  for (int side = 1; side <= 64; ++side) {
    const int most = side * side;
    const StopRule rule(.01, most);
    int count = rule.first();
    EXPECT_EQ(count, std::min(2, most));
    while (count < most) {
      const int next = rule.next(count);
      ASSERT_GT(next, count) << side;
      ASSERT_TRUE(next == 2 * count || next == most) << side;
      count = next;
    }
    ASSERT_EQ(count, most);
  }
  EXPECT_EQ(StopRule(.01, 9).next(4), 9);
  EXPECT_EQ(StopRule(.01, 16).next(4), 8);
}

TEST(StopRule, WithoutToleranceAllSamplesAreTaken) {
  const StopRule rule(0, 25);
  EXPECT_EQ(rule.first(), 25);
  EXPECT_FALSE(rule.enough(samples({1, 1, 1, 1}), {}));
}

TEST(StopRule, RampsSuggestNothingAndEdgesMuch) {
  EXPECT_NEAR(prior_of([](int x, int y) { return .4 + .1 * x - .05 * y; }).r, 0, 1e-15);
  // One column of three: the residuals of the ramp are 1/6, -1/3, 1/6 in each row, over 6 degrees of freedom
  // and four samples each, and 27 more degrees within the pixels.
  EXPECT_NEAR(prior_of([](int x, int) { return x == 1 ? 1.0 : 0.0; }).g, 4 * 3 * (1.0 / 6) / 33, 1e-15);
}

TEST(StopRule, CalmPixelsStopAndPixelsBesideEdgesDoNotYet) {
  const StopRule rule(.01, 64);
  const SampleSums calm = samples({.5, .5, .5, .5});
  EXPECT_TRUE(rule.enough(calm, {}));
  const Color edge = prior_of([](int x, int) { return x == 1 ? 1.0 : 0.0; });
  EXPECT_FALSE(rule.enough(calm, edge));
  SampleSums many = calm;
  for (int i = 0; i < 60; ++i) many.add({.5, .5, .5}, true);
  EXPECT_TRUE(rule.enough(many, edge));
}

TEST(StopRule, TheEstimateFallsAsAtEdgesAndMoreIsAllowedOfManySamples) {
  // Half the samples 0, half 1: variance n/4 / (n - 1 + 4) of one, n^-1.5 of the mean; (n / 9)^.5 allowed.
  for (const int n : {4, 16, 36, 64}) {
    SampleSums pixel;
    for (int i = 0; i < n; ++i) pixel.add(i % 2 ? Color{1, 1, 1} : Color{}, true);
    const double error = std::sqrt(n / 4.0 / (n + 3) * std::pow(n, -1.5) / std::sqrt(n / 9.0));
    EXPECT_TRUE(StopRule(1.001 * error, 4096).enough(pixel, {})) << n;
    EXPECT_FALSE(StopRule(.999 * error, 4096).enough(pixel, {})) << n;
  }
}

TEST(StopRule, WhatIsShownAsFullIntensityIsExactEnough) {
  const StopRule rule(.01, 64);
  EXPECT_FALSE(rule.enough(samples({.1, .7, .3, .9}), {}));
  EXPECT_TRUE(rule.enough(samples({9.1, 9.7, 9.3, 9.9}), {}));
  EXPECT_FALSE(rule.enough(samples({0, 9, 0, 0}), {}));
}

TEST(StopRule, NotANumberIsNeverEnough) {
  EXPECT_FALSE(StopRule(.01, 64).enough(samples({.5, std::numeric_limits<double>::quiet_NaN(), .5, .5}), {}));
}

}  // namespace
}  // namespace rayshade
