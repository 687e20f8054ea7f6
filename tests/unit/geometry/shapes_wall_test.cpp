// SPDX-License-Identifier: MIT
// Cylinders, cones and the frame that they share: poles, rims, ends, double cones, tangents, extreme sizes,
// bounds.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "rayshade/geometry/roots/quadratic.h"
#include "rayshade/geometry/shapes/cone.h"
#include "rayshade/geometry/shapes/cylinder.h"
#include "rayshade/geometry/shapes/disc.h"
#include "rayshade/geometry/shapes/frame.h"
#include "rayshade/geometry/shapes/sphere.h"
#include "rayshade/math/functions.h"

namespace rayshade {
namespace {

void expect_near(const Vec3& actual, const Vec3& expected, double tolerance = 1e-12) {
  EXPECT_NEAR(actual.x, expected.x, tolerance);
  EXPECT_NEAR(actual.y, expected.y, tolerance);
  EXPECT_NEAR(actual.z, expected.z, tolerance);
}

template <class Shape>
double hit_at(const Shape& shape, const Ray& ray, double lo = 0, double hi = kFar) {
  ShapeHit hit;
  return shape.intersect(ray, lo, hi, hit) ? hit.t : std::nan("");
}

TEST(AxisFrame, ExactPolesAreKept) {
  const AxisFrame up = axis_frame({0, 0, 3}), down = axis_frame({0, 0, -0.5});
  EXPECT_EQ(up.rows[0], (Vec3{1, 0, 0}));
  EXPECT_EQ(up.rows[1], (Vec3{0, 1, 0}));
  EXPECT_EQ(up.rows[2], (Vec3{0, 0, 1}));
  EXPECT_EQ(down.rows[0], (Vec3{1, 0, 0}));
  EXPECT_EQ(down.rows[1], (Vec3{0, -1, 0}));
  EXPECT_EQ(down.rows[2], (Vec3{0, 0, -1}));
}

TEST(AxisFrame, IsTheSmallestRotationForAllAxes) {
  std::mt19937_64 engine(5);
  std::printf("seed 5\n");
  std::uniform_real_distribution<double> uniform(-1, 1);
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    const double tilt = i % 2 ? 1 : std::ldexp(1.0, -static_cast<int>(engine() % 60));
    const Vec3 axis{tilt * uniform(engine), tilt * uniform(engine),
                    i % 4 < 2   ? uniform(engine)
                    : i % 8 < 4 ? 1
                                : -1.0};
    const AxisFrame frame = axis_frame(axis);
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b)
        worst = std::max(worst, std::fabs(dot(frame.rows[a], frame.rows[b]) - (a == b)));
    }
    const Vec3 w = normalize(axis);
    ASSERT_EQ(frame.rows[2], w);
    EXPECT_GT(dot(cross(frame.rows[0], frame.rows[1]), w), 0.9) << "right-handed";
    // The axis of the smallest rotation lies in the xy plane, across w, and stays where it is.
    const Vec3 turning = normalize({-w.y, w.x, 0});
    const Vec3 image = turning.x * frame.rows[0] + turning.y * frame.rows[1];
    for (int k = 0; k < 3; ++k) worst = std::max(worst, std::fabs(image[k] - turning[k]));
  }
  std::printf("  largest deviation %.2f roundings\n", worst / 0x1p-53);
  EXPECT_LT(worst, 14 * 0x1p-53);
}

TEST(AxisFrame, SlightTiltsLeanWhereTheyAreWritten) {
  // objects.md G11: the original leaned all of these toward +y.
  const Cylinder cylinder(shape::Cylinder{0.5, {0, 0, 0}, {.04, 0, 10}});
  EXPECT_NEAR(hit_at(cylinder, {{5, 0, 9.5}, {-1, 0, 0}}), 5 - (.5 / std::sqrt(1 - 1.6e-5) + .038), 1e-5);
  EXPECT_NEAR(hit_at(cylinder, {{-5, 0, 9.5}, {1, 0, 0}}), 5 - (.5 / std::sqrt(1 - 1.6e-5) - .038), 1e-5);
}

