// SPDX-License-Identifier: MIT
// Five-dimensional trees: a ray that meets a box finds it below the cut of its cell, however deep the cells.
#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "fas/beam_tree.h"
#include "tests/unit/fas/random_geometry.h"

namespace fas {
namespace {

using test::Dice;
constexpr double kFar = 1e100;

Bounds around(const std::vector<Bounds>& boxes) {
  Bounds all = boxes[0];
  for (const Bounds& box : boxes) {
    test::add(all, box.lo);
    test::add(all, box.hi);
  }
  return all;
}

/// A structure of boxes, and rays through them.
struct World {
  World(std::uint64_t seed, int count) : dice(seed) {
    const double scale = dice.size(-5, 5);
    const Point shift = dice.below(2) ? dice.in_box(50) : Point{};
    for (int i = 0; i < count; ++i) {
      Point at = dice.in_box(10);
      Bounds box{at, at};
      const double size = dice.size(-4, 0.3);
      for (double& x : box.hi) x += dice.below(4) == 0 ? 0 : size * dice.uniform();
      for (std::size_t k = 0; k < 3; ++k) {
        box.lo[k] = scale * (box.lo[k] + shift[k]);
        box.hi[k] = scale * (box.hi[k] + shift[k]);
      }
      boxes.push_back(box);
    }
    masks.assign(boxes.size(), 1);
    hierarchy = std::make_unique<Hierarchy>(boxes, masks, 1, order);
    origins = around(boxes);
    if (dice.below(2)) {  // a lens or a lamp, perhaps flat, perhaps outside
      const Point corner = dice.in_box(dice.below(2) ? 10 : 30);
      origins = {corner, corner};
      for (std::size_t k = 0; k < 3; ++k) {
        origins.hi[k] += dice.below(3) == 0 ? 0 : dice.uniform();
        origins.lo[k] = scale * (origins.lo[k] + shift[k]);
        origins.hi[k] = scale * (origins.hi[k] + shift[k]);
      }
      narrow = true;
    }
  }

  /// A ray to a point of a box (returned), often a corner, that starts among the origins or, where those are
  /// the whole, perhaps far outside.
  std::uint32_t aim(Dice& from, double* o, double* d) const {
    const auto box = static_cast<std::uint32_t>(from.below(static_cast<int>(boxes.size())));
    const bool outside = !narrow && from.below(3) == 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double share = from.below(2) ? from.uniform() : from.below(2);
      o[k] = origins.lo[k] + share * (origins.hi[k] - origins.lo[k]);
    }
    if (outside) {
      const Point away = from.direction();
      double size = 0;
      for (std::size_t k = 0; k < 3; ++k) size = std::max(size, origins.hi[k] - origins.lo[k]);
      for (std::size_t k = 0; k < 3; ++k) o[k] += 3 * size * away[k];
    }
    double square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double share = from.below(2) ? from.uniform() : from.below(2);
      d[k] = boxes[box].lo[k] + share * (boxes[box].hi[k] - boxes[box].lo[k]) - o[k];
      square += d[k] * d[k];
    }
    if (!(square > 0)) {
      d[0] = 1, d[1] = d[2] = 0;
      return box;
    }
    for (std::size_t k = 0; k < 3; ++k) d[k] /= std::sqrt(square);
    return box;
  }

  /// Whether the traversal of a ray from a cut comes by a box.
  bool comes_by(const double* o, const double* d, const Cut& cut, std::uint32_t box) const {
    BoxProbe probe;
    if (!make_probe(hierarchy->clip_box(), 1, ClipRay(o, d), 0, kFar, probe) || !probe.usable) return false;
    bool found = false;
    std::uint32_t tests = 0;
    traverse(
        *hierarchy, cut, probe, 1, tests, [] { return kFar; },
        [&](std::uint32_t first, std::uint32_t count) {
          for (std::uint32_t k = first; k < first + count; ++k) found |= order[k] == box;
          return found;
        });
    return found;
  }

  Dice dice;
  std::vector<Bounds> boxes;
  std::vector<std::uint8_t> masks;
  std::vector<std::uint32_t> order;
  std::unique_ptr<Hierarchy> hierarchy;
  Bounds origins;
  bool narrow = false;
};

