// SPDX-License-Identifier: MIT
// What the specification says of flat shapes, spheres and boxes beyond its table of values: which limits are
// open, which numbers are kept although odd, and what is not lost at extreme sizes. Walls:
// shapes_wall_test.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

#include "rayshade/geometry/shapes/box.h"
#include "rayshade/geometry/shapes/cone.h"
#include "rayshade/geometry/shapes/cylinder.h"
#include "rayshade/geometry/shapes/disc.h"
#include "rayshade/geometry/shapes/plane.h"
#include "rayshade/geometry/shapes/polygon.h"
#include "rayshade/geometry/shapes/sphere.h"
#include "rayshade/geometry/shapes/triangle.h"
#include "rayshade/math/functions.h"

namespace rayshade {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

void expect_near(const Vec3& actual, const Vec3& expected, double tolerance = 1e-12) {
  EXPECT_NEAR(actual.x, expected.x, tolerance);
  EXPECT_NEAR(actual.y, expected.y, tolerance);
  EXPECT_NEAR(actual.z, expected.z, tolerance);
}

/// The distance of the hit, or NaN.
template <class Shape>
double hit_at(const Shape& shape, const Ray& ray, double lo = 0, double hi = kFar) {
  ShapeHit hit;
  return shape.intersect(ray, lo, hi, hit) ? hit.t : std::nan("");
}

template <class Shape>
bool hits(const Shape& shape, const Ray& ray, double lo = 0, double hi = kFar) {
  ShapeHit hit;
  return shape.intersect(ray, lo, hi, hit);
}

const Ray kDown{{0.25, 0.125, 4}, {0, 0, -1}};

TEST(ShapesLimits, LowerLimitIsOpenOrClosedAsTheTableSays) {
  const double after = std::nextafter(4.0, 5);
  const Plane plane(shape::Plane{{0, 0, 0}, {0, 0, 1}});
  EXPECT_FALSE(hits(plane, kDown, 4));
  EXPECT_TRUE(hits(plane, kDown, std::nextafter(4.0, 3)));

  const Disc disc(shape::Disc{1, {0, 0, 0}, {0, 0, 1}});
  const Triangle triangle(shape::Triangle{{{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}}});
  const Polygon polygon(shape::Polygon{{{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}}});
  EXPECT_EQ(hit_at(disc, kDown, 4), 4);
  EXPECT_EQ(hit_at(triangle, kDown, 4), 4);
  EXPECT_EQ(hit_at(polygon, kDown, 4), 4);
  EXPECT_FALSE(hits(disc, kDown, after));
  EXPECT_FALSE(hits(triangle, kDown, after));
  EXPECT_FALSE(hits(polygon, kDown, after));

  // Solids: at the near root the far one is next.
  const Ray through{{0, 0, 4}, {0, 0, -1}};
  const Sphere sphere(shape::Sphere{1, {0, 0, 0}});
  EXPECT_EQ(hit_at(sphere, through, 2.5), 3);
  EXPECT_EQ(hit_at(sphere, through, 3), 5);
  EXPECT_FALSE(hits(sphere, through, 5));
  const Box box(shape::Box{{-1, -1, -1}, {1, 1, 1}});
  EXPECT_EQ(hit_at(box, through, 2.5), 3);
  EXPECT_EQ(hit_at(box, through, 3), 5);
  EXPECT_EQ(hit_at(box, through, 5), 5) << "the exit is closed";
  EXPECT_FALSE(hits(box, through, std::nextafter(5.0, 6)));
}

TEST(ShapesLimits, UpperLimitIsClosedAndDoesNotChangeTheAnswer) {
  const Ray through{{0, 0, 4}, {0, 0, -1}};
  const Sphere sphere(shape::Sphere{1, {0, 0, 0}});
  EXPECT_EQ(hit_at(sphere, through, 0, 3), 3);
  EXPECT_FALSE(hits(sphere, through, 0, std::nextafter(3.0, 2)));
  const Box box(shape::Box{{-1, -1, -1}, {1, 1, 1}});
  EXPECT_EQ(hit_at(box, through, 0, 3), 3);
  EXPECT_FALSE(hits(box, through, 0, std::nextafter(3.0, 2)));
  EXPECT_EQ(hit_at(Plane(shape::Plane{{0, 0, 0}, {0, 0, 1}}), kDown, 0, 4), 4);
  EXPECT_EQ(hit_at(Disc(shape::Disc{1, {0, 0, 0}, {0, 0, 1}}), kDown, 0, 4), 4);
}

TEST(ShapesLimits, EdgeOnIsMissedRelativeToTheLengthOfTheDirection) {
  const Plane plane(shape::Plane{{0, 0, 0}, {0, 0, 2}});
  const Disc disc(shape::Disc{10, {0, 0, 0}, {0, 0, 3}});
  const Triangle triangle(shape::Triangle{{{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}});
  const Polygon polygon(shape::Polygon{{{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}});
  for (const double speed : {1e-6, 1.0, 1e6}) {
    const Ray flat{{-1, 0, 1e-5}, speed * Vec3{1, 0, -0.99e-5}};
    const Ray steeper{{-1, 0, 1e-5}, speed * Vec3{1, 0, -1.01e-5}};
    EXPECT_FALSE(hits(plane, flat, 0, kInf) || hits(disc, flat, 0, kInf) || hits(triangle, flat, 0, kInf) ||
                 hits(polygon, flat, 0, kInf));
    EXPECT_TRUE(hits(plane, steeper, 0, kInf) && hits(disc, steeper, 0, kInf) &&
                hits(triangle, steeper, 0, kInf) && hits(polygon, steeper, 0, kInf));
  }
}

TEST(ShapesLimits, NonsenseIsNeverHit) {
  const double nan = std::nan("");
  const auto none = [&](const auto& shape, const char* name) {
    for (const Vec3 d :
         {Vec3{0, 0, 0}, Vec3{-0.0, 0, 0}, Vec3{nan, 0, 1}, Vec3{0, 0, nan}, Vec3{nan, nan, nan}}) {
      for (const Vec3 o : {Vec3{0, 0, 0}, Vec3{0.25, 0.25, 2}, Vec3{1, 0, 0}}) {
        const double t = hit_at(shape, {o, d}, 0, kInf);
        EXPECT_FALSE(std::isinf(t)) << name;
        EXPECT_TRUE(std::isnan(t) || std::isnan(d.x)) << name << ' ' << t;
      }
    }
    EXPECT_FALSE(hits(shape, {{nan, 0, 3}, {0, 0, -1}}, 0, kInf)) << name;
    EXPECT_FALSE(std::isinf(hit_at(shape, {{0.25, 0.125, 1e300}, {0, 0, -1e-300}}, 0, kInf))) << name;
  };
  none(Plane(shape::Plane{{0, 0, 0}, {0, 0, 1}}), "plane");
  none(Sphere(shape::Sphere{1, {0, 0, 0}}), "sphere");
  none(Disc(shape::Disc{1, {0, 0, 0}, {0, 0, 1}}), "disc");
  none(Cylinder(shape::Cylinder{1, {0, 0, -1}, {0, 0, 1}}), "cylinder");
  none(Cone(shape::Cone{1, {0, 0, -1}, 0, {0, 0, 1}}), "cone");
  none(Triangle(shape::Triangle{{{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}}}), "triangle");
  none(Polygon(shape::Polygon{{{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}}}), "polygon");
}

TEST(ShapesSphere, EnteringIsDecidedByThePointAtTheLowerLimit) {
  const Sphere sphere(shape::Sphere{1, {0, 0, 0}});
  const Ray through{{0, 0, 4}, {0, 0, -2}};
  EXPECT_TRUE(sphere.entering(through, 0.5, {}));
  EXPECT_FALSE(sphere.entering(through, 1.5, {})) << "on the sphere is not strictly outside";
  EXPECT_FALSE(sphere.entering(through, 2, {}));
  EXPECT_TRUE(sphere.entering(through, 2.6, {}));
}

TEST(ShapesSphere, KnowinglyNonUnitDirectionsUseTheFormulaAsWritten) {
  const Sphere sphere(shape::Sphere{1, {0, 0, 0}});
  // b = 4 * 1.1, disc = b^2 - 16 + 1: the root is not where the sphere is.
  const double b = 4 * 1.1, expected = b - std::sqrt(b * b - 15);
  Ray ray{{0, 0, 4}, {0, 0, -1.1}, 0, false};
  EXPECT_DOUBLE_EQ(hit_at(sphere, ray), expected);
  const SurfacePoint surface = sphere.surface_point(ray, {expected});
  expect_near(surface.point, {0, 0, 4 - 1.1 * expected});
  expect_near(surface.normal, {0, 0, 4 - 1.1 * expected});
  EXPECT_DOUBLE_EQ(hit_at(sphere, {ray.origin, ray.direction}), 3 / 1.1) << "all other rays";
  // The formula would find the sphere, but the bounds are passed by.
  ray = {{1.5, 0, 4}, {0, 0, -1.2}, 0, false};
  const double b2 = 4 * 1.2;
  ASSERT_GT(b2 * b2 - (2.25 + 16) + 1, 0);
  EXPECT_FALSE(hits(sphere, ray));
  // They are grown by twice 1e-5, and closed for parallel rays; an origin inside needs no test.
  ray.origin.x = 1 + 1.9e-5;
  EXPECT_TRUE(hits(sphere, ray));
  ray.origin.x = 1 + 2.1e-5;
  EXPECT_FALSE(hits(sphere, ray));
  EXPECT_TRUE(hits(sphere, {{0.5, 0.5, 0}, {0, 0, -1.2}, 0, false}));
}

TEST(ShapesSphere, SurfaceCoordinates) {
  const Sphere sphere(shape::Sphere{2, {1, 1, 1}});
  const auto at = [&](const Vec3& e) { return sphere.texture_coordinates(Vec3{1, 1, 1} + 2 * e, e, {}); };
  EXPECT_EQ(at({1, 0, 0}).u, 1) << "the seam";
  EXPECT_NEAR(at({0, 1, 0}).u, 0.25, 1e-15);
  EXPECT_NEAR(at({-1, 0, 0}).u, 0.5, 1e-15);
  EXPECT_NEAR(at({0, -1, 0}).u, 0.75, 1e-15);
  EXPECT_NEAR(at({0, 1, 0}).v, 0.5, 1e-15);
  EXPECT_EQ(at({0, 0, 1}).v, 1);
  EXPECT_EQ(at({0, 0, 1}).u, 0);
  EXPECT_EQ(at({0, 0, -1}).v, 0);
  EXPECT_EQ(at({0, 0, -1}).u, 0);
  const TextureCoordinates here = at(normalize({1, 2, 3}));
  expect_near(here.du, normalize({-2, 1, 0}));
  expect_near(here.dv, normalize(cross(normalize({1, 2, 3}), here.du)));
  // Also for points off the surface.
  const TextureCoordinates outside = sphere.texture_coordinates(Vec3{1, 1, 1} + Vec3{10, 20, 30}, {}, {});
  EXPECT_NEAR(outside.u, here.u, 1e-15);
  EXPECT_NEAR(outside.v, here.v, 1e-15);
}

TEST(ShapesBox, NormalsNearEdgesGoByPriority) {
  const Box box(shape::Box{{-1, -1, -1}, {1, 1, 1}});
  const auto normal_at = [&](const Vec3& target, const Vec3& direction) {
    const Ray ray{target - 3 * direction, direction};
    ShapeHit hit;
    EXPECT_TRUE(box.intersect(ray, 0, kFar, hit));
    return box.surface_point(ray, hit).normal;
  };
  const Vec3 down{0, 0, -1}, up{0, 0, 1};
  EXPECT_EQ(normal_at({0, 0, 1}, down), (Vec3{0, 0, 1}));
  EXPECT_EQ(normal_at({1 - 0.9e-5, 0, 1}, down), (Vec3{1, 0, 0}));
  EXPECT_EQ(normal_at({1 - 1.1e-5, 0, 1}, down), (Vec3{0, 0, 1}));
  EXPECT_EQ(normal_at({-1 + 0.9e-5, 1 - 0.9e-5, -1}, up), (Vec3{-1, 0, 0})) << "x before y before z";
  EXPECT_EQ(normal_at({0, -1 + 0.9e-5, -1}, up), (Vec3{0, -1, 0}));
  EXPECT_EQ(normal_at({0, 0, -1}, up), (Vec3{0, 0, -1}));
  // The tolerance is that of the box's size: the middle of a small box's face is no edge.
  const Box small(shape::Box{{0, 0, 0}, {3e-5, 3e-5, 3e-5}});
  const Ray ray{{1.5e-5, 1.5e-5, 1}, down};
  ShapeHit hit;
  ASSERT_TRUE(small.intersect(ray, 0, kFar, hit));
  EXPECT_EQ(small.surface_point(ray, hit).normal, (Vec3{0, 0, 1}));
}

TEST(ShapesBox, ParallelSlabsAreClosedForZerosOfEitherSign) {
  const Box box(shape::Box{{-1, -1, -1}, {1, 1, 1}});
  for (const double zero : {0.0, -0.0}) {
    EXPECT_EQ(hit_at(box, {{1, 1, 3}, {zero, -zero, -1}}), 2);
    EXPECT_EQ(hit_at(box, {{-1, 1, -3}, {zero, zero, 1}}), 2);
    EXPECT_FALSE(hits(box, {{std::nextafter(1.0, 2), 0, 3}, {zero, zero, -1}}));
    EXPECT_FALSE(hits(box, {{0, std::nextafter(-1.0, -2), 3}, {zero, zero, -1}}));
    EXPECT_EQ(hit_at(box, {{1, 0, 0}, {zero, 0.5, 0}}), 2) << "from within, along a face";
  }
  const auto enters = [&](double lo) {
    const Ray down{{0, 0, 3}, {0, 0, -1}};
    ShapeHit hit;
    EXPECT_TRUE(box.intersect(down, lo, kFar, hit));
    return box.entering(down, lo, hit);
  };
  EXPECT_TRUE(enters(0));
  EXPECT_FALSE(enters(2)) << "the boundary belongs to the closed box";
  EXPECT_TRUE(enters(1.999));
}

TEST(ShapesDisc, RimBelongsToTheDisc) {
  const Disc disc(shape::Disc{1, {2, 0, 0}, {0, 0, 5}});
  EXPECT_TRUE(hits(disc, {{3, 0, 1}, {0, 0, -1}}));
  EXPECT_FALSE(hits(disc, {{std::nextafter(3.0, 4), 0, 1}, {0, 0, -1}}));
  EXPECT_FALSE(disc.entering({{2, 0, -1}, {0, 0, 1}}, 0, {}));
  EXPECT_TRUE(disc.entering({{2, 0, 1}, {0, 0, -1}}, 0, {}));
}

TEST(ShapesDisc, SurfaceCoordinatesAreFromAbsolutePositions) {
  const Disc disc(shape::Disc{2, {0, 0, 1}, {0, 0, 1}});
  const Vec3 up{0, 0, 1};
  const TextureCoordinates quarter = disc.texture_coordinates({0, 1, 1}, up, {});
  EXPECT_NEAR(quarter.u, 0.25, 1e-15);
  EXPECT_NEAR(quarter.v, 0.5, 1e-15);
  expect_near(quarter.dv, {0, 1, 0});
  expect_near(quarter.du, cross(Vec3{0, 1, 0}, up));
  EXPECT_NEAR(disc.texture_coordinates({0, -1, 1}, up, {}).u, 0.75, 1e-15);
  // Not at the centre, and there no tangents either.
  const TextureCoordinates center = disc.texture_coordinates({1e-3, 0, 1}, up, {});
  EXPECT_EQ(center.u, 0);
  EXPECT_EQ(center.v, 0);
  EXPECT_EQ(center.du, (Vec3{1, 0, 0}));
  // A disc elsewhere: x itself over the distance from the centre; beyond 1 it is 0.5, without mirroring.
  const Disc moved(shape::Disc{1, {5, -3, 0}, {0, 0, 1}});
  EXPECT_EQ(moved.texture_coordinates({5.5, -3, 0}, up, {}).u, 0.5);
  EXPECT_NEAR(moved.texture_coordinates({5.5, -3, 0}, up, {}).v, 0.5, 1e-15);
}

TEST(ShapesDisc, SmallDiscsKeepTheirSurfaceCoordinates) {
  const Disc disc(shape::Disc{1e-6, {0, 0, 0}, {0, 0, 1}});
  const TextureCoordinates at = disc.texture_coordinates({0, -5e-7, 0}, {0, 0, 1}, {});
  EXPECT_NEAR(at.u, 0.75, 1e-15);
  EXPECT_NEAR(at.v, 0.5, 1e-15);
}

TEST(ShapesTriangle, WeightsBelongToTheirVertices) {
  const Vec3 p[3] = {{1, 0, 0}, {4, 1, 2}, {0, 3, 1}};
  const Triangle triangle(shape::Triangle{{p[0], p[1], p[2]}});
  const Vec3 target = 0.5 * p[0] + 0.3 * p[1] + 0.2 * p[2];
  for (const Vec3 direction : {Vec3{1, 2, 3}, Vec3{3, -2, 1}, Vec3{-1, 5, 0.5}}) {
    const Ray ray{target - 2 * direction, direction};
    ShapeHit hit;
    ASSERT_TRUE(triangle.intersect(ray, 0, kFar, hit));
    EXPECT_NEAR(hit.t, 2, 1e-14);
    EXPECT_NEAR(hit.a, 0.3, 1e-14);
    EXPECT_NEAR(hit.b, 0.2, 1e-14);
    expect_near(triangle.surface_point(ray, hit).point, target);
  }
}

TEST(ShapesTriangle, DefaultSurfaceCoordinates) {
  const Vec3 p[3] = {{0, 0, 0}, {2, 0, 0}, {0, 0, 2}};  // normal -y: its dominant component is negative
  const Triangle triangle(shape::Triangle{{p[0], p[1], p[2]}});
  ShapeHit hit;
  hit.a = 0.3;
  hit.b = 0.2;
  const Vec3 elsewhere{5, 1, 7};
  const TextureCoordinates at = triangle.texture_coordinates(elsewhere, {0, -1, 0}, hit);
  EXPECT_DOUBLE_EQ(at.v, 0.2);
  EXPECT_DOUBLE_EQ(at.u, 0.3 / 0.8);
  expect_near(at.du, {-1, 0, 0});
  expect_near(at.dv, normalize(p[0] - elsewhere));
  hit.a = 0.5e-5;
  hit.b = 1 - 0.9e-5;
  EXPECT_EQ(triangle.texture_coordinates(elsewhere, {0, -1, 0}, hit).u, 0);
  hit.a = 0;
  hit.b = 1;
  EXPECT_EQ(triangle.texture_coordinates(elsewhere, {0, -1, 0}, hit).v, 1);
}

TEST(ShapesTriangle, NormalsFlipAndFollowTheFirstVertexNormal) {
  const shape::SmoothTriangle upward{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 3}, {1, 0, 1}, {0, 0, -1}}};
  shape::SmoothTriangle against = upward;
  against.n[0] = {0.1, 0, -1};
  const Ray ray{{0.25, 0.25, 1}, {0, 0, -1}};
  ShapeHit hit;
  const auto normals = [&](const SmoothTriangle& t) {
    EXPECT_TRUE(t.intersect(ray, 0, kFar, hit));
    return t.surface_point(ray, hit);
  };
  const Vec3 up{0, 0, 1};
  const SmoothTriangle plain(upward);
  EXPECT_EQ(normals(plain).geometric_normal, up);
  EXPECT_TRUE(normals(plain).smooth);
  const Vec3 expected = normalize(0.5 * up + 0.25 * normalize({1, 0, 1}) + 0.25 * Vec3{0, 0, -1});
  expect_near(normals(plain).normal, expected);
  EXPECT_TRUE(plain.entering(ray, 0, hit));

  const SmoothTriangle trusted(against);
  EXPECT_EQ(normals(trusted).geometric_normal, -up) << "the first vertex normal is trusted";
  EXPECT_FALSE(trusted.entering(ray, 0, hit));

  const SmoothTriangle flipped(upward, true);
  EXPECT_EQ(normals(flipped).geometric_normal, -up);
  expect_near(normals(flipped).normal, -expected);
  const SmoothTriangle unchecked(against, true);
  EXPECT_EQ(normals(unchecked).geometric_normal, -up) << "-f skips the test";
  EXPECT_GT(normals(unchecked).normal.z, 0);

  const Triangle flat(shape::Triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, true);
  ASSERT_TRUE(flat.intersect(ray, 0, kFar, hit));
  EXPECT_EQ(flat.surface_point(ray, hit).normal, -up);
  EXPECT_FALSE(flat.surface_point(ray, hit).smooth);
  EXPECT_FALSE(flat.entering(ray, 0, hit));
}

TEST(ShapesTriangle, TangentsFollowTheGivenSurfaceCoordinates) {
  // Along du v is constant and u grows, along dv the other way round, whatever the order of the vertices.
  std::mt19937_64 engine(11);
  std::printf("seed 11\n");
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&] { return Vec3{uniform(engine), uniform(engine), uniform(engine)}; };
  for (int i = 0; i < 200; ++i) {
    shape::UvTriangle t{{vector(), vector(), vector()}, {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}, {}, {}};
    for (int k = 0; k < 3; ++k) t.u[k] = uniform(engine), t.v[k] = uniform(engine);
    const Vec3 e2 = t.p[1] - t.p[0], e3 = t.p[2] - t.p[0], n = cross(e2, e3);
    // Gradients of u and v in the plane of the triangle.
    const auto gradient = [&](const double(&w)[3]) {
      return ((w[1] - w[0]) * cross(e3, n) + (w[2] - w[0]) * cross(n, e2)) / dot(n, n);
    };
    const Vec3 gu = gradient(t.u), gv = gradient(t.v);
    const TextureCoordinates at = UvTriangle(t).texture_coordinates({}, {}, {});
    const double small = 1e-9 * (length(gu) + length(gv));
    EXPECT_NEAR(length(at.du), 1, 1e-12);
    EXPECT_NEAR(length(at.dv), 1, 1e-12);
    EXPECT_NEAR(dot(at.du, gv), 0, small);
    EXPECT_NEAR(dot(at.dv, gu), 0, small);
    EXPECT_GT(dot(at.du, gu), 0);
    EXPECT_GT(dot(at.dv, gv), 0);
  }
  const shape::UvTriangle flat{
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}, {.5, .5, .5}, {0, 0, 1}};
  EXPECT_EQ(UvTriangle(flat).texture_coordinates({}, {}, {}).dv, (Vec3{0, 0, 0})) << "u does not vary";
}

