// SPDX-License-Identifier: MIT
// The blob against the field in quadruple precision, and against the cases in which its ancestors failed.
#include "rayshade/geometry/shapes/blob.h"

#include <gtest/gtest.h>

#include <algorithm>
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

struct Reference {
  explicit Reference(const shape::Blob& b) : blob(b) {}

  struct Field {
    Quad value = 0;  ///< minus the threshold
    QuadVec gradient{0, 0, 0};
  };
  Field field(const QuadVec& p) const {
    Field out;
    for (const shape::Metaball& ball : blob.balls) {
      const QuadVec q = p - wide(ball.center);
      if (reference::absolute(q.x) > ball.radius) continue;
      const Quad r2 = Quad(ball.radius) * ball.radius, u = 1 - dot(q, q) / r2;
      if (u <= 0) continue;
      out.value += ball.strength * u * u;
      out.gradient = out.gradient + (-4 * ball.strength * u / r2) * q;
    }
    out.value -= blob.threshold;
    return out;
  }
  std::vector<double> all(const Ray& ray) const {
    double nearest = kInf, farthest = -kInf, smallest = kInf;
    const double speed = length(ray.direction);
    for (const shape::Metaball& ball : blob.balls) {
      const double along = rayshade::dot(ball.center - ray.origin, ray.direction) / (speed * speed);
      nearest = std::min(nearest, along - 1.01 * ball.radius / speed);
      farthest = std::max(farthest, along + 1.01 * ball.radius / speed);
      smallest = std::min(smallest, ball.radius);
    }
    // |gradient| of a ball is at most 8 s / (3 sqrt(3) r) < 1.54 s / r.
    const auto slope = [&](double a, double b) {
      const Vec3 middle = ray.at(0.5 * (a + b));
      double sum = 0;
      for (const shape::Metaball& ball : blob.balls) {
        const double reach = ball.radius + 0.51 * (b - a) * speed + 1e-9 * (b * speed + length(middle));
        if (length(middle - ball.center) < reach) sum += 1.54 * ball.strength / ball.radius * speed;
      }
      return sum;
    };
    std::vector<Quad> found;
    reference::sign_changes([&](Quad t) { return field(reference::at(ray, t)).value; }, nearest, farthest,
                            slope, 1e-6 * smallest / speed, found);
    return {found.begin(), found.end()};
  }

  shape::Blob blob;
};

std::vector<double> all_hits(const Blob& blob, const Ray& ray) {
  std::vector<double> out;
  ShapeHit hit;
  for (double lo = -kInf; blob.intersect(ray, lo, kInf, hit); lo = hit.t) {
    out.push_back(hit.t);
    if (out.size() > 200) break;
  }
  return out;
}

/// Compares all hits of a ray, in units of what one rounding of the numbers at hand (positions, and the sum
/// of the field) does to t. See the test of the torus.
class Checker {
 public:
  explicit Checker(const shape::Blob& blob) : shape_(blob), reference_(blob), blob_(blob) {
    for (const shape::Metaball& ball : blob.balls) {
      strengths_ += ball.strength;
      curvature_ += 8 * ball.strength / (ball.radius * ball.radius);
      reach_ = std::max(reach_, length(ball.center) + ball.radius);
    }
  }

  void check(const Ray& ray) {
    const std::vector<double> expected = reference_.all(ray), found = all_hits(blob_, ray);
    ++rays;
    hits += !found.empty();
    ASSERT_EQ(found.size() % 2, 0U) << describe(ray, expected, found);
    std::vector<bool> used(found.size(), false);
    for (const double want : expected) {
      const double unit = condition(ray, want);
      if (grazing_) continue;
      double error = kInf;
      std::size_t best = 0;
      for (std::size_t i = 0; i < found.size(); ++i) {
        if (!used[i] && std::fabs(found[i] - want) < error) error = std::fabs(found[i] - want), best = i;
      }
      ASSERT_LT(error / unit, 16) << describe(ray, expected, found) << want;
      used[best] = true;
      worst = std::max(worst, error / unit);
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
      condition(ray, found[i]);
      ASSERT_TRUE(used[i] || grazing_) << describe(ray, expected, found) << found[i];
      ASSERT_LT(std::fabs(value_), 16 * allowance_) << describe(ray, expected, found);
      // In and out alternate.
      ASSERT_TRUE(grazing_ || (slope_ > 0) == (i % 2 == 0)) << describe(ray, expected, found);
      check_surface(ray, found[i]);
    }
    check_limits(ray, found);
  }

