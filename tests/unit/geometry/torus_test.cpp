// SPDX-License-Identifier: MIT
// The torus against quadruple precision, and against the cases in which its ancestors failed.
#include "rayshade/geometry/shapes/torus.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iomanip>
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

struct Root {
  double t;
  std::uint32_t sheet;
};

/// Written from the definition of the surface: the points at distance r from a circle of radius R, nearest
/// (sheet 0) or farthest (sheet 1) point of the circle in the same half plane.
struct Reference {
  explicit Reference(const shape::Torus& torus) : center(wide(torus.center)), R(torus.swept), r(torus.tube) {
    const QuadVec w = wide(torus.axis);
    axis = (1 / length(w)) * w;
  }

  Quad distance(const QuadVec& p, std::uint32_t sheet) const {
    const QuadVec q = p - center;
    const Quad z = dot(q, axis);
    const Quad h = length(q - z * axis);
    const Quad off = sheet == 0 ? h - R : h + R;
    return reference::root(off * off + z * z) - r;
  }
  QuadVec normal(const QuadVec& p, std::uint32_t sheet) const {
    const QuadVec q = p - center;
    const Quad z = dot(q, axis);
    const QuadVec across = q - z * axis;
    const Quad h = length(across);
    const QuadVec n = q - ((sheet == 0 ? R : -R) / h) * across;
    return (1 / length(n)) * n;
  }
  Quad axis_distance(const QuadVec& p) const {
    const QuadVec q = p - center;
    return length(q - dot(q, axis) * axis);
  }
  std::vector<Root> all(const Ray& ray) const {
    const QuadVec o = wide(ray.origin) - center, d = wide(ray.direction);
    const Quad speed = length(d), middle = -dot(o, d) / (speed * speed), reach = 1.01 * (R + r) / speed;
    std::vector<Root> out;
    for (std::uint32_t sheet = 0; sheet < (r > R ? 2U : 1U); ++sheet) {
      std::vector<Quad> found;
      reference::sign_changes([&](Quad t) { return distance(reference::at(ray, t), sheet); }, middle - reach,
                              middle + reach, [&](double, double) { return static_cast<double>(speed); },
                              1e-6 * r / speed, found);
      for (const Quad t : found) out.push_back({static_cast<double>(t), sheet});
    }
    std::sort(out.begin(), out.end(), [](const Root& a, const Root& b) { return a.t < b.t; });
    return out;
  }

  QuadVec center, axis;
  Quad R, r;
};

std::vector<Root> all_hits(const Torus& torus, const Ray& ray) {
  std::vector<Root> out;
  ShapeHit hit;
  for (double lo = -kInf; torus.intersect(ray, lo, kInf, hit); lo = hit.t) {
    out.push_back({hit.t, hit.part});
    if (out.size() > 8) break;
  }
  return out;
}

/// Compares all hits of a ray. Errors are measured in units of what one rounding of the numbers at hand does
/// to t: it moves the ray by up to kUlp times the largest of them, seen at the angle under which the ray
/// meets the surface. Where a move of 64 units changes that angle itself (grazing), hits may come and go in
/// pairs, and only have to lie on the surface.
class Checker {
 public:
  Checker(const shape::Torus& torus) : shape_(torus), reference_(torus), torus_(torus) {}

