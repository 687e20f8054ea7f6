// SPDX-License-Identifier: MIT
// The law of all intersectors: what culls decides which leaves are tested, never the answer.
#include "rayshade/geometry/intersector.h"

#include <gtest/gtest.h>

#include "rayshade/geometry/hierarchy.h"
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
  bool equal = x.t() == y.t() && x.shape.a == y.shape.a && x.shape.b == y.shape.b && x.shape.part == y.shape.part &&
               x.leaf == y.leaf && x.flag == y.flag && x.rank == y.rank && x.instances.count == y.instances.count;
  for (std::uint32_t i = 0; equal && i < x.instances.count; ++i) equal = x.instances.leaves[i] == y.instances.leaves[i];
  if (equal) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "t " << x.t() << " and " << y.t() << " (apart " << x.t() - y.t() << "), leaf "
                                     << x.leaf << " and " << y.leaf << ", rank " << x.rank << " and " << y.rank;
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
      ASSERT_EQ(test::occluded(*hierarchy, ray, scratch, kEpsilon, hi, mask), blocked) << "seed " << seed << ", " << i;
      // Under a narrower mask a CSG object that is both opaque and transparent may be hit but does not occlude.
      ASSERT_TRUE(blocked == truth.found || (mask != kAnyOpacity && truth.found)) << "seed " << seed << ", ray " << i;
      occlusions += blocked;
    }
  }
  EXPECT_GT(hits, 20'000u);
  EXPECT_GT(occlusions, 20'000u);
}

}  // namespace
}  // namespace rayshade