TEST(ShapesWall, RimsBelongToTheWallAndTheLowerLimitIsClosed) {
  const Cylinder cylinder(shape::Cylinder{1, {0, 0, 0}, {0, 0, 2}});
  for (const double z : {0.0, 1.0, 2.0}) EXPECT_EQ(hit_at(cylinder, {{3, 0, z}, {-1, 0, 0}}), 2);
  EXPECT_TRUE(std::isnan(hit_at(cylinder, {{3, 0, std::nextafter(2.0, 3)}, {-1, 0, 0}})));
  EXPECT_TRUE(std::isnan(hit_at(cylinder, {{3, 0, -1e-15}, {-1, 0, 0}})));
  EXPECT_EQ(hit_at(cylinder, {{3, 0, 1}, {-1, 0, 0}}, 2), 2);
  EXPECT_EQ(hit_at(cylinder, {{3, 0, 1}, {-1, 0, 0}}, std::nextafter(2.0, 3)), 4)
      << "the far wall, from inside";
  EXPECT_EQ(hit_at(cylinder, {{3, 0, 1}, {-1, 0, 0}}, 0, 2), 2);
  EXPECT_TRUE(std::isnan(hit_at(cylinder, {{3, 0, 1}, {-1, 0, 0}}, 0, 1.999)));
  // No caps; parallel to the axis nothing is met.
  EXPECT_TRUE(std::isnan(hit_at(cylinder, {{0.5, 0, 5}, {0, 0, -1}})));
  EXPECT_TRUE(std::isnan(hit_at(cylinder, {{1, 0, 5}, {-0.0, 0.0, -1}})));
  // In through the open end.
  EXPECT_DOUBLE_EQ(hit_at(cylinder, {{0, 0, 3}, {1, 0, -2}}), 1);
}

TEST(ShapesWall, AlmostParallelRaysAreNotLost) {
  // d.x^2 + d.y^2 is below the original's 1e-10.
  const Cylinder cylinder(shape::Cylinder{1, {0, 0, 0}, {0, 0, 1e7}});
  EXPECT_NEAR(hit_at(cylinder, {{0, 0, -1}, {1e-6, 0, 1}}), 1e6, 1e-8);
  // |a| below the original's 1e-5, where it took a straight line for the parabola.
  const Cone cone(shape::Cone{1, {0, 0, 0}, 0, {0, 0, 1}});
  for (const double tilt : {0.0, 1e-6, -1e-6, 1e-12, 4e-6}) {
    const Ray ray{{-3, 0.25, 0.5}, {1, 0, tilt - 1}};
    ShapeHit hit;
    const bool found = cone.intersect(ray, 0, kFar, hit);
    const Ray nudged{{-3, 0.25, 0.5}, {1, 0, tilt - 1 + 1e-4}};
    ShapeHit other;
    ASSERT_EQ(found, cone.intersect(nudged, 0, kFar, other));
    if (found) {
      EXPECT_NEAR(hit.t, other.t, 1e-2);
    }
  }
  // Parallel to the wall, so that there is one root only: (t - 1)^2 + 1/16 = (t - 1/2)^2.
  EXPECT_NEAR(hit_at(cone, {{-1, 0.25, 0.5}, {1, 0, 0}}), 1 - std::sqrt(0.25 - 0.0625), 1e-15);
  EXPECT_NEAR(hit_at(cone, {{-1, 0.25, 1.5}, {1, 0, -1}}), 0.8125, 1e-15);
}

TEST(ShapesWall, ExtremeSizesAreDrawn) {
  // objects.md G10 and G13: these vanished, or ended the run.
  EXPECT_NEAR(hit_at(Cylinder(shape::Cylinder{1e-5, {0, 0, 0}, {0, 0, .5}}), {{1, 0, .25}, {-1, 0, 0}}),
              1 - 1e-5, 1e-15);
  EXPECT_NEAR(hit_at(Cylinder(shape::Cylinder{2e5, {0, 0, 0}, {0, 0, 3e5}}), {{1e6, 0, 1}, {-1, 0, 0}}), 8e5,
              1e-9);
  EXPECT_NEAR(hit_at(Cone(shape::Cone{2e5, {0, 0, 0}, 0, {0, 0, 3e5}}), {{1e6, 0, 1.5e5}, {-1, 0, 0}}), 9e5,
              1e-9);
  EXPECT_NEAR(hit_at(Cone(shape::Cone{1e-12, {0, 0, 0}, 0, {0, 0, 1e6}}), {{1, 0, 0}, {-1, 0, 0}}), 1 - 1e-12,
              1e-15);
  // A cone that is a cylinder but for the last digits.
  EXPECT_NEAR(hit_at(Cone(shape::Cone{1 + 1e-15, {0, 0, 0}, 1, {0, 0, 1}}), {{3, 0, .5}, {-1, 0, 0}}), 2,
              1e-14);
}

