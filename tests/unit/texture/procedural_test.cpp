// SPDX-License-Identifier: MIT
// The procedural textures against values computed apart from the formulas of textures.md 3 (a second program
// over the noise table), and their special cases.
#include "rayshade/texture/procedural.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rayshade {
namespace {

const Vec3 kA{0.1, 0.2, 0.3}, kB{1.25, -2.5, 3.75}, kC{-3.1, -4.1, -5.9};
const double kInfinity = std::numeric_limits<double>::infinity();

TEST(Checker, IsParityOfCellsWithIntegersUpToZeroInTheCellBelow) {
  const auto odd = [](double x) { return checker_is_odd({x, 0.5, 0.5}); };
  EXPECT_FALSE(odd(0.001));
  EXPECT_FALSE(odd(0.999));
  EXPECT_TRUE(odd(1));
  EXPECT_TRUE(odd(1.999));
  EXPECT_FALSE(odd(2));
  EXPECT_TRUE(odd(0));
  EXPECT_TRUE(odd(-0.999));
  EXPECT_FALSE(odd(-1));
  EXPECT_FALSE(odd(-1.5));
  EXPECT_TRUE(odd(-2));
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 q{0.5, 0.5, 0.5};
    EXPECT_FALSE(checker_is_odd(q));
    q[axis] = -0.5;
    EXPECT_TRUE(checker_is_odd(q));
    q[axis] = 7.5;
    EXPECT_TRUE(checker_is_odd(q));
  }
}

TEST(Checker, TakesAnyNumber) {
  for (const double x : {1e17, -1e17, 1e300, -1e300, kInfinity, -kInfinity, std::nan("")}) {
    EXPECT_FALSE(checker_is_odd({x, 0.5, 0.5})) << x;
  }
}

TEST(Blotch, BlendsFromTheThresholdUp) {
  EXPECT_NEAR(blotch_share(kA, -0.4), 0.34418350221451816, 1e-12);
  EXPECT_NEAR(blotch_share(kB, -0.4), 0.4125662744045258, 1e-12);
  EXPECT_EQ(blotch_share(kA, 0.9), 0);
  EXPECT_EQ(blotch_share(kA, 1), 0);
  EXPECT_EQ(blotch_share(kA, noise3(kA)), 0);
}

TEST(Fbm, IsOffsetBelowTheThreshold) {
  const FbmParameters fbm{0.5, 2, 5};
  EXPECT_NEAR(fbm_value(kA, fbm, 0.2, 0.9, -0.3), 0.643708912602069, 1e-12);
  EXPECT_NEAR(fbm_value(kB, fbm, 0.2, 0.9, -0.3), 0.8480880719423294, 1e-12);
  EXPECT_EQ(fbm_value(kC, fbm, 0.2, 0.9, -0.3), 0.2);
  EXPECT_EQ(fbm_value(kB, fbm, 0.3, 0, -0.3), 0.3);
}

TEST(Wood, HasItsColours) {
  const auto expect = [](const Vec3& q, double r, double g, double b) {
    const Color c = wood_color(q);
    EXPECT_NEAR(c.r, r, 1e-11);
    EXPECT_NEAR(c.g, g, 1e-11);
    EXPECT_NEAR(c.b, b, 1e-11);
  };
  expect(kA, 0.3626370592467255, 0.23235807191047378, 0.2650792876170645);
  expect(kB, 0.5072545481544117, 0.35443437716894877, 0.39071583243835656);
  expect(kC, 0.3298140859304912, 0.20628482109791013, 0.2371769923368774);
}

TEST(Gloss, FillsASquareAroundTheNormal) {
  const Vec3 n = normalize({1, 2, 3});
  Vec3 u, w;
  coordinate_system(n, u, w);
  const auto expect = [&](const Vec3& got, double x, double y) {
    EXPECT_LT(length(got - normalize(n + x * u + y * w)), 1e-14);
  };
  expect(gloss_normal(n, 0.6, {0, 0}, -1, 1), -0.4, -0.4);
  expect(gloss_normal(n, 0.6, {0.75, 0.25}, -1, 1), 0.2, -0.2);
  expect(gloss_normal(n, 0.6, {0.75, 0.25}, 0, 1), 0.2, -0.2);
  // Sample 5 of 3 x 3: column 2, row 1 of cells two thirds wide.
  expect(gloss_normal(n, 0, {0.5, 0.5}, 5, 3), 2.0 / 3, 0);
  expect(gloss_normal(n, 0, {0, 0}, 5, 3), 1.0 / 3, -1.0 / 3);
  EXPECT_LT(length(gloss_normal(n, 1, {0.1, 0.9}, 0, 1) - n), 1e-15);
}

TEST(Sky, ScalesItsThresholdsToOne) {
  const FbmParameters common{0.5, 2, 5};
  EXPECT_NEAR(sky_intensity(kA, common, 0.8, 0.65, 0.35), 0.7179230408897447, 1e-12);
  EXPECT_NEAR(sky_intensity(kB, common, 0.8, 0.65, 0.35), 0.8781495266620819, 1e-12);
  EXPECT_NEAR(sky_intensity(kC, common, 0.8, 0.65, 0.35), 0.19607008790918634, 1e-12);
  const FbmParameters other{fbm_omega(0.4, 2.1), 2.1, 4};
  EXPECT_NEAR(sky_intensity(kA, other, 0, 0.7, 0.3), 0.5954453179934179, 1e-12);
  EXPECT_NEAR(sky_intensity(kC, other, 0, 0.7, 0.3), 0.23571977073338804, 1e-12);
}

