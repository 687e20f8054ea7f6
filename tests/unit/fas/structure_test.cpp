// SPDX-License-Identifier: MIT
// The public interface: whatever the class that a ray is said to be of, alone or with others, the answer is
// that of testing every primitive.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "fas/fas.h"
#include "tests/unit/fas/random_geometry.h"

namespace fas {
namespace {

using test::Dice;

/// Balls and boxes, some without bounds (a floor), some that are nowhere.
class Things final : public Primitives {
 public:
  explicit Things(Dice& dice, int count) {
    for (int i = 0; i < count; ++i) {
      Thing thing;
      thing.center = dice.in_box(10);
      thing.size = dice.size(-3, 0.3);
      thing.ball = dice.below(2) != 0;
      if (i > 0 && dice.below(12) == 0) thing = things_[static_cast<std::size_t>(dice.below(i))];
      if (dice.below(40) == 0) thing.nowhere = true;
      things_.push_back(thing);
    }
    if (count > 0 && dice.below(2)) things_[static_cast<std::size_t>(dice.below(count))].floor = true;
  }
  std::uint32_t count() const override { return static_cast<std::uint32_t>(things_.size()); }
  void geometry(std::uint32_t i, Geometry& out) const override {
    const Thing& thing = things_[i];
    constexpr double kInf = std::numeric_limits<double>::infinity();
    out.form = Geometry::Form::kBox;
    if (thing.nowhere) {
      out.box = {{1, 1, 1}, {0, 0, 0}};
      return;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      out.box.lo[k] = thing.center[k] - thing.size;
      out.box.hi[k] = thing.center[k] + thing.size;
    }
    if (thing.floor) out.box = {{-kInf, -kInf, out.box.lo[2]}, {kInf, kInf, out.box.lo[2]}};
    if (thing.floor || !thing.ball) return;
    out.form = Geometry::Form::kSpheres;
    out.spheres = 1;
    out.center[0] = thing.center;
    out.radius[0] = thing.size;
  }
  bool intersect(std::uint32_t i, const Ray& ray, double limit, double& t) const override {
    const Thing& thing = things_[i];
    if (thing.nowhere) return false;
    if (thing.floor) {
      t = (thing.center[2] - thing.size - ray.origin[2]) / ray.direction[2];
      return t >= ray.near && t <= limit;
    }
    return (thing.ball ? ball(thing, ray, t) : box(thing, ray, t)) && t <= limit;
  }