TEST(ShapesCone, ThinEndIsWhereVIsZero) {
  const shape::Cone written{1, {0, 0, 0}, .25, {0, 0, 2}}, turned{.25, {0, 0, 2}, 1, {0, 0, 0}};
  for (const shape::Cone& form : {written, turned}) {
    const Cone cone(form);
    EXPECT_NEAR(cone.texture_coordinates({.25, 0, 2}, {}, {}).v, 0, 1e-15);
    EXPECT_NEAR(cone.texture_coordinates({1, 0, 0}, {}, {}).v, 1, 1e-15);
    EXPECT_NEAR(cone.texture_coordinates({0, 1, 0}, {}, {}).u, 0.75, 1e-15)
        << "the axis points down: y is negated";
  }
  const Cone pointed(shape::Cone{0, {0, 0, 0}, 1, {0, 0, 1}});
  EXPECT_EQ(pointed.texture_coordinates({0, 0, 0.5e-5}, {}, {}).u, 0);
  EXPECT_NEAR(pointed.texture_coordinates({0, .5, .5}, {}, {}).u, 0.25, 1e-15);
  EXPECT_NEAR(pointed.texture_coordinates({-.5, 0, .5}, {}, {}).u, 0.5, 1e-15);
}

TEST(ShapesCone, TangentsAsTheOriginalHasThem) {
  // The frame as one matrix: scale(r, r, T), then the rotation (objects.md 3.1); du goes through it twice.
  const shape::Cone form{.5, {1, 2, 3}, 1.25, {2, 2.5, 5}};
  const Cone cone(form);
  const Vec3 axis = form.top - form.bottom;
  const double apex_height = length(axis) * 1.25 / 0.75;
  const AxisFrame frame = axis_frame(axis);
  const Affine matrix{{1.25 * frame.rows[0], 1.25 * frame.rows[1], apex_height * frame.rows[2]},
                      form.top - apex_height * frame.rows[2]};
  const Vec3 canonical{0.36, 0.48, 0.6};
  const TextureCoordinates at = cone.texture_coordinates(matrix.point(canonical), {}, {});
  expect_near(at.du, normalize(matrix.vector(matrix.vector({-0.48, 0.36, 0}))));
  expect_near(at.dv, normalize(canonical));
  EXPECT_NEAR(at.v, (0.6 - 0.4) / 0.6, 1e-14);
  EXPECT_NEAR(at.u, fn::acos(0.6) / (2 * fn::kPi), 1e-14);
}

TEST(ShapesCone, NegativeRadiusMakesADoubleCone) {
  const Cone cone(shape::Cone{1, {0, 0, 1}, -1, {0, 0, -1}});
  EXPECT_EQ(hit_at(cone, {{2, 0, .5}, {-1, 0, 0}}), 1.5);
  EXPECT_EQ(hit_at(cone, {{2, 0, -.5}, {-1, 0, 0}}), 1.5);
  EXPECT_EQ(hit_at(cone, {{2, 0, 0}, {-1, 0, 0}}), 2) << "the apex";
  EXPECT_TRUE(std::isnan(hit_at(cone, {{2, 0, 1.001}, {-1, 0, 0}})));
  const auto normal = [&](double z) {
    const Ray ray{{2, 0, z}, {-1, 0, 0}};
    ShapeHit hit;
    EXPECT_TRUE(cone.intersect(ray, 0, kFar, hit));
    return cone.surface_point(ray, hit).normal;
  };
  const double h = std::sqrt(0.5);
  expect_near(normal(.5), {h, 0, -h});
  expect_near(normal(-.5), {-h, 0, -h});
  expect_near(normal(0), {0, 0, -1});
  // The negative end may be the wider one: nothing is cut off its bounds (objects.md G26).
  const Cone wide(shape::Cone{.5, {0, 0, 1}, -2, {0, 0, -1}});
  EXPECT_LE(wide.bounds().lo.x, -2);
  EXPECT_GE(wide.bounds().hi.y, 2);
  EXPECT_NEAR(hit_at(wide, {{5, 0, -1}, {-1, 0, 0}}), 3, 1e-15);
  // Two negative radii: the cone of the positive ones.
  const Cone both(shape::Cone{-1, {0, 0, 0}, -.5, {0, 0, 1}}),
      plain(shape::Cone{1, {0, 0, 0}, .5, {0, 0, 1}});
  const Ray ray{{2, .25, .5}, {-1, 0, 0.1}};
  EXPECT_EQ(hit_at(both, ray), hit_at(plain, ray));
}

