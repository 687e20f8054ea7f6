// SPDX-License-Identifier: MIT
// The height field against all of its triangles in quadruple precision; watertightness; the rules of
// objects.md 5.
#include "rayshade/geometry/shapes/height_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <iostream>
#include <sstream>

#include "tests/unit/geometry/quad_reference.h"

namespace rayshade {
namespace {

using reference::Quad;
using reference::QuadVec;
using reference::Random;
using reference::wide;

constexpr double kUlp = 0x1p-52;
constexpr double kInf = Bounds3::kInf;

using Data = std::shared_ptr<const HeightFieldData>;

Data make_data(int n, const std::function<double(double, double)>& altitude) {
  auto out = std::make_shared<HeightFieldData>();
  out->size = n;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      out->altitudes.push_back(static_cast<float>(altitude(i / (n - 1.0), j / (n - 1.0))));
    }
  }
  return out;
}

Data random_data(int n, double height, double holes, Random& random) {
  return make_data(n, [&](double x, double y) {
    if (random.between(0, 1) < holes) return -1000.0;
    return height * (std::sin(5 * x + 1) * std::cos(4 * y) + random.between(-1, 1) * 2 / n) + 0.1;
  });
}

QuadVec cross(const QuadVec& a, const QuadVec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

struct Candidate {
  double t;
  double unit;   ///< what one rounding of the numbers at hand does to t
  bool certain;  ///< not within rounding of an edge of the triangle
  std::uint32_t part;
};

/// Every triangle that the ray meets, or passes within rounding.
std::vector<Candidate> all_triangles(const HeightFieldData& data, const Ray& ray) {
  std::vector<Candidate> out;
  const int n = data.size;
  const Quad step = Quad(1) / (n - 1);
  const QuadVec o = wide(ray.origin), d = wide(ray.direction);
  const double speed = length(ray.direction), width = 1.0 / (n - 1);
  for (int j = 0; j + 1 < n; ++j) {
    for (int i = 0; i + 1 < n; ++i) {
      // Far from the ray's line in x and y: nothing to compute.
      const double away = (ray.origin.x - (i + 0.5) * width) * ray.direction.y -
                          (ray.origin.y - (j + 0.5) * width) * ray.direction.x;
      const double flat = std::sqrt(ray.direction.x * ray.direction.x + ray.direction.y * ray.direction.y);
      if (std::fabs(away) > flat * (width + 1e-6 * length(ray.origin)) + 1e-6 * width * speed) continue;
      const auto vertex = [&](int x, int y) { return QuadVec{x * step, y * step, data.at(x, y)}; };
      for (int upper = 0; upper < 2; ++upper) {
        if (data.at(upper ? i + 1 : i, upper ? j + 1 : j) <= -1000 || data.at(i + 1, j) <= -1000 ||
            data.at(i, j + 1) <= -1000) {
          continue;
        }
        const QuadVec a = upper ? vertex(i + 1, j) : vertex(i, j);
        const QuadVec b = upper ? vertex(i + 1, j + 1) : vertex(i + 1, j);
        const QuadVec c = vertex(i, j + 1);
        const QuadVec normal = cross(b - a, c - a);
        const Quad area = length(normal);
        const Quad sine = dot(normal, d) / (area * speed);
        const Quad height = dot(normal, o - a);
        const Quad t = -height / dot(normal, d);
        const QuadVec p = reference::at(ray, t);
        // Distances from the edges.
        Quad inside = 1e30;
        const QuadVec corner[3] = {a, b, c};
        for (int k = 0; k < 3; ++k) {
          const QuadVec edge = corner[(k + 1) % 3] - corner[k];
          inside = std::min(inside, dot(cross(edge, p - corner[k]), normal) / (area * length(edge)));
        }
        const double size =
            length(ray.origin) + 2 + std::fabs(data.at(i, j)) + std::fabs(static_cast<double>(t)) * speed;
        const double slack = 16 * kUlp * size / std::fabs(static_cast<double>(sine));
        if (inside < -slack) continue;
        out.push_back({static_cast<double>(t), kUlp * size / std::fabs(static_cast<double>(sine) * speed),
                       inside > slack, static_cast<std::uint32_t>(2 * (j * (n - 1) + i) + upper)});
      }
    }
  }
  return out;
}

std::string describe(const HeightFieldData& data, const Ray& ray, double lo) {
  std::ostringstream out;
  out.precision(17);
  out << "size " << data.size << " ray " << ray.origin.x << " " << ray.origin.y << " " << ray.origin.z << "  "
      << ray.direction.x << " " << ray.direction.y << " " << ray.direction.z << " lo " << lo;
  return out.str();
}

struct Tally {
  int rays = 0, hits = 0;
  double worst = 0;
};

void check_ray(const HeightField& field, const Ray& ray, double lo, Tally& tally) {
  const HeightFieldData& data = field.data();
  const std::vector<Candidate> candidates = all_triangles(data, ray);
  ShapeHit hit;
  const bool found = field.intersect(ray, lo, kInf, hit);
  ++tally.rays;
  tally.hits += found;
  const double until = found ? hit.t : kInf;
  const Candidate* same = nullptr;
  for (const Candidate& c : candidates) {
    if (found && c.part == hit.part) same = &c;
    if (c.t <= lo + 16 * c.unit) continue;
    ASSERT_FALSE(c.certain && c.t < until - 32 * c.unit)
        << describe(data, ray, lo) << ": lost t " << c.t << " part " << c.part << ", found " << found << " "
        << hit.t;
  }
  if (!found) return;
  ASSERT_TRUE(same) << describe(data, ray, lo) << ": no hit at " << hit.t << " part " << hit.part;
  const double error = std::fabs(hit.t - same->t) / same->unit;
  ASSERT_LT(error, 32) << describe(data, ray, lo);
  ASSERT_GE(hit.t, lo);
  tally.worst = std::max(tally.worst, error);

  // A function of the ray and lo; closed at hi and at lo.
  ShapeHit again;
  ASSERT_TRUE(field.intersect(ray, lo, hit.t, again));
  ASSERT_EQ(again.t, hit.t);
  ASSERT_EQ(again.part, hit.part);
  ASSERT_FALSE(field.intersect(ray, lo, std::nextafter(hit.t, -kInf), again));
  ASSERT_TRUE(field.intersect(ray, hit.t, kInf, again));
  ASSERT_EQ(again.t, hit.t);
  ASSERT_EQ(again.part, hit.part);
  ASSERT_TRUE(!field.intersect(ray, std::nextafter(hit.t, kInf), kInf, again) || again.t > hit.t);

  // The surface.
  const SurfacePoint s = field.surface_point(ray, hit);
  const int n = data.size, cell = static_cast<int>(hit.part / 2), i = cell % (n - 1), j = cell / (n - 1);
  const bool upper = hit.part % 2;
  const Quad slope_x =
      upper ? Quad(data.at(i + 1, j + 1)) - data.at(i, j + 1) : Quad(data.at(i + 1, j)) - data.at(i, j);
  const Quad slope_y =
      upper ? Quad(data.at(i + 1, j + 1)) - data.at(i + 1, j) : Quad(data.at(i, j + 1)) - data.at(i, j);
  QuadVec normal{-slope_x * (n - 1), -slope_y * (n - 1), 1};
  normal = (1 / length(normal)) * normal;
  ASSERT_LT(static_cast<double>(length(normal - wide(s.normal))), 8 * kUlp);
  ASSERT_GT(s.normal.z, 0);
  const QuadVec corner{Quad(i + upper) / (n - 1), Quad(j + upper) / (n - 1), data.at(i + upper, j + upper)};
  ASSERT_LE(reference::absolute(dot(wide(s.point) - corner, normal)), s.error) << describe(data, ray, lo);
  ASSERT_LE(s.error,
            20 * kUlp * (2 + max_abs(s.point) + max_abs(field.bounds().lo) + max_abs(field.bounds().hi)));
  ASSERT_EQ(field.entering(ray, lo, hit), dot(normal, wide(ray.direction)) < 0);
  const double grid = n - 1;
  const double blur = 64 * same->unit * length(ray.direction) * grid + 1e-12 * grid;
  ASSERT_NEAR(hit.a, std::clamp(ray.at(hit.t).x * grid - i, 0.0, 1.0), blur);
  ASSERT_NEAR(hit.b, std::clamp(ray.at(hit.t).y * grid - j, 0.0, 1.0), blur);
}

Ray random_ray(const HeightField& field, Random& random) {
  const int n = field.data().size;
  const auto grid = [&] { return random.below(n) / (n - 1.0); };
  const Bounds3 box = field.bounds();
  const double low = box.lo.z, high = box.hi.z;
  Vec3 target{random.between(0, 1), random.between(0, 1), random.between(low, high)};
  Ray ray;
  switch (random.below(9)) {
    case 0:  // from above
      ray.origin = {random.between(-1, 2), random.between(-1, 2), high + random.between(0, 2)};
      break;
    case 1:  // from below
      ray.origin = {random.between(-1, 2), random.between(-1, 2), low - random.between(0, 2)};
      break;
    case 2:  // from within
      ray.origin = {random.between(0, 1), random.between(0, 1), random.between(low, high)};
      break;
    case 3:  // along grid lines
      ray.origin = {grid(), -0.5, high};
      target = {ray.origin.x, 0.5, random.between(low, high)};
      break;
    case 4:
      ray.origin = {1.5, grid(), low};
      target = {0.5, ray.origin.y, random.between(low, high)};
      break;
    case 5:  // along diagonals
      ray.origin = {2, -1 + grid(), high + 0.1};
      target = ray.origin + Vec3{-1, 1, random.between(-0.5, 0)};
      break;
    case 6:  // straight down and up through vertices and other points
      target = {random.below(2) ? grid() : target.x, grid(), 0};
      ray.origin = {target.x, target.y, random.below(2) ? high + 1 : low - 1};
      break;
    case 7:  // level
      ray.origin = {-1, random.between(0, 1), target.z};
      break;
    default:  // far away
      ray.origin = target + random.unit() * 1e5;
      break;
  }
  ray.direction = (target - ray.origin) * random.between(0.1, 3);
  return ray;
}

constexpr int kRays = 40;

void check_many(double height, double holes, unsigned seed, double lo) {
  SCOPED_TRACE(testing::Message() << "height " << height << " holes " << holes << " seed " << seed);
  Random random(seed);
  Tally tally;
  for (const int n : {2, 3, 4, 5, 8, 9, 17, 30, 65}) {
    const HeightField field(random_data(n, height, n > 3 ? holes : 0, random));
    for (int i = 0; i < kRays; ++i) {
      const Ray ray = random_ray(field, random);
      check_ray(field, ray, lo < 0 ? 0 : lo / length(ray.direction), tally);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
  EXPECT_GT(tally.hits, tally.rays / 5);
  std::cout << "height fields " << height << " high, " << holes << " holes: " << tally.rays << " rays, "
            << tally.hits << " hit, worst error " << tally.worst << " units of condition, seed " << seed
            << "\n";
}

TEST(HeightField, WholeOnesAgreeWithAllTriangles) { check_many(0.3, 0, 301, 0); }
TEST(HeightField, TornOnesAgree) { check_many(0.3, 0.2, 302, 0); }
TEST(HeightField, FlatOnesAgree) { check_many(1e-5, 0.1, 303, 0); }
TEST(HeightField, SteepOnesAgree) { check_many(50, 0.1, 304, 0); }
TEST(HeightField, TheLowerLimitIsHonoured) {
  check_many(0.3, 0.1, 305, 0.5);
  check_many(0.3, 0.1, 306, 1.3);
}

TEST(HeightField, SecondaryRaysFromTheSurface) {
  SCOPED_TRACE("seed 307");
  Random random(307);
  Tally tally;
  const HeightField field(random_data(40, 0.3, 0.05, random));
  for (int i = 0; i < 300; ++i) {
    Ray ray = random_ray(field, random);
    ShapeHit hit;
    if (!field.intersect(ray, 0, kInf, hit)) continue;
    ray.origin = field.surface_point(ray, hit).point;
    ray.direction = random.unit();
    check_ray(field, ray, 4e-5, tally);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(tally.hits, 50);
}

/// The altitude of a whole field.
double altitude(const HeightFieldData& data, double x, double y) {
  const int cells = data.size - 1;
  const int i = std::clamp(static_cast<int>(x * cells), 0, cells - 1);
  const int j = std::clamp(static_cast<int>(y * cells), 0, cells - 1);
  const double fx = x * cells - i, fy = y * cells - j, right = data.at(i + 1, j), top = data.at(i, j + 1);
  if (fx + fy <= 1) return data.at(i, j) * (1 - fx - fy) + right * fx + top * fy;
  return data.at(i + 1, j + 1) * (fx + fy - 1) + right * (1 - fy) + top * (1 - fx);
}

TEST(HeightField, NothingLeaksThroughEdgesAndVertices) {
  // A ray that starts beyond all altitudes stays on its side of the surface until it hits. Rays aim at
  // vertices and edges, many with a component that is the same, bit for bit, as the target's.
  SCOPED_TRACE("seed 308");
  Random random(308);
  int rays = 0, crossings = 0;
  for (const int n : {2, 3, 7, 33, 317}) {
    for (const double height : {0.001, 0.3, 20.0}) {
      const Data data = random_data(n, height, 0, random);
      const HeightField field(data);
      for (int k = 0; k < 4000; ++k) {
        const int i = random.below(n - 1), j = random.below(n - 1);
        // The vertex, or a point of the bottom, the left or the diagonal edge.
        const double f = random.below(3) == 0 ? 0.5 : random.between(0, 1);
        const double z = data->at(i, j), right = data->at(i + 1, j), top = data->at(i, j + 1), m = n - 1.0;
        const Vec3 targets[] = {{i / m, j / m, z},
                                {(i + f) / m, j / m, z + f * (right - z)},
                                {i / m, (j + f) / m, z + f * (top - z)},
                                {(i + 1 - f) / m, (j + f) / m, right + f * (top - right)}};
        const Vec3 target = targets[random.below(4)];
        // On the border of the square rounding may let a ray pass outside.
        if (std::min(target.x, target.y) < 1e-9 || std::max(target.x, target.y) > 1 - 1e-9) continue;
        const bool above = random.below(2) == 0;
        Vec3 from{random.between(0, 1), random.between(0, 1), 0};
        const int special = random.below(5);
        if (special == 0) from.x = target.x;
        if (special == 1) from.y = target.y;
        const double diagonal = 0.9 * std::min(1 - target.x, target.y);
        if (special == 2) from = {target.x + diagonal, target.y - diagonal, 0};
        if (special == 3) from = target;
        from.z = above ? field.bounds().hi.z + random.between(0.5, 2)
                       : field.bounds().lo.z - random.between(0.5, 2);
        const Ray ray{from, target - from};
        ShapeHit hit;
        const double until = field.intersect(ray, 0, kInf, hit) ? hit.t : kInf;
        for (const double t : {0.5, 0.9, 0.99, 1 - 1e-7, 1 + 1e-8, 1 + 1e-5, 1.001, 1.1, 1.5}) {
          const Vec3 p = ray.at(t);
          if (t >= until - 1e-9 || p.x < 1e-9 || p.x > 1 - 1e-9 || p.y < 1e-9 || p.y > 1 - 1e-9) continue;
          const double over = p.z - altitude(*data, p.x, p.y);
          ASSERT_GE(above ? over : -over, -1e-11 * (1 + height * n))
              << describe(*data, ray, 0) << " at " << t;
        }
        // On an edge that folds away from the ray, both sides are met at once.
        ASSERT_TRUE(until == kInf || std::fabs(until - 1) < 1e-9 || field.entering(ray, 0, hit) == above)
            << describe(*data, ray, 0);
        ++rays;
        crossings += until < 1 + 1e-9;
      }
    }
  }
  EXPECT_GT(crossings, rays * 3 / 4);
}

TEST(HeightField, ReferenceValue) {
  const auto data =
      std::make_shared<HeightFieldData>(HeightFieldData{3, {0, .1F, .2F, .3F, .1F, 0, .2F, .4F, .1F}});
  const HeightField field(data);
  const Ray ray{{0.3, -2, 1.5}, normalize(Vec3{0.1, 2.3, -1.3})};
  ShapeHit hit;
  ASSERT_TRUE(field.intersect(ray, kEpsilon, kFar, hit));
  EXPECT_NEAR(hit.t, 2.7697589, 1e-7);
  const SurfacePoint s = field.surface_point(ray, hit);
  EXPECT_LT(length(s.point - Vec3{0.404762, 0.409524, 0.138095}), 1e-6);
  EXPECT_LT(length(s.normal - Vec3{0.371391, 0, 0.928477}), 1e-6);
  EXPECT_TRUE(field.entering(ray, 0, hit));
  const TextureCoordinates uv = field.texture_coordinates(s.point, s.normal, hit);
  EXPECT_NEAR(uv.u, 0.404762, 1e-6);
  EXPECT_NEAR(uv.v, 0.409524, 1e-6);
  EXPECT_EQ(uv.du, (Vec3{1, 0, 0}));
  EXPECT_EQ(uv.dv, (Vec3{0, 1, 0}));
  EXPECT_EQ(hit.part, 1U);
}

TEST(HeightField, TheUpperTriangleWinsOnTheDiagonal) {
  const HeightField field(make_data(3, [](double x, double y) { return x * x + y; }));
  for (const double z : {5.0, -5.0}) {
    ShapeHit hit;
    ASSERT_TRUE(field.intersect({{0.25, 0.25, z}, {0, 0, -z}}, 0, kFar, hit));
    EXPECT_EQ(hit.part, 1U);
    EXPECT_EQ(hit.a, 0.5);
    EXPECT_EQ(hit.b, 0.5);
    ASSERT_TRUE(field.intersect({{0.25, 0.2499999, z}, {0, 0, -z}}, 0, kFar, hit));
    EXPECT_EQ(hit.part, 0U);
  }
}

TEST(HeightField, UnsetPointsTakeTheirTrianglesAlone) {
  auto data = std::make_shared<HeightFieldData>(HeightFieldData{2, {0, 0, 0, -1000}});
  const auto hits = [&](double x, double y) {
    ShapeHit hit;
    return HeightField(data).intersect({{x, y, 5}, {0, 0, -1}}, 0, kFar, hit);
  };
  EXPECT_TRUE(hits(0.2, 0.2));
  EXPECT_FALSE(hits(0.8, 0.8));
  data->altitudes = {-5000, 0, 0, 0};
  EXPECT_FALSE(hits(0.2, 0.2));
  EXPECT_TRUE(hits(0.8, 0.8));
  data->altitudes = {0, -1000, 0, 0};
  EXPECT_FALSE(hits(0.2, 0.2));
  EXPECT_FALSE(hits(0.8, 0.8));
  EXPECT_FALSE(HeightField(data).bounds().empty());
  data->altitudes = {-999, -999, -999, 2};
  EXPECT_EQ(HeightField(data).bounds().lo.z, -999);
  EXPECT_EQ(HeightField(data).bounds().hi.z, 2);
  EXPECT_TRUE(hits(0.2, 0.2));
}

TEST(HeightField, BoundsAreTheExtremesOfTheTriangles) {
  const Bounds3 box = HeightField(make_data(5, [](double, double) { return 0.5; })).bounds();
  EXPECT_EQ(box.lo, (Vec3{0, 0, 0.5}));
  EXPECT_EQ(box.hi, (Vec3{1, 1, 0.5}));
}

TEST(HeightField, LargeFlatFieldsAreSeenFromAboveAndBelow) {
  for (const int n : {2, 317, 318, 400}) {
    const HeightField field(make_data(n, [](double, double) { return 0.5; }));
    ShapeHit hit;
    ASSERT_TRUE(field.intersect({{0.3, 0.4, 2}, {0.1, 0.1, -1}}, 0, kFar, hit));
    EXPECT_NEAR(hit.t, 1.5, 1e-15);
    ASSERT_TRUE(field.intersect({{0.3, 0.4, -1}, {0.1, 0.1, 1}}, 0, kFar, hit));
    EXPECT_NEAR(hit.t, 1.5, 1e-15);
    EXPECT_FALSE(field.intersect({{0.3, 0.4, 0.5}, {0.1, 0.1, 1}}, 0, kFar, hit))
        << "never from the plane itself";
    EXPECT_FALSE(field.intersect({{0.3, 0.4, 0.5}, {0.1, 0.1, 0}}, 0, kFar, hit)) << "nor within it";
  }
}

TEST(HeightField, GrazingRaysHitWhateverTheLengths) {
  for (const double speed : {1e-6, 1.0, 1e6}) {
    const HeightField field(make_data(9, [](double, double) { return 0; }));
    for (const double side : {1.0, -1.0}) {
      ShapeHit hit;
      EXPECT_TRUE(field.intersect({{0.1, 0.4, 1e-9 * side}, Vec3{1, 0, -1e-8 * side} * speed}, 0, kInf, hit));
      EXPECT_NEAR(hit.t * speed, 0.1, 1e-12);
      EXPECT_FALSE(field.intersect({{0.1, 0.4, 1e-9 * side}, Vec3{1, 0, 0} * speed}, 0, kInf, hit));
      EXPECT_FALSE(field.intersect({{-0.1, 0.4, 0}, Vec3{1, 0, 0} * speed}, 0, kInf, hit))
          << "within its plane";
    }
  }
}

TEST(HeightField, TheNextHitIsAnotherOne) {
  // As CSG asks: beyond the last hit plus its tolerance. This ends.
  const HeightField field(make_data(65, [](double x, double) { return 0.1 * std::sin(40 * x); }));
  const Ray ray{{-1, 0.33, 0.01}, {1, 0.01, 0}};
  ShapeHit hit;
  double lo = 0;
  int count = 0;
  bool above = false;
  while (field.intersect(ray, lo, kFar, hit)) {
    ASSERT_GE(hit.t, lo);
    ASSERT_TRUE(count == 0 || field.entering(ray, lo, hit) != above);
    above = field.entering(ray, lo, hit);
    lo = hit.t + kEpsilon;
    ASSERT_LT(++count, 100);
  }
  EXPECT_GT(count, 10);
}

TEST(HeightField, RefusesWhatItCannotHold) {
  EXPECT_THROW(HeightField(std::make_shared<HeightFieldData>(HeightFieldData{1, {0}})),
               std::invalid_argument);
  EXPECT_THROW(HeightField(std::make_shared<HeightFieldData>(HeightFieldData{3, {0, 1}})),
               std::invalid_argument);
  EXPECT_THROW(HeightField(std::make_shared<HeightFieldData>(HeightFieldData{50000, {}})), std::length_error);
}

// A component of -0 is not a way to go: cells were taken in the order of the one sign and left in that of the
// other.
TEST(HeightField, ZerosOfEitherSignGoTheSameWay) {
  Random random(311);
  const HeightField field(random_data(9, 0.3, 0, random));
  int hits = 0;
  for (int i = 0; i < 200; ++i) {
    const int axis = random.below(3);
    Vec3 origin{random.between(0.01, 0.99), random.between(0.01, 0.99), random.between(0, 0.2)}, direction;
    const double way = random.below(2) ? 1 : -1;
    origin[axis] -= 5 * way;
    direction[axis] = way;
    ShapeHit expected;
    const bool found = field.intersect({origin, direction}, 0, kFar, expected);
    EXPECT_TRUE(found || axis != 2);
    hits += found;
    for (int signs = 1; signs < 4; ++signs) {
      Vec3 other = direction;
      if (signs & 1) other[(axis + 1) % 3] = -0.0;
      if (signs & 2) other[(axis + 2) % 3] = -0.0;
      ShapeHit hit;
      ASSERT_EQ(field.intersect({origin, other}, 0, kFar, hit), found) << i << " " << signs;
      ASSERT_EQ(hit.t, expected.t);
    }
  }
  EXPECT_GT(hits, 100);
}

TEST(HeightField, StrangeRaysMiss) {
  const HeightField field(make_data(5, [](double x, double) { return x; }));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ShapeHit hit;
  EXPECT_FALSE(field.intersect({{0.5, 0.5, 5}, {0, 0, 0}}, 0, kFar, hit));
  EXPECT_FALSE(field.intersect({{0.5, 0.5, 0.2}, {0, 0, 0}}, 0, kFar, hit));
  EXPECT_FALSE(field.intersect({{0.5, 0.5, 5}, {nan, 0, -1}}, 0, kFar, hit));
  EXPECT_FALSE(field.intersect({{0.5, nan, 5}, {0, 0, -1}}, 0, kFar, hit));
  EXPECT_FALSE(field.intersect({{0.5, 0.5, kInf}, {0, 0, -1}}, 0, kFar, hit));
}

TEST(HeightField, AMillionSamples) {
  SCOPED_TRACE("seed 309");
  Random random(309);
  const Data data = random_data(1024, 0.1, 0, random);
  const HeightField field(data);
  // A picture, row by row, and rays anywhere.
  std::vector<Ray> picture, scattered;
  for (int y = 0; y < 150; ++y) {
    for (int x = 0; x < 150; ++x) {
      const Vec3 eye{0.5, -1, 1}, target{x / 149.0, y / 149.0, 0};
      picture.push_back({eye, normalize(target - eye)});
      scattered.push_back({random.in_cube(2), {}});
      scattered.back().direction =
          normalize(Vec3{random.between(0, 1), random.between(0, 1), 0.1} - scattered.back().origin);
    }
  }
  for (const auto* rays : {&picture, &scattered}) {
    int hits = 0;
    const std::clock_t start = std::clock();
    for (const Ray& ray : *rays) {
      ShapeHit hit;
      hits += field.intersect(ray, kEpsilon, kFar, hit);
    }
    const double time = 1e9 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    std::cout << "height field of 1024 x 1024, " << (rays == &picture ? "picture" : "scattered") << ": "
              << time / static_cast<double>(rays->size()) << " ns per ray, " << hits << " of " << rays->size()
              << " hit\n";
    EXPECT_GT(hits, static_cast<int>(rays->size()) / 3);
  }
  Tally tally;
  for (int i = 0; i < 3; ++i) {
    check_ray(field, picture[static_cast<std::size_t>(random.below(20000))], 0, tally);
    check_ray(field, scattered[static_cast<std::size_t>(random.below(20000))], 0, tally);
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace rayshade