TEST(BeamTree, CutsLeaveNothingOut) {
  std::uint64_t splits = 0, placed = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    World world(seed, static_cast<int>(1 + seed * seed % 400));
    Pool pool(std::size_t{64} << 20);
    Tuner tuner;
    ThreadState state(pool);
    BeamTree tree(*world.hierarchy, world.origins, 1, pool, tuner, 0, Split::kAlways);
    BeamCache& cache = state.beam_cache(0);
    double o[3], d[3];
    std::uint32_t box = 0;
    for (int i = 0; i < 4000; ++i) {
      // Now and then a ray close to the one before: cells must get small, and the last leaf must be right.
      if (i == 0 || world.dice.below(3) == 0) {
        box = world.aim(world.dice, o, d);
      } else {
        for (double& x : d) x += 1e-9 * world.dice.uniform(-1, 1);
      }
      BeamTree::Query query;
      if (!tree.enter(o, d, query)) continue;
      ++placed;
      const bool expected = world.comes_by(o, d, {}, box);
      const BeamLeaf& leaf = tree.find(query, cache);
      ASSERT_EQ(world.comes_by(o, d, leaf.cut, box), expected) << "seed " << seed << " ray " << i;
      tree.charge(query, state, cache, leaf, 20, 5, true);
    }
    splits += cache.counts.splits;
  }
  EXPECT_GT(placed, 180'000u);
  EXPECT_GT(splits, 30'000u);
}

TEST(BeamTree, RefusesWhatStartsElsewhere) {
  World world(3, 50);
  Pool pool(std::size_t{1} << 20);
  Tuner tuner;
  const Bounds lens{{-1, -1, 5}, {1, 1, 5}};
  const BeamTree tree(*world.hierarchy, lens, 1, pool, tuner, 0, Split::kAdaptive);
  BeamTree::Query query;
  const double inside[3] = {0.5, -0.5, 5}, beside[3] = {1.5, 0, 5}, down[3] = {0, 0, -1}, none[3] = {0, 0, 0};
  const double nan = std::numeric_limits<double>::quiet_NaN(), lost[3] = {0, nan, -1};
  EXPECT_TRUE(tree.place(inside, down, query));
  EXPECT_EQ(query.face, 5);
  EXPECT_FALSE(tree.place(beside, down, query));
  EXPECT_FALSE(tree.enter(beside, down, query));
  EXPECT_FALSE(tree.place(inside, none, query));
  EXPECT_FALSE(tree.place(inside, lost, query));
  EXPECT_FALSE(tree.enter(inside, lost, query));
}

TEST(BeamTree, StopsGrowingWhereMemoryEnds) {
  World world(5, 400);
  Pool pool(std::size_t{1} << 20);
  Tuner tuner;
  ThreadState state(pool);
  BeamTree tree(*world.hierarchy, world.origins, 1, pool, tuner, 0, Split::kAlways);
  BeamCache& cache = state.beam_cache(0);
  for (int i = 0; i < 100'000; ++i) {
    double o[3], d[3];
    const std::uint32_t box = world.aim(world.dice, o, d);
    BeamTree::Query query;
    if (!tree.enter(o, d, query)) continue;
    const BeamLeaf& leaf = tree.find(query, cache);
    ASSERT_EQ(world.comes_by(o, d, leaf.cut, box), world.comes_by(o, d, {}, box));
    tree.charge(query, state, cache, leaf, 20, 5, true);
  }
  EXPECT_GT(cache.counts.splits, 100u);
  EXPECT_LE(pool.held(), pool.budget());
}

TEST(BeamTree, IsGrownByManyThreadsAtOnce) {
  World world(8, 300);
  Pool pool(std::size_t{64} << 20);
  Tuner tuner;
  BeamTree tree(*world.hierarchy, world.origins, 1, pool, tuner, 0, Split::kAlways);
  std::atomic<int> wrong{0};
  const auto work = [&](std::uint64_t seed) {
    ThreadState state(pool);
    BeamCache& cache = state.beam_cache(0);
    Dice dice(seed);
    for (int i = 0; i < 5000; ++i) {
      double o[3], d[3];
      const std::uint32_t box = world.aim(dice, o, d);
      BeamTree::Query query;
      if (!tree.enter(o, d, query)) continue;
      const BeamLeaf& leaf = tree.find(query, cache);
      wrong += world.comes_by(o, d, leaf.cut, box) != world.comes_by(o, d, {}, box);
      tree.charge(query, state, cache, leaf, 20, 5, true);
    }
  };
  {
    std::vector<std::jthread> threads;
    for (std::uint64_t t = 0; t < 4; ++t) threads.emplace_back(work, t % 2);
  }
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace fas