TEST(ShapesWall, BoundsHoldTheWallAndAreTight) {
  std::mt19937_64 engine(17);
  std::printf("seed 17\n");
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&](double size) {
    return Vec3{size * uniform(engine), size * uniform(engine), size * uniform(engine)};
  };
  for (int i = 0; i < 300; ++i) {
    const Vec3 bottom = vector(10), top = bottom + (i % 5 ? vector(2) : Vec3{0, 0, uniform(engine)});
    const double r0 = std::fabs(uniform(engine)) + 0.01, r1 = i % 3 ? 2 * uniform(engine) : r0;
    const Cylinder cylinder(shape::Cylinder{r0, bottom, top});
    const Cone cone(shape::Cone{r0, bottom, r1, top});
    const AxisFrame frame = axis_frame(top - bottom);
    Bounds3 seen;
    const auto walk = [&](auto&& bounds, double from, double to) {
      seen = {};
      for (int k = 0; k < 720; ++k) {
        const double angle = k * fn::kPi / 360;
        const Vec3 out = fn::cos(angle) * frame.rows[0] + fn::sin(angle) * frame.rows[1];
        for (const double s : {0.0, 0.3, 1.0}) {
          const Vec3 p = bottom + s * (top - bottom) + (from + s * (to - from)) * out;
          seen.add(p);
          ASSERT_TRUE(grown(bounds, 1e-14).contains(p));
        }
      }
      const double slack = 1e-4 * (std::fabs(from) + std::fabs(to));
      EXPECT_LT(max_abs(bounds.lo - seen.lo), slack);
      EXPECT_LT(max_abs(bounds.hi - seen.hi), slack);
    };
    walk(cylinder.bounds(), r0, r0);
    if (r0 != r1) walk(cone.bounds(), r0, r1);
  }
  const Disc disc(shape::Disc{2, {1, 2, 3}, {0, 0, -4}});
  EXPECT_NEAR(disc.bounds().lo.z, 3, 1e-13);
  EXPECT_NEAR(disc.bounds().hi.x, 3, 1e-13);
  EXPECT_LE(disc.bounds().lo.y, 0);
}

TEST(Quadratic, RootsWithoutCancellation) {
  QuadraticRoots roots{};
  ASSERT_TRUE(solve_quadratic(1, -5e7, 1, roots));  // the small root is 1e-8 (1 + 1e-16 ...)
  EXPECT_DOUBLE_EQ(roots.near, 1e-8);
  EXPECT_DOUBLE_EQ(roots.far, 1e8);
  ASSERT_TRUE(solve_quadratic(1, 5e7, 1, roots));
  EXPECT_DOUBLE_EQ(roots.near, -1e8);
  EXPECT_DOUBLE_EQ(roots.far, -1e-8);
  // (t - 1)(t - 1 - 2^-26): b^2 and a c agree in all but their last bits, beyond what doubles hold.
  const double e = 0x1p-26;
  ASSERT_TRUE(solve_quadratic(1, -(1 + e / 2), 1 + e, roots));
  EXPECT_EQ(roots.near, 1);
  EXPECT_EQ(roots.far, 1 + e);
  ASSERT_TRUE(solve_quadratic(-2, 0, 0, roots));
  EXPECT_EQ(roots.near, 0);
  EXPECT_EQ(roots.far, 0);
  ASSERT_TRUE(solve_quadratic(0, 2, -8, roots)) << "a straight line";
  EXPECT_TRUE(roots.near == 2 || roots.far == 2);
  EXPECT_FALSE(solve_quadratic(1, 0, 1, roots));
}

TEST(Quadratic, ProductDifferenceIsAccurate) {
  const double x = 1 + 0x1p-30, y = 1 - 0x1p-30;  // x y = 1 - 2^-60, which rounds to 1
  EXPECT_EQ(product_difference(x, y, 1, 1), -0x1p-60);
  EXPECT_EQ(product_difference(1, 1, x, y), 0x1p-60);
  EXPECT_EQ(product_difference(x, y, y, x), 0);
}

}  // namespace
}  // namespace rayshade