 private:
  struct Thing {
    Point center{};
    double size = 1;
    bool ball = false, floor = false, nowhere = false;
  };
  static bool ball(const Thing& s, const Ray& ray, double& t) {
    double a = 0, b = 0, c = -s.size * s.size;
    for (std::size_t k = 0; k < 3; ++k) {
      const double o = ray.origin[k] - s.center[k];
      a += ray.direction[k] * ray.direction[k];
      b += ray.direction[k] * o;
      c += o * o;
    }
    const double root = std::sqrt(b * b - a * c);
    for (const double x : {(-b - root) / a, (-b + root) / a}) {
      t = x;
      if (t >= ray.near) return true;
    }
    return false;
  }
  static bool box(const Thing& s, const Ray& ray, double& t) {
    double in = ray.near, out = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
      const double lo = s.center[k] - s.size - ray.origin[k], hi = s.center[k] + s.size - ray.origin[k];
      if (ray.direction[k] == 0) {
        if (lo > 0 || hi < 0) return false;
        continue;
      }
      const double a = lo / ray.direction[k], b = hi / ray.direction[k];
      in = std::max(in, std::min(a, b));
      out = std::min(out, std::max(a, b));
    }
    t = in;
    return in <= out;
  }
  std::vector<Thing> things_;
};

Hit by_hand(const Primitives& all, const Ray& ray) {
  Hit best{ray.far, Hit::kNone};
  for (std::uint32_t i = 0; i < all.count(); ++i) {
    double t = 0;
    if (all.intersect(i, ray, ray.far, t) && (best.primitive == Hit::kNone || t < best.t)) best = {t, i};
  }
  return best;
}

/// A structure with a class of every kind, and rays of each, with some that do not belong.
struct Scene {
  Scene(std::uint64_t seed, const Options& options)
      : dice(seed), things(dice, 1 + dice.below(400)), structure(things, options) {
    eye = dice.in_box(20);
    lamp = dice.in_box(15);
    sun = dice.direction();
    lens = {dice.in_box(20), {}};
    for (std::size_t k = 0; k < 3; ++k) lens.hi[k] = lens.lo[k] + (k == 2 ? 0 : dice.uniform());
    classes = {structure.rays_from(eye),  structure.rays_toward(lamp), structure.rays_along(sun),
               structure.rays_from(lens), structure.rays_toward(lens), structure.rays()};
  }
  Point in_lens() {
    Point p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = dice.uniform(lens.lo[k], lens.hi[k]);
    return p;
  }
  Ray ray(std::size_t of) {
    Ray out;
    out.origin = of == 0 ? eye : of == 3 ? in_lens() : dice.in_box(12);
    Point target = of == 1 ? lamp : of == 4 ? in_lens() : dice.in_box(10);
    for (std::size_t k = 0; k < 3; ++k) out.direction[k] = target[k] - out.origin[k];
    if (of == 2) out.direction = sun;
    if (of == 1 || of == 4) out.far = 1;
    out.near = dice.below(3) == 0 ? 1e-3 : 0;
    if (of != 1 && of != 4 && dice.below(4) == 0) out.far = dice.uniform(0, 2);
    if (dice.below(20) == 0) out.direction = dice.direction();  // does not belong
    if (dice.below(50) == 0) out.direction[static_cast<std::size_t>(dice.below(3))] = 0;
    return out;
  }
  Dice dice;
  Things things;
  Structure structure;
  Point eye, lamp, sun;
  Bounds lens;
  std::vector<RayClass> classes;
};

TEST(Structure, AnswersAsTestingEverything) {
  std::uint64_t through_trees = 0, hits = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Options options;
    options.always_split = seed % 2 == 0;
    if (seed % 5 == 0) options.memory = std::size_t{512} << 10;
    Scene scene(seed, options);
    Tracer tracer(scene.structure);
    for (std::size_t of = 0; of < scene.classes.size(); ++of) {
      for (int round = 0; round < 3; ++round) {
        std::vector<Ray> rays;
        for (int i = scene.dice.below(500); i >= 0; --i) rays.push_back(scene.ray(of));
        std::vector<Hit> found(rays.size());
        std::vector<std::uint8_t> occluded(rays.size());
        tracer.nearest(scene.classes[of], rays, found);
        tracer.occluded(scene.classes[of], rays, occluded);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const Hit truth = by_hand(scene.things, rays[i]);
          ASSERT_EQ(found[i].primitive, truth.primitive)
              << "seed " << seed << " class " << of << " ray " << i;
          ASSERT_EQ(found[i].t, truth.t);
          ASSERT_EQ(occluded[i] != 0, truth.primitive != Hit::kNone);
          hits += truth.primitive != Hit::kNone;
          if (i % 16 != 0) continue;
          Hit alone;
          ASSERT_EQ(tracer.nearest(scene.classes[of], rays[i], alone), truth.primitive != Hit::kNone);
          ASSERT_EQ(alone.primitive, truth.primitive);
          ASSERT_EQ(alone.t, truth.t);
          ASSERT_EQ(tracer.occluded(scene.classes[of], rays[i]), truth.primitive != Hit::kNone);
        }
      }
      through_trees += tracer.statistics(scene.classes[of]).rays;
    }
  }
  EXPECT_GT(through_trees, 100'000u);
  EXPECT_GT(hits, 50'000u);
}

TEST(Structure, IsUsedByManyThreadsAtOnce) {
  Scene scene(77, {});
  std::vector<Ray> rays;
  for (int i = 0; i < 3000; ++i) rays.push_back(scene.ray(static_cast<std::size_t>(i) / 500));
  std::vector<Hit> truth;
  for (const Ray& ray : rays) truth.push_back(by_hand(scene.things, ray));
  std::atomic<int> wrong{0};
  for (int frame = 0; frame < 2; ++frame) {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&] {
        Tracer tracer(scene.structure);
        std::vector<Hit> found(500);
        for (std::size_t of = 0; of < 6; ++of) {
          tracer.nearest(scene.classes[of], std::span(rays).subspan(500 * of, 500), found);
          for (std::size_t i = 0; i < 500; ++i)
            wrong +=
                found[i].primitive != truth[500 * of + i].primitive || found[i].t != truth[500 * of + i].t;
        }
      });
    }
    threads.clear();
    EXPECT_GT(scene.structure.tree_bytes(), 0u);
    scene.structure.clear();
    EXPECT_EQ(scene.structure.tree_bytes(), 0u);
  }
  EXPECT_EQ(wrong, 0);
}

TEST(Structure, OfNothing) {
  Dice dice(1);
  const Things none(dice, 0);
  Structure structure(none);
  EXPECT_GT(structure.bounds().lo[0], structure.bounds().hi[0]);
  const RayClass eye = structure.rays_from(Point{});
  Tracer tracer(structure);
  Hit hit;
  EXPECT_FALSE(tracer.nearest(eye, {{0, 0, 0}, {0, 0, 1}}, hit));
  EXPECT_EQ(hit.primitive, Hit::kNone);
  EXPECT_FALSE(tracer.occluded(structure.rays(), {{0, 0, 0}, {0, 0, 1}}));
}

TEST(Structure, RefusesBoxesThatAreNotNumbers) {
  struct Bad final : Primitives {
    std::uint32_t count() const override { return 1; }
    void geometry(std::uint32_t /*i*/, Geometry& out) const override {
      out.box = {{0, std::nan(""), 0}, {1, 1, 1}};
    }
    bool intersect(std::uint32_t, const Ray&, double, double&) const override { return false; }
  };
  EXPECT_THROW(Structure{Bad{}}, std::invalid_argument);
}

}  // namespace
}  // namespace fas