  int rays = 0, hits = 0;
  double worst = 0;

 private:
  std::string describe(const Ray& ray, const std::vector<double>& expected,
                       const std::vector<double>& found) const {
    std::ostringstream out;
    out.precision(17);
    out << "threshold " << shape_.threshold;
    for (const auto& b : shape_.balls) {
      out << ", " << b.strength << " " << b.radius << " " << b.center.x << " " << b.center.y << " "
          << b.center.z;
    }
    out << "\nray " << ray.origin.x << " " << ray.origin.y << " " << ray.origin.z << "  " << ray.direction.x
        << " " << ray.direction.y << " " << ray.direction.z << "\nexpected";
    for (const double t : expected) out << " " << t;
    out << "\nfound";
    for (const double t : found) out << " " << t;
    out << "\n";
    return out.str();
  }

  double condition(const Ray& ray, double t) {
    const Reference::Field f = reference_.field(reference::at(ray, t));
    const double speed = length(ray.direction);
    const double size = length(ray.origin) + reach_ + std::fabs(t) * speed;
    value_ = static_cast<double>(f.value);
    slope_ = static_cast<double>(dot(f.gradient, wide(ray.direction)));
    allowance_ =
        kUlp * (size * static_cast<double>(length(f.gradient)) + strengths_ + std::fabs(shape_.threshold)) +
        kUlp * size * kUlp * size * curvature_;
    const double steep = slope_ / speed;
    grazing_ = !(steep * steep > 128 * allowance_ * curvature_);
    return allowance_ / std::fabs(slope_);
  }

  void check_surface(const Ray& ray, double t) {
    const SurfacePoint s = blob_.surface_point(ray, {t, 0, 0, 0});
    const Reference::Field f = reference_.field(wide(s.point));
    const double steep = static_cast<double>(length(f.gradient));
    ASSERT_NEAR(length(s.normal), 1, 1e-15);
    const double slack = 128 * curvature_ * kUlp * (strengths_ + std::fabs(shape_.threshold));
    if (steep * steep < slack) return;
    ASSERT_LE(std::fabs(static_cast<double>(f.value)) / steep, s.error);
    ASSERT_LE(s.error, 64 * kUlp * (strengths_ + std::fabs(shape_.threshold) + steep * reach_) / steep);
    const QuadVec n = (-1 / length(f.gradient)) * f.gradient;
    ASSERT_LT(static_cast<double>(length(n - wide(s.normal))), 64 * kUlp * (1 + reach_ * curvature_ / steep));
    ASSERT_TRUE(grown(blob_.bounds(), s.error).contains(s.point));
    const bool entering = blob_.entering(ray, 0, {t, 0, 0, 0});
    ASSERT_TRUE(grazing_ || entering == (slope_ > 0));
  }

  /// hit(lo, hi) is the first of all hits beyond lo, bit for bit, if it is not beyond hi.
  void check_limits(const Ray& ray, const std::vector<double>& found) {
    for (const double t : found) {
      for (const double lo : {t, std::nextafter(t, -kInf), t - 1e-3 / length(ray.direction)}) {
        const auto want = std::upper_bound(found.begin(), found.end(), lo);
        ShapeHit hit;
        const bool is = blob_.intersect(ray, lo, kInf, hit);
        ASSERT_EQ(is, want != found.end());
        if (!is) continue;
        ASSERT_EQ(hit.t, *want);
        ASSERT_TRUE(blob_.intersect(ray, lo, hit.t, hit)) << "closed at hi";
        ASSERT_FALSE(blob_.intersect(ray, lo, std::nextafter(hit.t, -kInf), hit));
      }
    }
  }

  shape::Blob shape_;
  Reference reference_;
  Blob blob_;
  double strengths_ = 0, curvature_ = 0, reach_ = 0;
  double value_ = 0, slope_ = 0, allowance_ = 0;
  bool grazing_ = false;
};