  void check(const Ray& ray) {
    const std::vector<Root> expected = reference_.all(ray), found = all_hits(torus_, ray);
    ++rays;
    hits += !found.empty();
    // Through the inner sheet into the lemon and out again: every sheet is closed.
    for (std::uint32_t sheet = 0; sheet < 2; ++sheet) {
      ASSERT_EQ(
          std::count_if(found.begin(), found.end(), [&](const Root& x) { return x.sheet == sheet; }) % 2, 0)
          << describe(ray);
    }
    std::vector<bool> used(found.size(), false);
    for (const Root& want : expected) {
      const double unit = condition(ray, want);
      if (grazing_) continue;
      std::size_t best = found.size();
      for (std::size_t i = 0; i < found.size(); ++i) {
        if (used[i] || found[i].sheet != want.sheet) continue;
        if (best == found.size() || std::fabs(found[i].t - want.t) < std::fabs(found[best].t - want.t))
          best = i;
      }
      const double error = best < found.size() ? std::fabs(found[best].t - want.t) / unit : kInf;
      ASSERT_LT(error, 16) << describe(ray) << " wants t = " << want.t << " on sheet " << want.sheet;
      used[best] = true;
      worst = std::max(worst, error);
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
      condition(ray, found[i]);
      ASSERT_TRUE(used[i] || grazing_) << describe(ray) << " has no hit at t = " << found[i].t;
      const Quad off = reference_.distance(reference::at(ray, found[i].t), found[i].sheet);
      ASSERT_LT(std::fabs(static_cast<double>(off)), 16 * kUlp * size_)
          << describe(ray) << " t = " << found[i].t;
      check_surface(ray, found[i]);
    }
    check_limits(ray, found);
  }

  int rays = 0, hits = 0;
  double worst = 0;

 private:
  std::string describe(const Ray& ray) const {
    char text[600];
    std::snprintf(text, sizeof text,
                  "torus %.17g %.17g  %.17g %.17g %.17g  %.17g %.17g %.17g, ray %a %a %a  %a %a %a",
                  shape_.swept, shape_.tube, shape_.center.x, shape_.center.y, shape_.center.z, shape_.axis.x,
                  shape_.axis.y, shape_.axis.z, ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x,
                  ray.direction.y, ray.direction.z);
    std::ostringstream out;
    out << text << std::setprecision(17) << "\nexpected";
    for (const Root& x : reference_.all(ray)) out << "  " << x.t << " (" << x.sheet << ")";
    out << "\nfound   ";
    for (const Root& x : all_hits(torus_, ray)) out << "  " << x.t << " (" << x.sheet << ")";
    out << "\n";
    return out.str();
  }

  double condition(const Ray& ray, const Root& root) {
    const QuadVec p = reference::at(ray, root.t);
    const double speed = length(ray.direction);
    size_ =
        length(ray.origin) + length(shape_.center) + shape_.swept + shape_.tube + std::fabs(root.t) * speed;
    const double cosine =
        std::fabs(static_cast<double>(dot(reference_.normal(p, root.sheet), wide(ray.direction)))) / speed;
    const double curvature = 1 / shape_.tube + 1 / static_cast<double>(reference_.axis_distance(p));
    // Nor does the reference see pairs closer than its width.
    grazing_ =
        !(cosine * cosine > 64 * 8 * kUlp * size_ * curvature && cosine > 1e-6 * shape_.tube * curvature);
    return kUlp * size_ / (cosine * speed);
  }

  void check_surface(const Ray& ray, const Root& root) {
    const ShapeHit hit{root.t, 0, 0, root.sheet};
    const SurfacePoint s = torus_.surface_point(ray, hit);
    const double off = std::fabs(static_cast<double>(reference_.distance(wide(s.point), root.sheet)));
    ASSERT_LE(off, s.error) << describe(ray);
    ASSERT_LE(s.error, 20 * kUlp * (shape_.swept + shape_.tube + length(shape_.center)));
    ASSERT_LT(length(s.point - ray.at(root.t)), 32 * kUlp * size_) << describe(ray);
    ASSERT_NEAR(length(s.normal), 1, 1e-15) << describe(ray) << " t = " << root.t;
    const double h = static_cast<double>(reference_.axis_distance(wide(s.point)));
    if (h > 1e-4 * (shape_.swept + shape_.tube) && root.sheet == 0) {
      const QuadVec n = reference_.normal(wide(s.point), 0);
      const double difference = static_cast<double>(length(n - wide(s.normal)));
      ASSERT_LT(difference,
                16 * kUlp * (1 + (length(shape_.center) + shape_.swept) * (1 / shape_.tube + 1 / h)));
    }
    const Bounds3 box = grown(torus_.bounds(), s.error);
    ASSERT_TRUE(box.contains(s.point)) << describe(ray);
  }

