// SPDX-License-Identifier: MIT
// Every primitive against its twin in 113 bits, on rays that are ordinary and rays that hurt: far origins,
// grazing, from inside, from the surface, along the axes with zeros of either sign; at sizes from 1e-6 to 1e6
// and directions of any length.
//
// Errors are measured in units of kRoundoff S, with S the size of the numbers at hand (distance of origin and
// hit from the shape, extent of the shape): times the cosine at the hit, this is the error of t over its
// condition number. Close to tangency, where the condition number has no bound, the cosine is taken as
// sqrt(kRoundoff S / curvature radius): a perturbation of the ray by kRoundoff S moves a tangential hit by
// that much.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include "rayshade/geometry/shapes/box.h"
#include "rayshade/geometry/shapes/cone.h"
#include "rayshade/geometry/shapes/cylinder.h"
#include "rayshade/geometry/shapes/disc.h"
#include "rayshade/geometry/shapes/plane.h"
#include "rayshade/geometry/shapes/polygon.h"
#include "rayshade/geometry/shapes/rounding.h"
#include "rayshade/geometry/shapes/sphere.h"
#include "rayshade/geometry/shapes/triangle.h"
#include "shapes_quad.h"

namespace rayshade {
namespace {

using quad::Q;
using quad::V;

constexpr std::uint64_t kSeed = 20240607;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double a, double b) {
    return a + (b - a) * std::uniform_real_distribution<double>(0, 1)(engine_);
  }
  int below(int n) { return static_cast<int>(std::uniform_int_distribution<int>(0, n - 1)(engine_)); }
  bool coin() { return below(2) == 0; }
  Vec3 cube(double half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
  Vec3 unit() {
    for (;;) {
      const Vec3 v = cube(1);
      const double s = length_squared(v);
      if (s > 0.01 && s < 1) return normalize(v);
    }
  }
  double signed_zero() { return coin() ? 0.0 : -0.0; }

 private:
  std::mt19937_64 engine_;
};

enum Family { kNear, kFarAway, kInside, kOnSurface, kGrazing, kAxisParallel, kFamilies };
constexpr const char* kFamilyNames[] = {"near", "far", "inside", "on surface", "grazing", "axis-parallel"};

struct Placed {
  Vec3 center;
  double size = 1;  ///< radius of a ball that holds the shape, or its part of interest
  double conditioning =
      1;  ///< of the shape itself: how much its own numbers magnify roundings (thin triangles)
};

struct Tally {
  int rays = 0, hits = 0, misses = 0, undecided = 0;
  double residual = 0, forward = 0;  ///< maxima in units of kRoundoff S
  double of_bound = 0;               ///< of (true distance of surface_point) / error
  double bound = 0;  ///< maximum of error in units of kRoundoff (S + |coordinates|), S without the origin
  double normal =
      0;  ///< maximum of the error of the normal, over kRoundoff (1 + S / (curvature radius * cosine))
};

/// Bounds that a shape must keep, in the units of Tally: what 15,000 rays of each family reached, and a
/// little more.
struct Limits {
  double residual, forward, normal, bound;
};

Ray make_ray(Random& random, Family family, const Placed& placed, const auto& reference, double& lo) {
  const double size = placed.size;
  Vec3 target = placed.center + random.cube(0.7 * size);
  Vec3 origin = placed.center + random.uniform(1.5, 5) * size * random.unit();
  lo = 0;
  const auto surface_sample = [&](V& p, V& n) {
    for (int attempt = 0; attempt < 50; ++attempt) {
      const Vec3 to = placed.center + random.cube(0.6 * size);
      const Ray probe{placed.center + 3 * size * random.unit(), {}};
      const quad::Line line(Ray{probe.origin, to - probe.origin});
      for (const quad::Crossing& c : reference.crossings(line).all) {
        if (!(c.inside > 0) || random.coin()) continue;
        p = line.at(c.t);
        n = reference.normal(p);
        return true;
      }
    }
    return false;
  };
  switch (family) {
    case kFarAway:
      origin = placed.center + 1e6 * size * random.unit();
      break;
    case kInside:
      origin = placed.center + random.cube(0.4 * size);
      break;
    case kOnSurface: {
      V p, n;
      if (surface_sample(p, n)) origin = quad::rounded(p);
      target = origin + size * random.unit();
      lo = 1e-4 * size;
      break;
    }
    case kGrazing: {
      V p, n;
      if (surface_sample(p, n)) {
        const V any = random.unit();
        const V tangent = quad::unit(any - quad::dot(any, n) * n);
        const double slope = std::pow(10.0, -random.uniform(1, 12)) * (random.coin() ? 1 : -1);
        const double offset = std::pow(10.0, -random.uniform(3, 14)) * (random.coin() ? 1 : -1);
        const V through = p + Q(offset * size) * n;
        const V direction = tangent + Q(slope) * n;
        const double away = random.coin() ? 2 : 1e4;
        origin = quad::rounded(through - Q(away * size) * direction);
        target = quad::rounded(through);
      }
      break;
    }
    case kAxisParallel: {
      const int axis = random.below(3);
      Vec3 d{random.signed_zero(), random.signed_zero(), random.signed_zero()};
      d[axis] = random.coin() ? 1 : -1;
      Vec3 through = target;
      for (int i = 0; i < 3; ++i) {
        if (random.below(4) == 0) through[i] = placed.center[i];
      }
      origin = through;
      origin[axis] -= 3 * size * d[axis];
      return {origin, std::pow(10.0, random.below(7) - 3) * d};
    }
    default:
      break;
  }
  return {origin, std::pow(10.0, random.uniform(-3, 3)) / length(target - origin) * (target - origin)};
}

template <class Shape, class Reference>
void compare(const Shape& shape, const Reference& reference, const Placed& placed, Random& random,
             Family family, Tally& tally) {
  double lo = 0;
  const Ray ray = make_ray(random, family, placed, reference, lo);
  const double speed = length(ray.direction);
  lo /= speed;
  const quad::Line line(ray);
  const quad::Crossings crossings = reference.crossings(line);
  ++tally.rays;

  const double base = length(ray.origin - placed.center) + placed.size;
  const auto sizes = [&](const Q& t) {
    return placed.conditioning * (base + std::fabs(static_cast<double>(t)) * speed);
  };
  const auto effective_cosine = [&](const quad::Crossing& c) {
    const double floor =
        c.curvature > 0 ? std::sqrt(kRoundoff * sizes(c.t) / static_cast<double>(c.curvature)) : 0;
    return std::clamp(static_cast<double>(c.cosine), std::min(floor, 1.0), 1.0);
  };

  // The expected answer, and whether rounding may change it.
  const quad::Crossing* expected = nullptr;
  bool decided = crossings.from_tangency > 100 * kRoundoff * placed.conditioning * base;
  for (const quad::Crossing& c : crossings.all) {
    const double reach = 100 * kRoundoff * sizes(c.t) / effective_cosine(c);
    if (abs(c.inside) < reach || abs(c.t - lo) * speed < reach) decided = false;
    if (!expected && c.inside >= 0 && c.t >= lo) expected = &c;
  }

  ShapeHit hit;
  const bool found = shape.intersect(ray, lo, 1e300, hit);
  const auto tell = [&] {
    char text[400];
    std::snprintf(text, sizeof text, "%s ray: origin %a %a %a direction %a %a %a lo %g", kFamilyNames[family],
                  ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z,
                  lo);
    return std::string(text);
  };
  if (found) {
    ASSERT_TRUE(std::isfinite(hit.t)) << tell();
    ASSERT_GE(hit.t, lo) << tell();
    const double s = sizes(hit.t);
    const V p = line.at(hit.t);
    tally.residual =
        std::max(tally.residual, std::fabs(static_cast<double>(reference.height(p))) / (kRoundoff * s));
    const SurfacePoint surface = shape.surface_point(ray, hit);
    const double off = std::fabs(static_cast<double>(reference.height(surface.point)));
    ASSERT_LE(off, surface.error) << tell();
    tally.of_bound = std::max(tally.of_bound, surface.error > 0 ? off / surface.error : 0);
  }
  if (!decided) {
    ++tally.undecided;
    return;
  }
  ASSERT_EQ(found, expected != nullptr) << tell();
  if (!found) {
    ++tally.misses;
    return;
  }
  ++tally.hits;
  const double s = sizes(expected->t);
  const double cosine = effective_cosine(*expected);
  const double error = static_cast<double>(abs(hit.t - expected->t)) * speed;
  tally.forward = std::max(tally.forward, error * cosine / (kRoundoff * s));
  const V exact_normal = reference.normal(line.at(expected->t));
  if (expected->inside < 1e-4 * placed.size) return;  // the normals of a box change near its edges
  const SurfacePoint surface = shape.surface_point(ray, hit);
  tally.bound = std::max(
      tally.bound,
      surface.error /
          (kRoundoff * (placed.conditioning * std::max(placed.size, length(surface.point - placed.center)) +
                        length(surface.point))));
  const double turn = static_cast<double>(quad::length(V(surface.normal) - exact_normal));
  const double bend = expected->turning > 0 ? s / (static_cast<double>(expected->turning) * cosine) : 0;
  tally.normal = std::max(tally.normal, turn / (kRoundoff * (placed.conditioning + bend)));
}

/// `make(random, scale, placed)` returns a pair of shape and reference.
template <class Make>
void run(const char* name, const Limits& limits, const Make& make) {
  Random random(kSeed);
  std::printf("%s, seed %llu\n", name, static_cast<unsigned long long>(kSeed));
  Tally total;
  for (int family = 0; family < kFamilies; ++family) {
    Tally tally;
    for (int i = 0; i < 60; ++i) {
      Placed placed;
      const double scale = i % 3 == 0 ? 1 : i % 3 == 1 ? 1e-6 : 1e6;
      const auto [shape, reference] = make(random, scale, placed);
      for (int j = 0; j < 5; ++j)
        compare(shape, reference, placed, random, static_cast<Family>(family), tally);
      if (testing::Test::HasFatalFailure()) return;
    }
    std::printf(
        "  %-14s %5d rays %5d hits %5d misses %5d undecided: residual %6.2f forward %6.2f normal %6.2f"
        "  surface point %.2f of its bound, bound %.1f\n",
        kFamilyNames[family], tally.rays, tally.hits, tally.misses, tally.undecided, tally.residual,
        tally.forward, tally.normal, tally.of_bound, tally.bound);
    EXPECT_LE(tally.residual, limits.residual) << kFamilyNames[family];
    EXPECT_LE(tally.forward, limits.forward) << kFamilyNames[family];
    EXPECT_LE(tally.normal, limits.normal) << kFamilyNames[family];
    EXPECT_LE(tally.bound, limits.bound) << kFamilyNames[family];
    if (family == kNear || family == kFarAway) {
      EXPECT_GT(tally.hits, tally.rays / 15);
      EXPECT_LT(tally.undecided, tally.rays / 100);
    }
    total.hits += tally.hits;
  }
  EXPECT_GT(total.hits, 200);
}

TEST(ShapesAccuracy, Sphere) {
  run("sphere", {2.5, 2.5, 14, 5}, [](Random& random, double scale, Placed& placed) {
    const shape::Sphere sphere{scale * random.uniform(0.2, 1), scale * random.cube(10)};
    placed = {sphere.center, sphere.radius};
    return std::pair{Sphere(sphere), quad::Sphere(sphere)};
  });
}

TEST(ShapesAccuracy, Plane) {
  run("plane", {2, 2, 2.5, 15}, [](Random& random, double scale, Placed& placed) {
    const shape::Plane plane{scale * random.cube(10), std::pow(10.0, random.uniform(-6, 6)) * random.unit()};
    placed = {plane.point, scale};
    return std::pair{Plane(plane), quad::Plane(plane)};
  });
}

TEST(ShapesAccuracy, Disc) {
  run("disc", {2, 2, 2, 8}, [](Random& random, double scale, Placed& placed) {
    const shape::Disc disc{scale * random.uniform(0.5, 1), scale * random.cube(10), random.unit()};
    placed = {disc.center, disc.radius};
    return std::pair{Disc(disc), quad::Disc(disc)};
  });
}

TEST(ShapesAccuracy, Box) {
  run("box", {1, 1, 0, 0}, [](Random& random, double scale, Placed& placed) {
    const Vec3 lo = scale * random.cube(10);
    const Vec3 extent = scale * Vec3{random.uniform(0.2, 1), random.uniform(0.2, 1), random.uniform(0.2, 1)};
    const shape::Box box{lo, lo + extent};
    placed = {0.5 * (box.lo + box.hi), 0.5 * length(extent)};
    return std::pair{Box(box), quad::Box(box)};
  });
}

Vec3 axis_of(Random& random) {
  switch (random.below(4)) {
    case 0:
      return {0, 0, random.coin() ? 1.0 : -1.0};
    case 1: {  // close to a pole
      const double tilt = std::pow(10.0, -random.uniform(2, 12));
      return normalize(
          {tilt * random.uniform(-1, 1), tilt * random.uniform(-1, 1), random.coin() ? 1.0 : -1.0});
    }
    default:
      return random.unit();
  }
}

TEST(ShapesAccuracy, Cylinder) {
  run("cylinder", {3, 3, 8.5, 46}, [](Random& random, double scale, Placed& placed) {
    const double length = scale * random.uniform(0.5, 1);
    const double aspect = random.below(3) ? 1 : std::pow(10.0, random.uniform(-4, 4));
    const Vec3 bottom = scale * random.cube(10), axis = axis_of(random);
    const shape::Cylinder cylinder{length * aspect, bottom, bottom + length * axis};
    placed = {0.5 * (cylinder.bottom + cylinder.top), std::max(length, cylinder.radius)};
    return std::pair{Cylinder(cylinder), quad::Wall(cylinder)};
  });
}

TEST(ShapesAccuracy, Cone) {
  run("cone", {6, 6, 8, 50}, [](Random& random, double scale, Placed& placed) {
    const double length = scale * random.uniform(0.5, 1);
    const double radius = scale * (random.below(3) ? 1 : std::pow(10.0, random.uniform(-3, 3)));
    double other = 0;
    switch (random.below(4)) {
      case 0:
        other = 0;
        break;
      case 1:
        other = radius * (1 + std::pow(10.0, -random.uniform(4, 10)));
        break;  // almost a cylinder
      case 2:
        other = -radius * random.uniform(0.1, 2);
        break;  // a double cone
      default:
        other = radius * random.uniform(0.1, 1);
    }
    const Vec3 bottom = scale * random.cube(10);
    const shape::Cone cone{radius, bottom, other, bottom + length * axis_of(random)};
    placed = {0.5 * (cone.bottom + cone.top), std::max({length, radius, std::fabs(other)})};
    return std::pair{Cone(cone), quad::Wall(cone)};
  });
}

TEST(ShapesAccuracy, Triangle) {
  run("triangle", {1.5, 1.5, 2, 6}, [](Random& random, double scale, Placed& placed) {
    const Vec3 at = scale * random.cube(10);
    const double thin = random.below(3) ? 1 : std::pow(10.0, -random.uniform(0, 6));
    const Vec3 a = scale * random.unit(), b = scale * random.unit();
    const shape::Triangle triangle{{at, at + a, at + a * random.uniform(0.1, 0.9) + thin * b}};
    const Vec3 e1 = triangle.p[1] - triangle.p[0], e2 = triangle.p[2] - triangle.p[1];
    placed = {(triangle.p[0] + triangle.p[1] + triangle.p[2]) / 3, scale,
              length(e1) * length(e2) / length(cross(e1, e2))};
    return std::pair{Triangle(triangle), quad::Polygon({triangle.p[0], triangle.p[1], triangle.p[2]})};
  });
}

TEST(ShapesAccuracy, Polygon) {
  run("polygon", {2.5, 2.5, 3.5, 130}, [](Random& random, double scale, Placed& placed) {
    const Vec3 at = scale * random.cube(10), n = random.unit();
    Vec3 e1, e2;
    coordinate_system(n, e1, e2);
    const int count = 3 + random.below(20);
    shape::Polygon polygon;
    for (int i = 0; i < count; ++i) {  // a star, not convex
      const double angle = 2 * M_PI * i / count, radius = scale * random.uniform(0.3, 1);
      polygon.points.push_back(at + radius * (std::cos(angle) * e1 + std::sin(angle) * e2));
    }
    placed = {at, scale};
    return std::pair{Polygon(polygon), quad::Polygon(polygon.points)};
  });
}

}  // namespace
}  // namespace rayshade
