// SPDX-License-Identifier: MIT
// Secondary rays neither meet the surface they leave nor slip through what is behind it, for every shape, at
// any scale, at any distance from the origin, written as numbers or placed by a transform.
//
// Rays leave at an angle to the surface of at least 0.01, where the next true hit of the same shape is far
// away: a hit nearer than a thousandth of the shape (a ten-thousandth where it is squashed) is the surface
// itself (acne), and none for a ray into a closed shape is a leak. From outside a convex shape nothing may be
// hit at all, however flat the ray.
#include <gtest/gtest.h>

#include <functional>

#include "rayshade/geometry/resolve.h"
#include "tests/stress/markdown.h"
#include "tests/unit/geometry/scene_builder.h"

namespace rayshade::stress {
namespace {

using test::Dice;
using test::nearest;
using test::SceneBuilder;

constexpr double kLeastAngle = 0.01;

struct Subject {
  const char* name;
  bool convex, closed;
  /// The shape about one unit wide, around `at` (multiplied by `s`).
  std::function<NodeId(SceneBuilder&, double s, const Vec3& at)> make;
};

/// f(x) + g(y), both concave: every cell is flat, and the whole is convex from above.
std::string dome() {
  constexpr int kSize = 24;
  std::vector<float> altitudes;
  for (int j = 0; j < kSize; ++j) {
    for (int i = 0; i < kSize; ++i) altitudes.push_back(static_cast<float>(2048 - i * i - j * j) / 1024);
  }
  return test::height_field_bytes(kSize, altitudes);
}

std::vector<Subject> subjects() {
  return {
      {"sphere", true, true,
       [](SceneBuilder& b, double s, const Vec3& p) { return b.sphere(s * .5, s * p); }},
      {"box", true, true,
       [](SceneBuilder& b, double s, const Vec3& p) {
         return b.box(s * (p - Vec3{.5, .3, .4}), s * (p + Vec3{.4, .5, .1}));
       }},
      {"cylinder", true, false,
       [](SceneBuilder& b, double s, const Vec3& p) {
         return b.cylinder(s * .3, s * (p - Vec3{.2, .3, .4}), s * (p + Vec3{.3, .1, .4}));
       }},
      {"cone", true, false,
       [](SceneBuilder& b, double s, const Vec3& p) {
         return b.cone(s * .4, s * (p - Vec3{.2, .3, .4}), s * .05, s * (p + Vec3{.3, .1, .4}));
       }},
      {"torus", false, true,
       [](SceneBuilder& b, double s, const Vec3& p) {
         return b.torus(s * .4, s * .12, s * p, normalize(Vec3{.3, -.2, 1}));
       }},
      {"disc", true, false,
       [](SceneBuilder& b, double s, const Vec3& p) {
         return b.disc(s * .5, s * p, normalize(Vec3{.3, .5, -1}));
       }},
      {"plane", true, false,
       [](SceneBuilder& b, double s, const Vec3& p) {
         return b.plane(s * p, normalize(Vec3{.3, .5, -1}));
       }},
      {"triangle", true, false,
       [](SceneBuilder& b, double s, const Vec3& p) {
         return b.triangle(s * (p + Vec3{-.5, -.3, .1}), s * (p + Vec3{.5, -.2, -.2}),
                           s * (p + Vec3{.1, .5, .3}));
       }},
      {"needle", true, false,
       [](SceneBuilder& b, double s, const Vec3& p) {
         return b.triangle(s * (p + Vec3{-.5, -.3, .1}), s * (p + Vec3{.5, .2, -.2}),
                           s * (p + Vec3{0, .02, -.05}));
       }},
      {"polygon", true, false,
       [](SceneBuilder& b, double s, const Vec3& p) {
         std::vector<Vec3> points;
         for (const auto& [x, y] : {std::pair{-.5, -.4}, {.5, -.3}, {.4, .4}, {0., .1}, {-.4, .5}})
           points.push_back(s * (p + Vec3{x, y, .3 * x - .5 * y}));
         return b.polygon(std::move(points));
       }},
      {"blob", false, true,
       [](SceneBuilder& b, double s, const Vec3& p) {
         return b.blob(.5, {{1, s * .5, s * (p - Vec3{.2, 0, 0})}, {1, s * .45, s * (p + Vec3{.2, .1, .1})}});
       }},
      {"height field", true, false,
       [](SceneBuilder& b, double s, const Vec3& p) {
         return b.moved(b.height_field("dome"),
                        then(scaling({s, s, s}), translation(s * (p - Vec3{.5, .5, 1.5}))));
       }},
  };
}

enum class Placed { kWritten, kTransformed, kSkewed };
constexpr const char* kPlacedNames[] = {"numbers", "a transform", "unequal scales, turned"};

struct Counts {
  std::uint64_t rays = 0, acne = 0, into = 0, leaks = 0;
};

class Trial {
 public:
  Trial(const Subject& subject, double scale, double offset, Placed placed, std::uint64_t seed)
      : subject_(subject),
        scale_(scale),
        center_(offset * Vec3{1, -.7, .4}),
        too_near_(placed == Placed::kSkewed ? 1e-4 : 1e-3),
        dice_(seed) {
    SceneBuilder b;
    b.files.add("dome", dome());
    if (placed == Placed::kWritten) {
      b.show(subject.make(b, scale, center_));
    } else {
      Affine map = scaling({scale, scale, scale});
      if (placed == Placed::kSkewed) {
        map = then(scaling({1, .3, .7}), then(test::about({1, 2, 3}, 50), map));
      }
      b.show(b.moved(b.list({subject.make(b, 1, {})}), then(map, translation(scale * center_))));
    }
    scene_ = b.compile();
    world_ = make_brute_force(*scene_);
  }