shape::Blob random_blob(int balls, double scale, Random& random) {
  shape::Blob blob;
  const double spread = 0.5 + 0.1 * balls;
  for (int i = 0; i < balls; ++i) {
    blob.balls.push_back(
        {random.between(0.2, 3), random.between(0.2, 1.5) * scale, random.in_cube(spread * scale)});
  }
  blob.threshold = random.between(0.01, 1);
  return blob;
}

/// Points of the surface are found along random rays; further rays start from or graze there.
Ray adversarial_ray(const shape::Blob& shape, const Blob& blob, double scale, Random& random) {
  const auto& ball =
      shape.balls[static_cast<std::size_t>(random.below(static_cast<int>(shape.balls.size())))];
  Ray ray;
  ray.direction = random.unit();
  ray.origin =
      ball.center + random.in_cube(0.3 * ball.radius) - ray.direction * (scale * random.between(0, 10));
  ShapeHit hit;
  const int kind = random.below(7);
  if (kind >= 2 && blob.intersect(ray, -kInf, kInf, hit)) {
    const SurfacePoint s = blob.surface_point(ray, hit);
    const double away = scale * std::pow(10, random.between(-2, 3));
    Vec3 u, v;
    coordinate_system(s.normal, u, v);
    switch (kind) {
      case 2:  // from the surface
        ray = {s.point, random.unit()};
        break;
      case 3: {  // grazing
        ray.direction = normalize(u * random.between(-1, 1) + v * random.between(-1, 1));
        const double off = scale * std::pow(10, random.between(-17, -2)) * (random.below(2) ? 1 : -1);
        ray.origin = s.point + s.normal * off - ray.direction * away;
        break;
      }
      case 4:  // far away
        ray.origin = s.point - ray.direction * (1e6 * scale);
        break;
      case 5:  // through the middles of two balls
        ray.origin = shape.balls.front().center;
        ray.direction = normalize(shape.balls.back().center - ray.origin + random.in_cube(1e-12));
        break;
      default:  // from within
        ray.origin = s.point - s.normal * (1e-3 * scale);
        break;
    }
  }
  ray.direction *= std::pow(10, random.between(-3, 3));
  return ray;
}

constexpr int kBlobs = 4, kRays = 12;

void check_many(int balls, double scale, unsigned seed) {
  SCOPED_TRACE(testing::Message() << balls << " balls, scale " << scale << ", seed " << seed);
  Random random(seed);
  double worst = 0;
  int rays = 0, hits = 0;
  for (int k = 0; k < kBlobs; ++k) {
    const shape::Blob shape = random_blob(balls, scale, random);
    const Blob blob(shape);
    Checker checker(shape);
    for (int i = 0; i < kRays; ++i) {
      checker.check(adversarial_ray(shape, blob, scale, random));
      if (testing::Test::HasFatalFailure()) return;
    }
    worst = std::max(worst, checker.worst);
    rays += checker.rays;
    hits += checker.hits;
  }
  EXPECT_GT(hits, rays / 4);
  std::cout << "blob of " << balls << ", scale " << scale << ": " << rays << " rays, " << hits
            << " hit, worst error " << worst << " units of condition, seed " << seed << "\n";
}

TEST(Blob, OneBallAgreesWithQuadruplePrecision) { check_many(1, 1, 201); }
TEST(Blob, TwoBallsAgree) { check_many(2, 1, 202); }
TEST(Blob, SomeBallsAgree) { check_many(5, 1, 203); }
TEST(Blob, ManyBallsAgree) { check_many(12, 1, 204); }
TEST(Blob, SmallOnesAgree) { check_many(3, 1e-6, 205); }
TEST(Blob, LargeOnesAgree) { check_many(3, 1e6, 206); }