  /// hit(lo, hi) is the first of all hits beyond lo, bit for bit, if it is not beyond hi.
  void check_limits(const Ray& ray, const std::vector<Root>& found) {
    for (const Root& root : found) {
      for (const double lo : {root.t, std::nextafter(root.t, -kInf), root.t - 1e-3}) {
        const auto want = std::find_if(found.begin(), found.end(), [&](const Root& x) { return x.t > lo; });
        ShapeHit hit;
        const bool is = torus_.intersect(ray, lo, kInf, hit);
        ASSERT_EQ(is, want != found.end());
        if (!is) continue;
        ASSERT_EQ(hit.t, want->t);
        ASSERT_EQ(hit.part, want->sheet);
        ASSERT_TRUE(torus_.intersect(ray, lo, hit.t, hit)) << "closed at hi";
        ASSERT_FALSE(torus_.intersect(ray, lo, std::nextafter(hit.t, -kInf), hit));
      }
    }
  }

  shape::Torus shape_;
  Reference reference_;
  Torus torus_;
  double size_ = 0;
  bool grazing_ = false;
};

/// A point of the surface, its normal and its tangents, from angles.
struct Patch {
  Vec3 point, normal, around, along;
};
Patch patch(const shape::Torus& t, Random& random) {
  const Vec3 w = normalize(t.axis);
  Vec3 x, y;
  coordinate_system(w, x, y);
  const double a = random.between(0, 6.2831853), b = random.between(0, 6.2831853);
  const Vec3 out = x * std::cos(a) + y * std::sin(a);
  Patch p;
  p.normal = out * std::cos(b) + w * std::sin(b);
  p.point = t.center + out * t.swept + p.normal * t.tube;
  p.around = y * std::cos(a) - x * std::sin(a);
  p.along = w * std::cos(b) - out * std::sin(b);
  return p;
}

Ray adversarial_ray(const shape::Torus& t, Random& random) {
  const double size = t.swept + t.tube;
  const Patch p = patch(t, random);
  const Vec3 w = normalize(t.axis);
  Ray ray;
  const double away = size * std::pow(10, random.between(-2, 3));
  switch (random.below(9)) {
    case 0:  // towards the surface from anywhere
      ray.direction = random.unit();
      ray.origin = p.point - ray.direction * away;
      break;
    case 1: {  // grazing, within or without by anything
      const double angle = random.between(0, 6.2831853);
      ray.direction = p.around * std::cos(angle) + p.along * std::sin(angle);
      const double off = t.tube * std::pow(10, random.between(-17, -1)) * (random.below(2) ? 1 : -1);
      ray.origin = p.point + p.normal * off - ray.direction * away;
      break;
    }
    case 2: {  // edge-on
      ray.direction = normalize(cross(w, random.unit()));
      ray.origin = p.point - ray.direction * away;
      break;
    }
    case 3:  // along the axis
      ray.direction = w * (random.below(2) ? 1 : -1);
      ray.origin = p.point - ray.direction * away;
      break;
    case 4:  // from the surface, like secondary rays
      ray.direction = random.unit();
      ray.origin = p.point;
      break;
    case 5:  // through the centre
      ray.direction = normalize(p.point - t.center);
      ray.origin = t.center - ray.direction * away;
      break;
    case 6:  // along the tube's centre line
      ray.direction = p.around;
      ray.origin = t.center + (p.point - p.normal * t.tube - t.center) - ray.direction * away;
      break;
    case 7:  // far away
      ray.direction = random.unit();
      ray.origin = p.point - ray.direction * (size * 1e6);
      break;
    default:  // anywhere
      ray.origin = t.center + random.in_cube(2 * size);
      ray.direction = random.unit();
      break;
  }
  ray.direction *= std::pow(10, random.between(-3, 3));
  return ray;
}