TEST(Sky, EqualThresholdsCutAndNoLimitIsOneHalf) {
  const FbmParameters common{0.5, 2, 5};
  EXPECT_EQ(sky_intensity(kB, common, 1, 0.5, 0.5), 1);
  EXPECT_EQ(sky_intensity(kC, common, 1, 0.5, 0.5), 0);
  EXPECT_EQ(sky_intensity(kA, {1, 2, 5}, 1, 1, 0), 0.5);
}

TEST(Cloud, DependsOnNoiseAndLimb) {
  const CloudParameters p{{fbm_omega(0.45, 2), 2, 5}, 0.45, 0.9, 0.1, 0.35, 0.65};
  const Vec3 origin{0.5, -3, 1.5};
  const auto expect = [&](const Vec3& q, const Vec3& target, double transparency, double diffuse,
                          double ambient) {
    const CloudValue v = cloud_value(q, origin, normalize(target - origin), p);
    EXPECT_NEAR(v.transparency, transparency, 1e-12);
    EXPECT_NEAR(v.diffuse, diffuse, 1e-12);
    EXPECT_NEAR(v.ambient, ambient, 1e-12);
  };
  expect(kA, {0.1, 0, 0}, 0.5262838978743909, 0.22231189222668304, 0.4737161021256091);
  expect(kA, {-0.4, -0.6, 0.5}, 0.6897432596397457, 0.14560147463022477, 0.3102567403602543);
  expect(kB, {0.3, 0.5, -0.2}, 0.7255753185467491, 0.10276424319118771, 0.27442468145325094);
  expect(kC, {0.1, 0, 0}, 0.07730257320121314, 0.6753661530076398, 0.9226974267987869);
}

TEST(Cloud, IsNotSeenFromWithin) {
  const CloudParameters p{{0.5, 2, 5}, 0.5, 1, 0.1, 0.35, 0.65};
  for (const Vec3& origin : {Vec3{}, Vec3{0, 0, 1}, Vec3{0, 0.5, 0.5}}) {
    const CloudValue v = cloud_value(kA, origin, {1, 0, 0}, p);
    EXPECT_EQ(v.transparency, 1);
    EXPECT_EQ(v.diffuse, 0);
    EXPECT_EQ(v.ambient, 0);
  }
}

TEST(Cloud, DivisionsByZeroAreDecided) {
  const Vec3 origin{0, 0, 3}, inward{0, 0, -1};  // limb 1
  // H = 0: intensity one half everywhere (textures.md D6).
  EXPECT_NEAR(cloud_value(kA, origin, inward, {{1, 2, 5}, 0, 1, 0.1, 0.35, 0.5}).transparency, 1 - 0.4 / 0.5,
              1e-15);
  // tscale = 0: by sign (D23).
  EXPECT_EQ(cloud_value(kA, origin, inward, {{1, 2, 5}, 0, 1, 0.1, 0.35, 0}).transparency, 0);
  EXPECT_EQ(cloud_value(kA, origin, inward, {{1, 2, 5}, 0, 1, 0.9, 0.35, 0}).transparency, 1);
}

TEST(Stripe, HasBandBevelsAndField) {
  const double w = 0.1, bump = 0.7;
  const auto part = [&](double u, double v) { return stripe_value(u, v, w, bump).part; };
  EXPECT_EQ(part(0.5, 0.5), StripePart::kField);
  EXPECT_EQ(part(0.05, 0.5), StripePart::kBand);
  EXPECT_EQ(part(0.5, 0.05), StripePart::kBand);
  EXPECT_EQ(part(-0.95, 7.5), StripePart::kBand);
  EXPECT_EQ(part(-0.5, 7.5), StripePart::kField);
  const auto expect_bevel = [&](double u, double v, double fu, double fv) {
    const StripeValue value = stripe_value(u, v, w, bump);
    EXPECT_EQ(value.part, StripePart::kBevel) << u << " " << v;
    EXPECT_EQ(value.fu, fu) << u << " " << v;
    EXPECT_EQ(value.fv, fv) << u << " " << v;
  };
  expect_bevel(0.5, 0.15, 0, -bump);  // along the low v edge
  expect_bevel(0.95, 0.5, bump, 0);   // high u
  expect_bevel(0.15, 0.5, -bump, 0);  // low u
  expect_bevel(0.5, 0.95, 0, bump);   // high v
  expect_bevel(0.5, -0.05, 0, bump);
}

TEST(Mount, IndexIsBentHeight) {
  EXPECT_EQ(mount_index(kA, 0.4, 0.7, 0.9), 79);
  EXPECT_EQ(mount_index({0.4, 0.1, 0.2}, 0.4, 0.7, 0.9), 42);
  EXPECT_EQ(mount_index({0.4, 0.1, 0.9}, 0.4, 0.7, 0.9), 248);
  EXPECT_EQ(mount_index({0.9, 0.9, -0.2}, 0.4, 0.7, 0.9), 0);
  EXPECT_EQ(mount_index(kB, 0.4, 0.7, 0.9), 255);
  EXPECT_EQ(mount_index({0, 0, kInfinity}, 0.4, 0.7, 0.9), 0);
}

TEST(ColorIndex, TruncatesAndIsLimited) {
  EXPECT_EQ(color_index(0), 0);
  EXPECT_EQ(color_index(0.0045), 1);
  EXPECT_EQ(color_index(0.009), 2);
  EXPECT_EQ(color_index(0.9999), 254);
  EXPECT_EQ(color_index(1), 255);
  EXPECT_EQ(color_index(3), 255);
  EXPECT_EQ(color_index(-0.003), 0);
  EXPECT_EQ(color_index(-1e300), 0);
  EXPECT_EQ(color_index(1e300), 255);
  EXPECT_EQ(color_index(std::nan("")), 0);
}

}  // namespace
}  // namespace rayshade