TEST(Blob, HundredsOfBallsAgree) {
  // More than fit without heap memory on one ray.
  SCOPED_TRACE("seed 207");
  Random random(207);
  shape::Blob shape;
  shape.threshold = 2.5;
  for (int i = 0; i < 150; ++i) shape.balls.push_back({1, 0.9, {0.02 * i, random.between(-1, 1), 0.3}});
  const Blob blob(shape);
  const Reference reference(shape);
  int crossings = 0;
  for (int i = 0; i < 40; ++i) {
    const Ray ray{{-2, random.between(-1.5, 1.5), 0.3},
                  normalize(Vec3{1, random.between(-.3, .3), random.between(-.1, .1)})};
    bool inside = false;
    double last = -kInf;
    for (const double t : all_hits(blob, ray)) {
      const auto f = reference.field(reference::at(ray, t));
      ASSERT_LT(std::fabs(static_cast<double>(f.value)), 1e-12);
      // Halfway from the last crossing the state is what the crossings say.
      if (last > -kInf && t - last > 1e-6) {
        ASSERT_EQ(reference.field(reference::at(ray, 0.5 * (last + t))).value > 0, inside);
      }
      inside = !inside;
      last = t;
      ++crossings;
    }
    ASSERT_FALSE(inside);
    // Nothing lies between samples that disagree with the number of crossings.
    const std::vector<double> hits = all_hits(blob, ray);
    for (double t = 0; t < 8; t += 0.05) {
      const auto before = std::upper_bound(hits.begin(), hits.end(), t) - hits.begin();
      ASSERT_EQ(reference.field(reference::at(ray, t)).value > 0, before % 2 == 1) << t;
    }
  }
  EXPECT_GT(crossings, 40);
}

TEST(Blob, ReferenceValue) {
  const Blob blob(shape::Blob{.4, {{1, 1.2, {-.5, 0, 0}}, {.8, 1, {.6, .2, .3}}}});
  const Ray ray{{3, -8, 4}, normalize(Vec3{-3, 8.1, -3.9})};
  ShapeHit hit;
  ASSERT_TRUE(blob.intersect(ray, kEpsilon, kFar, hit));
  EXPECT_NEAR(hit.t, 8.8880893, 6e-8);
  const SurfacePoint s = blob.surface_point(ray, hit);
  EXPECT_LT(length(s.point - Vec3{0.186525, -0.403616, 0.342482}), 1e-6);
  EXPECT_LT(length(s.normal - Vec3{0.193093, -0.922577, 0.334016}), 1e-6);
  EXPECT_TRUE(blob.entering(ray, 0, hit));
  const TextureCoordinates uv = blob.texture_coordinates(s.point, s.normal, hit);
  EXPECT_EQ(uv.u, 0);
  EXPECT_EQ(uv.v, 0);
  EXPECT_EQ(uv.du, (Vec3{1, 0, 0}));
  EXPECT_EQ(uv.dv, (Vec3{0, 1, 0}));
}

TEST(Blob, OneBallIsASphere) {
  const Blob blob(shape::Blob{.5, {{1, 1, {0, 0, 0}}}});
  const Ray ray{{0, 0, 5}, {0, 0, -2}};
  const std::vector<double> hits = all_hits(blob, ray);
  const double r = std::sqrt(1 - std::sqrt(0.5));
  ASSERT_EQ(hits.size(), 2U);
  EXPECT_NEAR(hits[0], (5 - r) / 2, 1e-15);
  EXPECT_NEAR(hits[1], (5 + r) / 2, 1e-15);
  EXPECT_NEAR(2 * (hits[1] - hits[0]), 1.08, 0.003) << "the path through a medium";
  EXPECT_LT(max_abs(blob.bounds().hi - Vec3{r, r, r}), 1e-6) << "tight around the surface";
  EXPECT_GE(blob.bounds().hi.x, r);
}

TEST(Blob, TheRootAtTheStartHidesNothing) {
  // A ray refracted into the blob leaves it again, at any scale and whatever the rounding of its start.
  for (const double scale : {1e-3, 0.15, 1.0, 2.0, 3.0, 1e3}) {
    const Blob blob(shape::Blob{.5, {{1, scale, {0, 0, 0}}}});
    const double r = scale * std::sqrt(1 - std::sqrt(0.5));
    for (int i = -50; i <= 50; ++i) {
      const Ray ray{{0, 0, r + i * 1e-6 * scale}, {0, 0, -1}};
      ShapeHit hit;
      ASSERT_TRUE(blob.intersect(ray, 1e-4 * scale, kFar, hit)) << scale << " " << i;
      ASSERT_NEAR(hit.t, 2 * r + i * 1e-6 * scale, 1e-14 * scale);
    }
  }
}