  void run(int points, Counts& counts) {
    for (int i = 0; i < points; ++i) {
      // From outside, or from within.
      const double away = dice_.below(3) ? 3 : .2;
      Ray ray;
      ray.origin = scale_ * (center_ + away * dice_.direction());
      ray.direction = normalize(scale_ * (center_ + dice_.in_box(.4)) - ray.origin);
      const NearestAnswer seen = nearest(*world_, ray, scratch_, 0);
      if (!seen.found) continue;
      const WorldHit at = resolve_world(*scene_, seen.hit, ray, scratch_);
      const double extent = world_extent(*scene_, seen.hit);
      for (int j = 0; j < 4; ++j) leave(at, extent, counts);
    }
  }

 private:
  void leave(const WorldHit& at, double extent, Counts& counts) {
    Vec3 u, v;
    coordinate_system(at.geometric_normal, u, v);
    const bool outside = subject_.convex && (!subject_.closed || at.entering);
    const bool open_side = outside && (subject_.closed || flat() || at.entering);
    const bool down = dice_.below(4) == 0;
    const double least = open_side && !down ? 1e-7 : kLeastAngle;
    const double sine = least * fn::exp(dice_.uniform() * fn::log(1 / least)),
                 around = 2 * fn::kPi * dice_.uniform();
    const double cosine = std::sqrt(1 - sine * sine);
    const Vec3 direction = normalize(cosine * (fn::cos(around) * u + fn::sin(around) * v) +
                                     (down ? -sine : sine) * at.geometric_normal);
    const bool shadow = dice_.below(2) == 0;
    const RayStart start = secondary_start(at, direction, extent, shadow);
    const NearestAnswer met = nearest(*world_, {start.origin, direction}, scratch_, start.lo);
    ++counts.rays;
    const bool near = met.found && met.hit.t() < too_near_ * scale_;
    // Boxes and fields are met soon again near their edges, from within.
    const bool wrong = open_side && !down ? met.found : near && smooth();
    counts.acne += wrong;
    if (subject_.closed && down && at.entering) {
      ++counts.into;
      // Beside an edge, the far side may be nearer than where the ray begins.
      const Vec3 deeper = at.point + too_near_ * scale_ * direction;
      counts.leaks += !met.found && nearest(*world_, {deeper, direction}, scratch_, 0).found;
    }
  }
  bool flat() const {
    const std::string name = subject_.name;
    return name != "cylinder" && name != "cone" && name != "height field" && !subject_.closed;
  }
  bool smooth() const {
    const std::string name = subject_.name;
    return name != "box" && name != "height field";
  }

  const Subject& subject_;
  double scale_;
  Vec3 center_;
  double too_near_;
  Dice dice_;
  std::unique_ptr<CompiledScene> scene_;
  std::unique_ptr<Intersector> world_;
  TraceScratch scratch_;
};

void run(const std::string& name, const std::vector<double>& scales, const std::vector<double>& offsets,
         int points) {
  Table table(name, {"shape", "placed by", "rays", "meet their own surface", "into closed shapes", "leaks"});
  std::uint64_t seed = 4711;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  for (const Subject& subject : subjects()) {
    for (const Placed placed : {Placed::kWritten, Placed::kTransformed, Placed::kSkewed}) {
      Counts sum;
      for (const double scale : scales) {
        for (const double offset : offsets) {
          Counts counts;
          Trial(subject, scale, offset, placed, seed++).run(points, counts);
          EXPECT_GT(counts.rays, static_cast<std::uint64_t>(points) / 50);
          EXPECT_EQ(counts.acne, 0u) << subject.name << ", scale " << scale << ", " << offset
                                     << " units away, by " << kPlacedNames[static_cast<int>(placed)]
                                     << ", of " << counts.rays;
          EXPECT_EQ(counts.leaks, 0u)
              << subject.name << ", scale " << scale << ", " << offset << " units away, by "
              << kPlacedNames[static_cast<int>(placed)] << ", of " << counts.into;
          sum.rays += counts.rays;
          sum.acne += counts.acne;
          sum.into += counts.into;
          sum.leaks += counts.leaks;
        }
      }
      const auto number = [](std::uint64_t n) { return format("%llu", static_cast<unsigned long long>(n)); };
      table.add({subject.name, kPlacedNames[static_cast<int>(placed)], number(sum.rays), number(sum.acne),
                 number(sum.into), number(sum.leaks)});
    }
  }
}

TEST(AcneTest, RaysLeaveTheirSurface) { run("acne-short", {1e-6, 1e-3, 1, 1e6}, {0, 10, 1e6}, 1000); }

TEST(AcneTest, DISABLED_RaysLeaveTheirSurfaceLong) {
  run("acne", {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1, 10, 1e2, 1e3, 1e4, 1e5, 1e6},
      {0, 1, 10, 1e3, 1e4, 1e5, 1e6}, static_cast<int>(scaled_count(20000)));
}

}  // namespace
}  // namespace rayshade::stress
