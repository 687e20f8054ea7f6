// SPDX-License-Identifier: MIT
// Blending of surfaces and bumping of normals (textures.md 0, 1.6).
#include "rayshade/texture/surface_ops.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayshade {
namespace {

Surface numbered(double base) {
  Surface s;
  s.ambient = {base + 1, base + 2, base + 3};
  s.diffuse = {base + 4, base + 5, base + 6};
  s.specular = {base + 7, base + 8, base + 9};
  s.body = {base + 10, base + 11, base + 12};
  s.translucent = {base + 13, base + 14, base + 15};
  s.specular_exponent = base + 16;
  s.transmitted_exponent = base + 17;
  s.reflectance = base + 18;
  s.transparency = base + 19;
  s.translucency = base + 20;
  s.extinction = base + 21;
  s.index = base + 22;
  return s;
}

TEST(Blend, MixesEveryField) {
  Surface s = numbered(0);
  blend(s, numbered(100), 0.75, 0.25);
  EXPECT_EQ(s, numbered(25));
}

TEST(Blend, WeightsAreNotClamped) {
  Surface s = numbered(0);
  blend(s, numbered(100), -0.5, 1.5);
  EXPECT_EQ(s, numbered(150));
}

TEST(Blend, DoesNothingWithoutWeight) {
  Surface s = numbered(0);
  blend(s, numbered(100), 0.3, 0.9e-5);
  EXPECT_EQ(s, numbered(0));
}

TEST(Blend, NoShadowNeedsBothUnlessTheFirstHasNoWeight) {
  for (const bool mine : {false, true}) {
    for (const bool theirs : {false, true}) {
      Surface s, other;
      s.no_shadow = mine;
      other.no_shadow = theirs;
      Surface mixed = s;
      blend(mixed, other, 0.5, 0.5);
      EXPECT_EQ(mixed.no_shadow, mine && theirs);
      Surface replaced = s;
      blend(replaced, other, 0, 1);
      EXPECT_EQ(replaced.no_shadow, theirs);
    }
  }
}

TEST(MakeBump, TiltsAwayFromTheRise) {
  const Vec3 n{0, 0, 1}, du{1, 0, 0}, dv{0, 1, 0};
  EXPECT_LT(length(make_bump(n, du, dv, 1, 0) - normalize({-1, 0, 1})), 1e-15);
  EXPECT_LT(length(make_bump(n, du, dv, 0, 0.5) - normalize({0, -0.5, 1})), 1e-15);
  EXPECT_EQ(make_bump(n, du, dv, 0, 0), n);
}

TEST(TruncatedIndex, NeverLeavesItsTable) {
  EXPECT_EQ(truncated_index(254.999, 255), 254);
  EXPECT_EQ(truncated_index(255, 255), 255);
  EXPECT_EQ(truncated_index(256, 255), 255);
  EXPECT_EQ(truncated_index(-0.5, 255), 0);
  EXPECT_EQ(truncated_index(std::nan(""), 255), 0);
}

TEST(Clamp01, LetsNotANumberThrough) {
  EXPECT_EQ(clamp01(-1), 0);
  EXPECT_EQ(clamp01(2), 1);
  EXPECT_EQ(clamp01(0.25), 0.25);
  EXPECT_TRUE(std::isnan(clamp01(std::nan(""))));
}

}  // namespace
}  // namespace rayshade