void check_many(double swept, double tube, int count, unsigned seed) {
  SCOPED_TRACE(testing::Message() << "R " << swept << " r " << tube << " seed " << seed);
  Random random(seed);
  double worst = 0;
  int rays = 0, hits = 0;
  for (const double scale : {1.0, 1e-6, 1e6}) {
    const shape::Torus t{swept * scale, tube * scale, random.in_cube(scale), random.in_cube(1)};
    Checker checker(t);
    for (int i = 0; i < count / 3; ++i) {
      checker.check(adversarial_ray(t, random));
      if (testing::Test::HasFatalFailure()) return;
    }
    worst = std::max(worst, checker.worst);
    rays += checker.rays;
    hits += checker.hits;
  }
  EXPECT_GT(hits, rays / 3);
  std::cout << "torus " << swept << " / " << tube << ": " << rays << " rays, " << hits << " hit, worst error "
            << worst << " units of condition, seed " << seed << "\n";
}

constexpr int kRays = 90;

TEST(Torus, RingsAgreeWithQuadruplePrecision) { check_many(1, 0.3, kRays, 101); }
TEST(Torus, ThinOnesAgree) { check_many(1, 1e-3, kRays, 102); }
TEST(Torus, VeryThinOnesAgree) { check_many(1, 1e-4, kRays, 103); }
TEST(Torus, FatOnesAgree) { check_many(1, 0.95, kRays, 104); }
TEST(Torus, HornsAgree) { check_many(1, 1, kRays, 105); }
TEST(Torus, SpindlesAgree) { check_many(0.5, 1, kRays, 106); }
TEST(Torus, AlmostSpheresAgree) { check_many(1e-3, 1, kRays, 107); }

TEST(Torus, ReferenceValue) {
  const Torus torus(shape::Torus{1, .3, {0, 0, 0}, {1, 0, 1}});
  const Ray ray{{3, -8, 4}, normalize(Vec3{-2.4, 7.6, -4.5})};
  ShapeHit hit;
  ASSERT_TRUE(torus.intersect(ray, kEpsilon, kFar, hit));
  EXPECT_NEAR(hit.t, 8.7262604, 5e-8);
  const SurfacePoint s = torus.surface_point(ray, hit);
  EXPECT_LT(length(s.point - Vec3{0.711794, -0.754014, -0.290387}), 1e-6);
  EXPECT_LT(length(s.normal - Vec3{0.758448, -0.084420, 0.646243}), 1e-6);
  EXPECT_EQ(s.normal, s.geometric_normal);
  EXPECT_FALSE(s.smooth);
  EXPECT_TRUE(torus.entering(ray, kEpsilon, hit));
  const TextureCoordinates uv = torus.texture_coordinates(s.point, s.normal, hit);
  EXPECT_NEAR(uv.u, 0.870065, 5e-7);
  EXPECT_NEAR(uv.v, 0.731520, 5e-7);
  // The next one leaves.
  ASSERT_TRUE(torus.intersect(ray, hit.t, kFar, hit));
  EXPECT_FALSE(torus.entering(ray, 0, hit));
}

