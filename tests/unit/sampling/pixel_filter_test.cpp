// SPDX-License-Identifier: MIT
// Filters as densities, against their weights.
#include "rayshade/sampling/pixel_filter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayshade {
namespace {

TEST(PixelFilter, TheBoxIsUniform) {
  const PixelFilter box(FilterKind::kBox, 1.5);
  EXPECT_EQ(box.offset(0, .5), (std::array<double, 2>{-.75, 0}));
  EXPECT_EQ(box.offset(.25, .75), (std::array<double, 2>{-.375, .375}));
}

TEST(PixelFilter, GaussMomentsAreThoseOfTheTruncatedGaussian) {
  for (const double width : {.5, 1.8, 4.0, 12.0}) {
    const PixelFilter gauss(FilterKind::kGauss, width);
    constexpr int kCount = 100'000;
    double sum = 0, squares = 0, fourth = 0, last = -width / 2 - 1e-9;
    for (int i = 0; i < kCount; ++i) {
      const double x = gauss.offset((i + .5) / kCount, 0)[0];
      ASSERT_GT(x, last) << width;
      ASSERT_LE(x, width / 2);
      last = x;
      sum += x;
      squares += x * x;
      fourth += x * x * x * x;
    }
    // With standard deviation 1, cut at +-a: E x^2 = 1 - 2 a f(a) / p, E x^4 = 3 E x^2 - 2 a^3 f(a) / p.
    const double a = width / 2, p = std::erf(a / std::sqrt(2.0));
    const double density = std::exp(-a * a / 2) / std::sqrt(2 * std::acos(-1.0));
    const double second = 1 - 2 * a * density / p;
    EXPECT_NEAR(sum / kCount, 0, 1e-6 * width);
    EXPECT_NEAR(squares / kCount, second, 1e-4 * second) << width;
    EXPECT_NEAR(fourth / kCount, 3 * second - 2 * a * a * a * density / p, 1e-3 * second) << width;
  }
}

TEST(PixelFilter, AFilterWiderThanItsWeightsHasNoHoles) {
  const PixelFilter gauss(FilterKind::kGauss, 1e4);
  for (const double xi : {0.0, .1, .5, .9, .999999}) EXPECT_TRUE(std::isfinite(gauss.offset(xi, xi)[0]));
  EXPECT_NEAR(gauss.offset(.5, .5)[0], 0, 1e-3);
}

}  // namespace
}  // namespace rayshade