void check_picture(const shape::Blob& shape, double half, double distance) {
  SCOPED_TRACE(testing::Message() << "half width " << half << " distance " << distance);
  Checker checker(shape);
  constexpr int kSide = 12;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const Vec3 target{half * (2 * (i + 0.5) / kSide - 1), 0, half * (2 * (j + 0.5) / kSide - 1)};
      const Vec3 eye{0, -distance, 0};
      checker.check({eye, normalize(target - eye)});
      if (testing::Test::HasFatalFailure()) return;
    }
  }
  EXPECT_GT(checker.hits, 10);
}

TEST(Blob, NothingIsLostOfSmallInfluence) {
  for (const double r : {.75, .3, .15, 1e-4}) check_picture({.3, {{1, r, {0, 0, 0}}}}, r, 5);
}
TEST(Blob, NothingIsLostFarAway) {
  const shape::Blob blob{.4, {{1, 1.2, {-.5, 0, 0}}, {.8, 1, {.6, .2, .3}}}};
  for (const double distance : {5.0, 2000.0, 10000.0}) check_picture(blob, 1.2, distance);
}

TEST(Blob, ThresholdAtOrAboveTheStrengthDrawsNothing) {
  ShapeHit hit;
  const Ray ray{{0, 0, 5}, {0, 0, -1}};
  EXPECT_FALSE(Blob(shape::Blob{1, {{1, 1, {0, 0, 0}}}}).intersect(ray, -kInf, kInf, hit));
  EXPECT_FALSE(Blob(shape::Blob{2, {{1, 1, {0, 0, 0}}}}).intersect(ray, -kInf, kInf, hit));
  EXPECT_FALSE(Blob(shape::Blob{-1, {{1, 1, {0, 0, 0}}}}).intersect(ray, -kInf, kInf, hit))
      << "inside everywhere";
  EXPECT_FALSE(Blob(shape::Blob{2, {{1, 1, {0, 0, 0}}}}).bounds().empty());
}

TEST(Blob, ThresholdZeroIsTheBorderOfTheInfluence) {
  const Blob blob(shape::Blob{0, {{1, 1, {0, 0, 0}}, {1, 1, {1.5, 0, 0}}, {1, 0.5, {5, 0, 0}}}});
  const Ray ray{{-5, 0, 0}, {1, 0, 0}};
  const std::vector<double> hits = all_hits(blob, ray);
  ASSERT_EQ(hits.size(), 4U);
  const double expected[] = {4, 7.5, 9.5, 10.5};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(hits[i], expected[i], 1e-12);
  EXPECT_LT(length(blob.surface_point(ray, {4, 0, 0, 0}).normal - Vec3{-1, 0, 0}), 1e-14);
}

TEST(Blob, BoundsHoldTheSurface) {
  SCOPED_TRACE("seed 208");
  Random random(208);
  for (int k = 0; k < 60; ++k) {
    const shape::Blob shape = random_blob(1 + random.below(8), 1, random);
    const Blob blob(shape);
    for (int i = 0; i < 50; ++i) {
      const Ray ray{random.in_cube(2), random.unit()};
      for (const double t : all_hits(blob, ray)) EXPECT_TRUE(grown(blob.bounds(), 1e-13).contains(ray.at(t)));
    }
  }
}

TEST(Blob, StrangeRaysMiss) {
  const Blob blob(shape::Blob{.5, {{1, 1, {0, 0, 0}}}});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ShapeHit hit;
  EXPECT_FALSE(blob.intersect({{0, 0, 5}, {0, 0, 0}}, 0, kFar, hit));
  EXPECT_FALSE(blob.intersect({{0, 0, 5}, {nan, 0, -1}}, 0, kFar, hit));
  EXPECT_FALSE(blob.intersect({{nan, 0, 5}, {0, 0, -1}}, 0, kFar, hit));
  EXPECT_FALSE(blob.intersect({{0, 0, kInf}, {0, 0, -1}}, 0, kFar, hit));
}

}  // namespace
}  // namespace rayshade