TEST(Torus, TextureCoordinatesRunAroundBothCircles) {
  const Torus torus(shape::Torus{2, 1, {0, 0, 0}, {0, 0, 1}});
  const auto at = [&](Vec3 p, Vec3 n) { return torus.texture_coordinates(p, n, {}); };
  EXPECT_NEAR(at({1, 0, 0}, {-1, 0, 0}).v, 0, 1e-12) << "inner equator";
  EXPECT_NEAR(at({2, 0, -1}, {0, 0, -1}).v, 0.25, 1e-12);
  EXPECT_NEAR(at({3, 0, 0}, {1, 0, 0}).v, 0.5, 1e-12) << "outer equator";
  EXPECT_NEAR(at({2, 0, 1}, {0, 0, 1}).v, 0.75, 1e-12);
  EXPECT_NEAR(at({3, 0, 0}, {1, 0, 0}).u, 0, 1e-12);
  EXPECT_NEAR(at({0, 3, 0}, {0, 1, 0}).u, 0.25, 1e-12);
  EXPECT_NEAR(at({0, -3, 0}, {0, -1, 0}).u, 0.75, 1e-12);
  const TextureCoordinates outer = at({3, 0, 0}, {1, 0, 0});
  EXPECT_LT(length(outer.du - Vec3{0, 1, 0}), 1e-12);
  EXPECT_LT(length(outer.dv - Vec3{0, 0, 1}), 1e-12);
  // Off the surface and on the axis they must still be numbers.
  const TextureCoordinates centre = at({0, 0, 0}, {0, 0, 1});
  EXPECT_TRUE(std::isfinite(centre.u) && std::isfinite(centre.v) && is_finite(centre.du) &&
              is_finite(centre.dv));
}

TEST(Torus, SecondTangentIsTurnedTwice) {
  // Axis +x: the frame takes (x, y, z) to (-z..., ...): rows (0,0,-1), (0,1,0), (1,0,0).
  const Torus torus(shape::Torus{2, 1, {0, 0, 0}, {1, 0, 0}});
  const TextureCoordinates uv = torus.texture_coordinates({0, 0, -3}, {0, 0, -1}, {});
  EXPECT_LT(length(uv.du - Vec3{0, 1, 0}), 1e-12);
  // m x du = (0,0,-1) x (0,1,0) = (1,0,0), which the frame takes to (0,0,-1).
  EXPECT_LT(length(uv.dv - Vec3{0, 0, -1}), 1e-12);
}

/// All rays of a small picture of the torus, orthographic or in perspective.
void check_picture(double swept, double tube, Vec3 axis, double distance, double half_angle_sizes = 1.1) {
  SCOPED_TRACE(testing::Message() << "R " << swept << " r " << tube << " distance " << distance);
  const shape::Torus t{swept, tube, {0, 0, 0}, axis};
  Checker checker(t);
  constexpr int kSide = 12;
  const double half = half_angle_sizes * (swept + tube);
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const Vec3 target{half * (2 * (i + 0.5) / kSide - 1), 0, half * (2 * (j + 0.5) / kSide - 1)};
      const Vec3 eye{0, -distance, 0};
      checker.check({eye, normalize(target - eye)});
      if (testing::Test::HasFatalFailure()) return;
    }
  }
  EXPECT_GT(checker.hits, 0);
}

TEST(Torus, NothingIsLostFarAway) {
  for (const double distance : {5.0, 2000.0, 10000.0}) check_picture(1, 0.4, {1, 0.5, 1}, distance);
}
TEST(Torus, NothingIsLostWhenSmall) {
  for (const double swept : {0.3, 0.2, 0.03, 1e-4}) {
    check_picture(swept, 0.4 * swept, {0, 0, 1}, 5, 0.99);  // edge-on
    check_picture(swept, 0.4 * swept, {0, 1, 1}, 5);
  }
}
TEST(Torus, NothingIsLostOfThinTubesEdgeOn) {
  const shape::Torus t{1, 0.01, {0, 0, 0}, {0, 0, 1}};
  Checker checker(t);
  for (int i = 0; i < 100; ++i) {
    const double x = -1 + 0.02 * i, z = 0.0099 * std::sin(i);
    const int before = checker.hits;
    checker.check({{x, -5, z}, {0, 1, 0}});
    if (HasFatalFailure()) return;
    EXPECT_EQ(checker.hits, before + 1);
  }
}