/// Bounds cull by where the triangle is, so no hit may be said to be elsewhere: not of slivers, whose normal
/// is mostly rounding, and not edge-on, where the plane is met anywhere.
TEST(ShapesTriangle, HitsAreWithinTheBoxHoweverThinOrEdgeOn) {
  std::mt19937_64 engine(30070);
  const auto uniform = [&](double lo, double hi) {
    return lo + (hi - lo) * (static_cast<double>(engine() >> 11) * 0x1p-53);
  };
  int hits = 0, far_off = 0;
  for (int i = 0; i < 200'000; ++i) {
    shape::Triangle corners;
    const double share = uniform(-1, 1), width = std::pow(10, uniform(-13, 2));
    for (int axis = 0; axis < 3; ++axis) {
      corners.p[0][axis] = uniform(-1000, 1000);
      corners.p[1][axis] = corners.p[0][axis] + uniform(-300, 300);
      corners.p[2][axis] =
          corners.p[0][axis] + share * (corners.p[1][axis] - corners.p[0][axis]) + uniform(-1, 1) * width;
    }
    const Triangle triangle(corners);
    // Through a point of it, often a corner, along something near an edge or an axis.
    const double u = engine() % 3 == 0 ? uniform(0, 1) : 0, v = engine() % 3 == 0 ? uniform(0, 1 - u) : 0;
    const Vec3 e1 = corners.p[1] - corners.p[0], e2 = corners.p[2] - corners.p[0];
    const Vec3 target = corners.p[0] + (u * e1 + v * e2);
    Vec3 d = e1 + std::pow(10, uniform(-6, 1)) * Vec3{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    if (engine() % 3 == 0) {
      d = {};
      d[static_cast<int>(engine() % 3)] = 1;
    }
    d = normalize(d);
    const Ray ray{target - uniform(0, 2000) * d, d};
    const double t = hit_at(triangle, ray, -kFar);
    if (std::isnan(t)) continue;
    ++hits;
    const Vec3 at = ray.at(t);
    const Bounds3 box = grown(triangle.bounds(), 1e-12 * 4000);
    ASSERT_TRUE(box.contains(at)) << i << ": " << t;
    // What the plane alone says.
    const Vec3 n = cross(corners.p[1] - corners.p[0], corners.p[2] - corners.p[1]);
    far_off += !grown(box, 1e-6).contains(ray.at(dot(n, corners.p[0] - ray.origin) / dot(n, d)));
  }
  EXPECT_GT(hits, 10'000);
  EXPECT_GT(far_off, 50) << "no case was hard";
}

TEST(ShapesPolygon, NonZeroWinding) {
  const auto inside = [](const Polygon& polygon, double x, double y) {
    return hits(polygon, {{x, y, 1}, {0, 0, -1}});
  };
  shape::Polygon star;
  for (int i = 0; i < 5; ++i) {
    const double angle = 2 * fn::kPi * (2 * i % 5) / 5;
    star.points.push_back({fn::cos(angle), fn::sin(angle), 0});
  }
  const Polygon pentagram(star);
  EXPECT_TRUE(inside(pentagram, 0.01, 0.02)) << "the centre is filled";
  EXPECT_TRUE(inside(pentagram, 0.9, 0.01)) << "a point";
  EXPECT_FALSE(inside(pentagram, -0.7, 0.01)) << "between two points";

  const std::vector<Vec3> outline{{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}, {-2, -2, 0}};
  shape::Polygon against{outline}, along{outline};
  for (const Vec3 v : {Vec3{-1, -1, 0}, Vec3{-1, 1, 0}, Vec3{1, 1, 0}, Vec3{1, -1, 0}, Vec3{-1, -1, 0}}) {
    against.points.push_back(v);
  }
  for (const Vec3 v : {Vec3{-1, -1, 0}, Vec3{1, -1, 0}, Vec3{1, 1, 0}, Vec3{-1, 1, 0}, Vec3{-1, -1, 0}}) {
    along.points.push_back(v);
  }
  EXPECT_FALSE(inside(Polygon(against), 0.1, 0.2)) << "a hole wound the other way";
  EXPECT_TRUE(inside(Polygon(against), 1.5, 0.2));
  EXPECT_TRUE(inside(Polygon(along), 0.1, 0.2)) << "a hole wound the same way stays filled";

  const Polygon concave(shape::Polygon{{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 1, 0}, {0, 4, 0}}});
  EXPECT_TRUE(inside(concave, 0.5, 2));
  EXPECT_TRUE(inside(concave, 3.5, 2));
  EXPECT_FALSE(inside(concave, 2, 2));
}

TEST(ShapesPolygon, SharedEdgesNeitherGapNorOverlap) {
  // Four squares of a grid, the test points on its lines and corners: each belongs to exactly one.
  const auto square = [](double x, double y) {
    return Polygon(shape::Polygon{{{x, y, 0}, {x + 1, y, 0}, {x + 1, y + 1, 0}, {x, y + 1, 0}}});
  };
  const Polygon squares[] = {square(-1, -1), square(0, -1), square(-1, 0), square(0, 0)};
  for (const Vec3 at :
       {Vec3{0, 0, 1}, Vec3{0, 0.5, 1}, Vec3{0.5, 0, 1}, Vec3{-0.5, 0, 1}, Vec3{0, -0.5, 1}}) {
    int count = 0;
    for (const Polygon& polygon : squares) count += hits(polygon, {at, {0, 0, -1}});
    EXPECT_EQ(count, 1) << at.x << ' ' << at.y;
  }
  // Right and above are closed: of an isolated square the edges on the right and at the top belong to it.
  EXPECT_TRUE(hits(square(0, 0), {{1, 0.5, 1}, {0, 0, -1}}));
  EXPECT_TRUE(hits(square(0, 0), {{0.5, 1, 1}, {0, 0, -1}}));
  EXPECT_FALSE(hits(square(0, 0), {{0, 0.5, 1}, {0, 0, -1}}));
  EXPECT_FALSE(hits(square(0, 0), {{0.5, 0, 1}, {0, 0, -1}}));
}

TEST(ShapesPolygon, OffPlaneVerticesAreProjected) {
  const shape::Polygon bent{{{0, 0, 0}, {2, 0, 0.3}, {2, 2, 0}, {0, 2, 0.3}}};
  const Polygon polygon(bent);
  // Newell's normal of this saddle is exactly +z; the plane goes through the first vertex.
  const Ray ray{{1, 1, 1}, {0, 0, -1}};
  ShapeHit hit;
  ASSERT_TRUE(polygon.intersect(ray, 0, kFar, hit));
  EXPECT_NEAR(hit.t, 1, 1e-15);
  expect_near(polygon.surface_point(ray, hit).normal, {0, 0, 1});
  EXPECT_TRUE(polygon.entering(ray, 0, hit));
  EXPECT_FALSE(Polygon(bent, true).entering(ray, 0, hit));
  // A vertex off the plane does not take the surface out of the bounds.
  const Polygon raised(shape::Polygon{{{0, 0, 1}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}});
  for (const Vec3 at : {Vec3{1.9, 1.9, 9}, Vec3{0.1, 1.9, 9}, Vec3{1.9, 0.1, 9}}) {
    const Ray down{at, {0, 0, -1}};
    ASSERT_TRUE(raised.intersect(down, 0, kFar, hit));
    EXPECT_TRUE(raised.bounds().contains(raised.surface_point(down, hit).point));
  }
  EXPECT_EQ(raised.texture_coordinates({7, 8, 9}, {}, {}).u, 7);
  EXPECT_EQ(raised.texture_coordinates({7, 8, 9}, {}, {}).v, 8);
}

TEST(ShapesPolygon, ManyVertices) {
  shape::Polygon circle;
  constexpr int kCount = 5000;
  for (int i = 0; i < kCount; ++i) {
    const double angle = 2 * fn::kPi * i / kCount;
    circle.points.push_back({1e3 + fn::cos(angle), 5, 2e3 + fn::sin(angle)});
  }
  const Polygon polygon(circle);
  for (int i = 0; i < 360; ++i) {
    const double angle = 0.0174 * i;
    const Vec3 out{fn::cos(angle), 0, fn::sin(angle)};
    const Vec3 base{1e3, 0, 2e3};
    EXPECT_TRUE(hits(polygon, {base + 0.9999 * out, {0, 1, 0}}));
    EXPECT_FALSE(hits(polygon, {base + 1.0001 * out, {0, 1, 0}}));
  }
}

TEST(ShapesPlane, TangentsNearTheSwitchOfAxes) {
  const Plane plane(shape::Plane{{0, 0, 0}, {0, 0, 1}});
  const TextureCoordinates up = plane.texture_coordinates({3, 5, 0}, {0, 0, 1}, {});
  expect_near(up.du, {1, 0, 0});
  expect_near(up.dv, {0, 1, 0});
  EXPECT_DOUBLE_EQ(up.u, 3);
  EXPECT_DOUBLE_EQ(up.v, 5);
  const TextureCoordinates below = plane.texture_coordinates({3, 5, 0}, {0, 0, -1}, {});
  EXPECT_DOUBLE_EQ(below.u, -3) << "mirrored from behind";
  EXPECT_DOUBLE_EQ(below.v, 5);
  EXPECT_TRUE(plane.bounds().unbounded());
}

}  // namespace
}  // namespace rayshade
