// SPDX-License-Identifier: MIT
// The reference values of objects.md 13, which reproduced the original's pictures without a deviating pixel.
#include <gtest/gtest.h>

#include <cmath>

#include "rayshade/geometry/shapes/box.h"
#include "rayshade/geometry/shapes/cone.h"
#include "rayshade/geometry/shapes/cylinder.h"
#include "rayshade/geometry/shapes/disc.h"
#include "rayshade/geometry/shapes/plane.h"
#include "rayshade/geometry/shapes/polygon.h"
#include "rayshade/geometry/shapes/sphere.h"
#include "rayshade/geometry/shapes/triangle.h"

namespace rayshade {
namespace {

struct Expected {
  Vec3 origin, direction;
  double t;
  Vec3 point, normal;
  double u, v;
  bool entering;
};

void expect_near(const Vec3& actual, const Vec3& expected, double tolerance, const char* what) {
  EXPECT_NEAR(actual.x, expected.x, tolerance) << what;
  EXPECT_NEAR(actual.y, expected.y, tolerance) << what;
  EXPECT_NEAR(actual.z, expected.z, tolerance) << what;
}

/// Half a unit of the last digit printed.
constexpr double kPrinted = 0.6e-6;

template <class Shape>
void check(const Shape& shape, const Expected& expected) {
  const Ray ray{expected.origin, normalize(expected.direction)};
  ShapeHit hit;
  ASSERT_TRUE(shape.intersect(ray, kEpsilon, kFar, hit));
  EXPECT_NEAR(hit.t, expected.t, 0.6e-7);
  const SurfacePoint surface = shape.surface_point(ray, hit);
  expect_near(surface.point, expected.point, kPrinted, "point");
  expect_near(surface.normal, expected.normal, kPrinted, "normal");
  EXPECT_EQ(surface.smooth, false);
  EXPECT_EQ(surface.geometric_normal, surface.normal);
  EXPECT_EQ(shape.entering(ray, kEpsilon, hit), expected.entering);
  const Vec3 facing = dot(surface.normal, ray.direction) > 0 ? -surface.normal : surface.normal;
  const TextureCoordinates texture = shape.texture_coordinates(surface.point, facing, hit);
  EXPECT_NEAR(texture.u, expected.u, kPrinted);
  EXPECT_NEAR(texture.v, expected.v, kPrinted);

  // The same answers with a direction of another length.
  for (const double factor : {1e-3, 1e3}) {
    const Ray scaled{ray.origin, factor * ray.direction};
    ShapeHit other;
    ASSERT_TRUE(shape.intersect(scaled, kEpsilon / factor, kFar / factor, other));
    EXPECT_NEAR(other.t * factor, hit.t, 1e-13 * hit.t);
    EXPECT_EQ(other.part, hit.part);
    EXPECT_NEAR(other.a, hit.a, 1e-13);
    EXPECT_NEAR(other.b, hit.b, 1e-13);
    expect_near(shape.surface_point(scaled, other).point, surface.point, 1e-13, "point of the scaled ray");
    EXPECT_EQ(shape.entering(scaled, kEpsilon / factor, other), expected.entering);
  }
}

const Vec3 kOrigin{3, -8, 4};

TEST(ShapesReference, SphereFromOutside) {
  check(Sphere(shape::Sphere{1, {0, 0, 0}}), {kOrigin,
                                              {-3.2, 8.3, -3.9},
                                              8.4614589,
                                              {0.212292, -0.769382, 0.602481},
                                              {0.212292, -0.769382, 0.602481},
                                              0.792849,
                                              0.705821,
                                              true});
}

TEST(ShapesReference, SphereFromInside) {
  check(Sphere(shape::Sphere{1, {0, 0, 0}}), {{0.1, 0.2, 0.3},
                                              {1, -2, 0.5},
                                              0.9951350,
                                              {0.534313, -0.668625, 0.517156},
                                              {0.534313, -0.668625, 0.517156},
                                              0.857303,
                                              0.673009,
                                              false});
}

TEST(ShapesReference, Cylinder) {
  check(Cylinder(shape::Cylinder{.5, {0, 0, 0}, {1, 1, 1}}), {kOrigin,
                                                              {-2.5, 8.3, -3.6},
                                                              9.0053449,
                                                              {0.601430, -0.036747, 0.546059},
                                                              {0.462366, -0.813989, 0.351624},
                                                              0.804142,
                                                              0.370247,
                                                              true});
}

TEST(ShapesReference, CylinderAlongNegativeZ) {
  check(Cylinder(shape::Cylinder{.5, {0, 0, 1}, {0, 0, -1}}), {kOrigin,
                                                               {-2.9, 8.2, -4.2},
                                                               8.9606276,
                                                               {0.309587, -0.392627, 0.103540},
                                                               {0.619175, -0.785253, -0.000000},
                                                               0.143734,
                                                               0.448230,
                                                               true});
}

TEST(ShapesReference, Cone) {
  check(Cone(shape::Cone{1, {0, 0, 0}, .25, {.5, 0, 2}}), {kOrigin,
                                                           {-2.7, 8.2, -3.1},
                                                           8.3985139,
                                                           {0.527906, -0.492159, 1.161670},
                                                           {0.469453, -0.851099, 0.235040},
                                                           0.680317,
                                                           0.391225,
                                                           true});
}

TEST(ShapesReference, Disc) {
  check(Disc(shape::Disc{1.5, {.5, .3, 0}, {0, .2, 1}}), {kOrigin,
                                                          {-2.4, 8.6, -4.1},
                                                          9.6598427,
                                                          {0.640336, 0.455462, -0.031092},
                                                          {0.000000, 0.196116, 0.980581},
                                                          0.500000,
                                                          0.141153,
                                                          true});
}

TEST(ShapesReference, PlaneFromBothSides) {
  check(Plane(shape::Plane{{.1, .2, .3}, {.3, -1, 1}}), {kOrigin,
                                                         {-2.4, 8.6, -4.1},
                                                         9.3490942,
                                                         {0.716244, 0.183458, 0.098584},
                                                         {0.207514, -0.691714, 0.691714},
                                                         0.585502,
                                                         -0.278903,
                                                         true});
  check(Plane(shape::Plane{{.1, .2, .3}, {-.3, 1, -1}}), {kOrigin,
                                                          {-2.4, 8.6, -4.1},
                                                          9.3490942,
                                                          {0.716244, 0.183458, 0.098584},
                                                          {-0.207514, 0.691714, -0.691714},
                                                          0.585502,
                                                          -0.278903,
                                                          false});
}

TEST(ShapesReference, Triangle) {
  check(Triangle(shape::Triangle{{{-1, 0, -1}, {1, .2, -.7}, {.3, 0, 1.2}}}),
        {kOrigin,
         {-2.8, 8.1, -4.1},
         9.4693885,
         {0.209177, 0.073452, -0.086562},
         {0.108845, -0.991976, -0.064318},
         0.578473,
         0.365118,
         true});
}

TEST(ShapesReference, UvTriangle) {
  const shape::UvTriangle triangle{{{-1, 0, -1}, {1, .2, -.7}, {.3, 0, 1.2}},
                                   {{0, -1, 0}, {0.2, -1, 0}, {0, -1, 0.2}},
                                   {.1, .9, .4},
                                   {.2, .3, .8}};
  const UvTriangle shape(triangle);
  const Ray ray{kOrigin, normalize({-2.8, 8.1, -4.1})};
  ShapeHit hit;
  ASSERT_TRUE(shape.intersect(ray, kEpsilon, kFar, hit));
  EXPECT_NEAR(hit.t, 9.4693885, 0.6e-7);
  const SurfacePoint surface = shape.surface_point(ray, hit);
  expect_near(surface.point, {0.209177, 0.073452, -0.086562}, kPrinted, "point");
  expect_near(surface.geometric_normal, {0.108845, -0.991976, -0.064318}, kPrinted, "normal");
  EXPECT_TRUE(surface.smooth);
  EXPECT_TRUE(shape.entering(ray, kEpsilon, hit));
  const TextureCoordinates texture = shape.texture_coordinates(surface.point, surface.geometric_normal, hit);
  EXPECT_NEAR(texture.u, 0.503345, kPrinted);
  EXPECT_NEAR(texture.v, 0.455797, kPrinted);
}

TEST(ShapesReference, Box) {
  check(Box(shape::Box{{-1, -1, -1}, {1, .5, .7}}),
        {kOrigin, {-2.8, 8.1, -3.4}, 8.9489077, {0.282353, -0.138235, 0.700000}, {0, 0, 1}, 0, 0, true});
}

}  // namespace
}  // namespace rayshade