TEST(Torus, SpindlesHaveNoHoleAtTheirAxis) {
  const shape::Torus t{0.5, 1, {0, 0, 0}, {0, 0, 1}};
  const Torus torus(t);
  for (const double off : {0.0, 1e-300, 1e-17, 1e-12, 1e-8, 1e-5, 1e-3}) {
    for (const double tilt : {0.0, 1e-17, 1e-9, 1e-3}) {
      const Ray ray{{off, 0, 5}, normalize(Vec3{tilt, -tilt, -1})};
      const std::vector<Root> hits = all_hits(torus, ray);
      // On the axis itself both sheets are met at once.
      ASSERT_EQ(hits.size(), std::max(off, tilt) < 1e-16 ? 2U : 4U) << off << " " << tilt;
      const double pole = std::sqrt(0.75);
      EXPECT_NEAR(hits[0].t, 5 - pole, 6e-3);
      EXPECT_NEAR(hits.back().t, 5 + pole, 6e-3);
      EXPECT_EQ(hits[0].sheet, 0U);
      EXPECT_EQ(hits[1].sheet, hits.size() == 4 ? 1U : 0U);
      EXPECT_TRUE(is_finite(torus.surface_point(ray, {hits[0].t, 0, 0, 0}).normal));
    }
  }
}

TEST(Torus, InnerSheetHasTheFormulaOfTheOuterOne) {
  const Torus torus(shape::Torus{0.5, 1, {0, 0, 0}, {0, 0, 1}});
  const Ray ray{{0.1, 0, 0}, {0, 0, 1}};  // starts in the lemon
  ShapeHit hit;
  ASSERT_TRUE(torus.intersect(ray, 0, kFar, hit));
  EXPECT_EQ(hit.part, 1U);
  const double z = std::sqrt(1 - 0.36);
  EXPECT_NEAR(hit.t, z, 1e-15);
  const SurfacePoint s = torus.surface_point(ray, hit);
  EXPECT_LT(length(s.point - Vec3{0.1, 0, z}), 1e-15);
  EXPECT_LT(length(s.normal - normalize(Vec3{-0.4, 0, z})), 1e-14);
}

TEST(Torus, NormalizedAndOtherDirectionsAgree) {
  const Torus torus(shape::Torus{1, .3, {.1, .2, .3}, {1, 0, 1}});
  const Vec3 d{-2.4, 7.6, -4.5};
  ShapeHit a, b;
  ASSERT_TRUE(torus.intersect({{3, -8, 4}, d}, 0, kFar, a));
  ASSERT_TRUE(torus.intersect({{3, -8, 4}, d * 1024.0}, 0, kFar, b));
  EXPECT_NEAR(a.t, b.t * 1024, 4e-16 * a.t);
}

TEST(Torus, BoundsAreTightAndHold) {
  const shape::Torus t{1, 0.2, {5, 0, 0}, {0, 1, 0}};
  const Bounds3 box = Torus(t).bounds();
  EXPECT_LT(length(box.lo - Vec3{3.8, -0.2, -1.2}), 1e-12);
  EXPECT_LT(length(box.hi - Vec3{6.2, 0.2, 1.2}), 1e-12);
  SCOPED_TRACE("seed 108");
  Random random(108);
  for (int i = 0; i < 300; ++i) {
    const shape::Torus any{random.between(0.1, 2), random.between(0.1, 2), random.in_cube(10), random.unit()};
    const Bounds3 bounds = Torus(any).bounds();
    for (int k = 0; k < 20; ++k) EXPECT_TRUE(grown(bounds, 1e-14).contains(patch(any, random).point));
  }
}

TEST(Torus, StrangeRaysMiss) {
  const Torus torus(shape::Torus{1, .3, {0, 0, 0}, {0, 0, 1}});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ShapeHit hit;
  EXPECT_FALSE(torus.intersect({{1, 0, 5}, {0, 0, 0}}, 0, kFar, hit));
  EXPECT_FALSE(torus.intersect({{1, 0, 5}, {nan, 0, 0}}, 0, kFar, hit));
  EXPECT_FALSE(torus.intersect({{nan, 0, 5}, {0, 0, -1}}, 0, kFar, hit));
  EXPECT_FALSE(torus.intersect({{1, 0, kInf}, {0, 0, -1}}, 0, kFar, hit));
}

}  // namespace
}  // namespace rayshade
