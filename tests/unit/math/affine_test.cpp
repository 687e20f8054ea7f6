// SPDX-License-Identifier: MIT
// Affine maps, their inverses, and boxes taken through them.
#include "rayshade/math/affine.h"

#include <gtest/gtest.h>

#include <random>

#include "rayshade/math/bounds.h"
#include "rayshade/math/functions.h"

namespace rayshade {
namespace {

void expect_near(const Vec3& a, const Vec3& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(AffineTest, RotationIsRightHanded) {
  // objects.md 1.4 and 1.5.
  expect_near(rotation_degrees({0, 0, 1}, 90).vector({1, 0, 0}), {0, 1, 0}, 1e-15);
  expect_near(rotation_degrees({1, 0, 0}, 90).vector({0, 1, 0}), {0, 0, 1}, 1e-15);
  expect_near(rotation_degrees({0, 5, 0}, 90).vector({0, 0, 1}), {1, 0, 0}, 1e-15);
  const Affine move = translation({1, 0, 0}), turn = rotation_degrees({0, 0, 1}, 90);
  expect_near(then(move, turn).point({}), {0, 1, 0}, 1e-15);
  expect_near(then(turn, move).point({}), {1, 0, 0}, 1e-15);
}

TEST(AffineTest, RotationAboutNothingIsIdentity) {
  EXPECT_EQ(rotation_degrees({0, 0, 0}, 90), Affine{});
  expect_near(rotation_degrees({0, 0, 1e-200}, 90).vector({1, 0, 0}), {0, 1, 0}, 1e-15);
}

TEST(AffineTest, InverseUndoes) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-3, 3);
  const auto vec = [&] { return Vec3{number(random), number(random), number(random)}; };
  for (int i = 0; i < 2000; ++i) {
    const double size = std::pow(10.0, number(random) * 3);
    const Affine map =
        then(then(rotation_degrees(vec(), 100 * number(random)), scaling({size, -size, 2 * size})),
             then(rotation_degrees(vec(), 77), translation(size * vec())));
    const auto back = inverse(map);
    ASSERT_TRUE(back.has_value());
    const Vec3 p = vec();
    expect_near(back->point(map.point(p)), p, 1e-13);
  }
}

TEST(AffineTest, OnlyTrulySingularMatricesHaveNoInverse) {
  EXPECT_TRUE(inverse(scaling({1e-60, 1e-60, 1e-60})).has_value());
  EXPECT_TRUE(inverse(scaling({1e-4, 1e4, 1})).has_value());
  EXPECT_FALSE(inverse(scaling({1, 0, 1})).has_value());
  EXPECT_FALSE(inverse(Affine{{{1, 2, 3}, {2, 4, 6}, {0, 0, 1}}, {}}).has_value());
  EXPECT_FALSE(inverse(Affine{{{1, 2, 3}, {4, 5, 6}, {5, 7, 9}}, {}}).has_value());
  EXPECT_FALSE(inverse(scaling({std::nan(""), 1, 1})).has_value());
}

TEST(AffineTest, NormalsStayPerpendicularToTheSurface) {
  const Affine map = then(scaling({1, 3, -0.7}), rotation_degrees({1, 2, 3}, 40));
  const AffinePair pair{map, *inverse(map)};
  const Vec3 tangent{1, -1, 0.5}, other{0.3, 1, 1}, normal = cross(tangent, other);
  const Vec3 moved = pair.normal(normal);
  EXPECT_NEAR(dot(moved, map.vector(tangent)), 0, 1e-14);
  EXPECT_NEAR(dot(moved, map.vector(other)), 0, 1e-14);
  EXPECT_NEAR(length(moved), 1, 1e-15);
}

TEST(AffineTest, TransformedBoxesHoldTheirPoints) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> number(-10, 10), part(0, 1);
  for (int i = 0; i < 500; ++i) {
    Bounds3 box;
    box.add(Vec3{number(random), number(random), number(random)});
    box.add(Vec3{number(random), number(random), number(random)});
    Affine map = rotation_degrees({number(random), number(random), number(random)}, 20 * number(random));
    map = then(map, scaling({number(random), 1e3 * number(random), 1}));
    map.translation = {number(random), 1e6 * number(random), 0};
    const Bounds3 moved = transformed(box, map);
    for (int j = 0; j < 50; ++j) {
      const Vec3 e = box.extent();
      const Vec3 p = box.lo + Vec3{part(random) * e.x, part(random) * e.y, part(random) * e.z};
      ASSERT_TRUE(moved.contains(map.point(p)));
    }
  }
  EXPECT_TRUE(transformed(Bounds3{}, scaling({2, 2, 2})).empty());
  EXPECT_TRUE(transformed(Bounds3::everything(), scaling({2, 2, 2})).unbounded());
}

TEST(VecTest, NormalizeWorksAtAnySize) {
  for (const double size : {1e-300, 1e-160, 1e-5, 1.0, 1e160, 1e300}) {
    EXPECT_NEAR(length(normalize({3 * size, 4 * size, 0})), 1, 1e-15) << size;
  }
  EXPECT_EQ(normalize({0, 0, 0}), (Vec3{0, 0, 0}));
}

TEST(VecTest, CoordinateSystemIsAQuestionOfDirectionOnly) {
  const Vec3 direction{1e-4, -2e-4, 1};
  Vec3 u, w;
  coordinate_system(direction, u, w);
  for (const double size : {0x1p-30, 0x1p-10, 0x1p30}) {
    Vec3 a, b;
    coordinate_system(size * direction, a, b);
    EXPECT_EQ(a, u) << size;
    EXPECT_EQ(b, w) << size;
  }
  coordinate_system({0, 1e-6, -1}, u, w);  // along z: the other pair
  EXPECT_EQ(u, (Vec3{-1, 0, 0}));
}

}  // namespace
}  // namespace rayshade
