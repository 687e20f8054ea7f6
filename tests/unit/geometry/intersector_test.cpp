// SPDX-License-Identifier: MIT
// The law of all intersectors: what culls decides which leaves are tested, never the answer.
#include "rayshade/geometry/intersector.h"

#include <gtest/gtest.h>

#include "rayshade/geometry/resolve.h"
#include "tests/unit/geometry/random_scene.h"

namespace rayshade {
namespace {

using test::Dice;
using test::RandomScene;
using test::SceneBuilder;

testing::AssertionResult same(const NearestAnswer& a, const NearestAnswer& b) {
  if (a.found != b.found) return testing::AssertionFailure() << "found " << a.found << " and " << b.found;
  if (!a.found) return testing::AssertionSuccess();
  const Hit &x = a.hit, &y = b.hit;
  bool equal = x.t() == y.t() && x.shape.a == y.shape.a && x.shape.b == y.shape.b &&
               x.shape.part == y.shape.part && x.leaf == y.leaf && x.flag == y.flag && x.rank == y.rank &&
               x.instances.count == y.instances.count;
  for (std::uint32_t i = 0; equal && i < x.instances.count; ++i)
    equal = x.instances.leaves[i] == y.instances.leaves[i];
  if (equal) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "t " << x.t() << " and " << y.t() << " (apart " << x.t() - y.t()
                                     << "), leaf " << x.leaf << " and " << y.leaf << ", rank " << x.rank
                                     << " and " << y.rank;
}

/// 100,000 rays in all.
TEST(Intersector, HierarchyEqualsBruteForceInRandomScenes) {
  constexpr int kScenes = 50, kRays = 2000;
  std::uint64_t hits = 0, occlusions = 0;
  for (int number = 0; number < kScenes; ++number) {
    const std::uint64_t seed = 1000 + static_cast<std::uint64_t>(number);
    RandomScene random(seed);
    random.motion = number % 3 == 0;
    random.fill(4 + number, 4);
    CompileOptions options;
    options.shutter = {0, 1};
    const auto scene = random.b.compile(options);
    const auto oracle = make_brute_force(*scene), hierarchy = make_hierarchy(*scene);
    TraceScratch scratch;
    for (int i = 0; i < kRays; ++i) {
      const Ray ray = random.ray(4);
      const double hi = random.dice.below(3) ? kFar : random.dice.uniform(0.1, 8);
      const Opacity mask = random.dice.below(4) ? kAnyOpacity : random.dice.below(2) ? kOpaque : kTransparent;
      const NearestAnswer truth = test::nearest(*oracle, ray, scratch, kEpsilon, hi, mask);
      const NearestAnswer answer = test::nearest(*hierarchy, ray, scratch, kEpsilon, hi, mask);
      ASSERT_TRUE(same(answer, truth)) << "seed " << seed << ", ray " << i << ", mask " << int(mask);
      hits += truth.found;
      const bool blocked = test::occluded(*oracle, ray, scratch, kEpsilon, hi, mask);
      ASSERT_EQ(test::occluded(*hierarchy, ray, scratch, kEpsilon, hi, mask), blocked)
          << "seed " << seed << ", " << i;
      // Under a narrower mask a CSG object that is both opaque and transparent may be hit but does not
      // occlude.
      ASSERT_TRUE(blocked == truth.found || (mask != kAnyOpacity && truth.found))
          << "seed " << seed << ", ray " << i;
      occlusions += blocked;
    }
  }
  EXPECT_GT(hits, 20'000u);
  EXPECT_GT(occlusions, 20'000u);
}

/// Far from the origin, tiny, huge, and seen from far away: what single precision and rounding lose must not
/// show.
TEST(Intersector, HierarchyEqualsBruteForceAtAnyScaleAndPlace) {
  constexpr int kRays = 1500;
  std::uint64_t hits = 0;
  std::uint64_t seed = 9000;
  for (const double scale : {1e-12, 1e-4, 1.0, 1e6}) {
    for (const double offset : {0.0, 1e3, 1e7}) {
      for (const double distance : {1.0, 1e3, 1e6}) {
        RandomScene random(++seed);
        random.motion = seed % 4 == 0;
        random.fill(25, 4);
        const Vec3 place{offset, -0.5 * offset, 2 * offset};
        const Affine outward = then(scaling({scale, scale, scale}), translation(scale * place));
        SceneBuilder& b = random.b;
        const NodeId all = b.moved(b.list(b.scene.world), outward);
        b.scene.world = {all};
        CompileOptions options;
        options.shutter = {0, 1};
        const auto scene = b.compile(options);
        const auto oracle = make_brute_force(*scene), hierarchy = make_hierarchy(*scene);
        TraceScratch scratch;
        for (int i = 0; i < kRays; ++i) {
          Ray ray = random.ray(4);
          ray.origin = ray.origin - (distance - 1) * 5 * ray.direction;
          ray = transformed(ray, outward);
          if (i % 2) ray.direction = normalize(ray.direction);
          const NearestAnswer truth = test::nearest(*oracle, ray, scratch, 0);
          ASSERT_TRUE(same(test::nearest(*hierarchy, ray, scratch, 0), truth))
              << "seed " << seed << ", ray " << i << ", scale " << scale << ", offset " << offset
              << ", distance " << distance;
          ASSERT_EQ(test::occluded(*hierarchy, ray, scratch, 0, kFar), truth.found)
              << "seed " << seed << ", " << i;
          hits += truth.found;
        }
      }
    }
  }
  EXPECT_GT(hits, 10'000u);
}

/// The intersectors answer spans; what one query costs is in its answer, and all costs are in the scratch.
TEST(Intersector, SpansAndCosts) {
  RandomScene random(5);
  random.fill(40, 4);
  const auto scene = random.b.compile();
  const auto hierarchy = make_hierarchy(*scene), oracle = make_brute_force(*scene);
  std::vector<NearestQuery> queries(200);
  for (NearestQuery& query : queries) {
    query.ray = random.ray(4);
    query.lo = kEpsilon;
  }
  std::vector<NearestAnswer> answers(queries.size()), truth(queries.size());
  TraceScratch scratch, oracle_scratch;
  hierarchy->nearest(queries, answers, scratch);
  oracle->nearest(queries, truth, oracle_scratch);
  std::uint64_t tests = 0, bounds_tests = 0, oracle_tests = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    EXPECT_TRUE(same(answers[i], truth[i]));
    EXPECT_TRUE(same(answers[i], test::nearest(*hierarchy, queries[i].ray, oracle_scratch)));
    tests += answers[i].tests;
    bounds_tests += answers[i].bounds_tests;
    oracle_tests += truth[i].tests;
    EXPECT_EQ(truth[i].bounds_tests, 0u);
  }
  EXPECT_EQ(scratch.counts.total_tests(), tests);
  EXPECT_EQ(scratch.counts.bounds_tests, bounds_tests);
  EXPECT_LT(tests, oracle_tests / 3);
  TraceCounts sum = scratch.counts;
  sum.add(scratch.counts);
  EXPECT_EQ(sum.total_tests(), 2 * tests);
  EXPECT_FALSE(scratch.brute_force);
}

/// exact_nearest over all leaves is the same as any intersector, and does not depend on the far limit.
TEST(Intersector, ExactNearestIsAFunctionOfTheRay) {
  RandomScene random(11);
  random.motion = true;
  random.fill(40, 4);
  CompileOptions options;
  options.shutter = {0, 1};
  const auto scene = random.b.compile(options);
  const auto hierarchy = make_hierarchy(*scene);
  TraceScratch scratch;
  int hits = 0;
  for (int i = 0; i < 1000; ++i) {
    const Ray ray = random.ray(4);
    NearestAnswer best;
    for (LeafId leaf = 0; leaf < scene->groups[0].count; ++leaf) {
      NearestAnswer one;
      one.found =
          exact_nearest(*scene, scene->groups[0].first + leaf, ray, kEpsilon, kFar, 0, scratch, one.hit);
      if (!one.found) continue;
      NearestAnswer again;
      ASSERT_TRUE(exact_nearest(*scene, scene->groups[0].first + leaf, ray, kEpsilon, one.hit.t(), 0, scratch,
                                again.hit));
      again.found = true;
      ASSERT_TRUE(same(again, one));
      ASSERT_FALSE(exact_nearest(*scene, scene->groups[0].first + leaf, ray, kEpsilon,
                                 std::nextafter(one.hit.t(), 0), 0, scratch, again.hit));
      if (!best.found || one.hit.beats(best.hit)) best = one;
    }
    ASSERT_TRUE(same(test::nearest(*hierarchy, ray, scratch), best)) << i;
    hits += best.found;
  }
  EXPECT_GT(hits, 300);
}

/// Leaves all in one place cannot be told apart: the depth must stay bounded all the same.
TEST(Hierarchy, CoincidentLeaves) {
  SceneBuilder b;
  for (int i = 0; i < 5000; ++i) b.show(b.sphere(1, {0, 0, 0}));
  for (int i = 0; i < 200; ++i) b.show(b.sphere(1, {std::ldexp(1, -i), 0, 0}));  // ever nearer to each other
  const auto scene = b.compile();
  ASSERT_TRUE(scene->groups[0].hierarchy);
  TraceScratch scratch;
  const Ray ray{{0, 0, 9}, {0, 0, -1}};
  EXPECT_TRUE(same(test::nearest(*make_hierarchy(*scene), ray, scratch),
                   test::nearest(*make_brute_force(*scene), ray, scratch)));
}

/// Rays that no box test can do arithmetic with still get an answer.
TEST(Hierarchy, AbsurdRays) {
  RandomScene random(31);
  random.fill(30, 4);
  const auto scene = random.b.compile();
  TraceScratch scratch;
  const auto hierarchy = make_hierarchy(*scene), oracle = make_brute_force(*scene);
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  for (const Vec3& origin :
       {Vec3{0, 0, 0}, Vec3{1e300, 0, 0}, Vec3{inf, 0, 0}, Vec3{nan, 1, 1}, Vec3{0, 0, 1e35}}) {
    for (const Vec3& direction : {Vec3{0, 0, 0}, Vec3{nan, 0, 0}, Vec3{0, 0, -1}, Vec3{1e-200, 0, 0},
                                  Vec3{1e200, 1e200, 0}, Vec3{inf, 0, 0}, Vec3{-1, 1e-300, 0}}) {
      const NearestAnswer a = test::nearest(*hierarchy, {origin, direction}, scratch);
      const NearestAnswer b = test::nearest(*oracle, {origin, direction}, scratch);
      EXPECT_TRUE(!is_finite(origin) || !is_finite(direction) || same(a, b))
          << origin.x << ' ' << direction.x;
    }
  }
}

}  // namespace
}  // namespace rayshade
