// SPDX-License-Identifier: MIT
// Every ray that meets a primitive finds it among the candidates that its leaf offers: from the apex, toward
// it and along parallel views, one by one and in groups, in shallow and in deep cells, for root squares as
// large as the face and for very small ones.
#include <gtest/gtest.h>

#include "fas/batch.h"
#include "tests/unit/fas/scene.h"

namespace fas {
namespace {

using test::Dice;
using test::Quad;
using Place = HyperTree::Place;

struct World {
  std::vector<Geometry> primitives;
  double extent = 1;
};

World random_world(Dice& dice) {
  World out;
  out.extent = dice.below(3) ? 1 : dice.size(-6, 6);
  const Point middle = dice.below(2) ? Point{} : dice.in_box(out.extent * dice.size(0, 5));
  const int count = 1 + dice.below(dice.below(6) ? 120 : 1500);
  const double finest = dice.below(2) ? -1.5 : -6;
  // Many in a speck make deep cells.
  const double speck = dice.below(3) ? 1 : dice.size(-5, -2);
  for (int i = 0; i < count; ++i) {
    Point at = dice.in_box(out.extent * (dice.below(8) ? speck : 1));
    for (std::size_t k = 0; k < 3; ++k) at[k] += middle[k];
    out.primitives.push_back(test::random_geometry(
        dice, at, out.extent * dice.size(finest, dice.below(9) ? -1 : 0.5) * (dice.below(8) ? speck : 1)));
    if (dice.below(20) == 0) out.primitives.push_back(out.primitives.back());
  }
  return out;
}

View random_view(Dice& dice, const test::Scene& scene, const World& world) {
  const double condition = dice.below(4) ? 1 : dice.size(0, 4);
  if (dice.below(3) == 0) {
    Point d = dice.direction();
    if (dice.below(2)) d = dice.below(2) ? Point{0, 0, -1} : Point{1, 0, 0};
    return make_view(View::Kind::kParallel, d, scene.bounds(), condition);
  }
  const Geometry& any =
      world.primitives[static_cast<std::size_t>(dice.below(static_cast<int>(scene.count())))];
  Point apex{};
  for (std::size_t i = 0; i < 3; ++i)
    apex[i] = any.box.lo[i] + dice.uniform() * (any.box.hi[i] - any.box.lo[i]);
  // Within, on or in a primitive, near, or so far away that the root square is a speck.
  const int where = dice.below(6);
  if (where > 2)
    apex = test::along(apex, dice.direction(),
                       world.extent * dice.size(where == 5 ? 2 : -1, where == 5 ? 7 : 1.5));
  if (where == 2 && !any.points.empty()) apex = any.points[0];
  return make_view(View::Kind::kPoint, apex, scene.bounds(), condition);
}

/// A ray that meets a primitive at a point of its hull.
struct Shot {
  std::uint32_t primitive = 0;
  double origin[3], direction[3];
  double t = 0;  ///< rays from the apex: where, at least
  std::array<Quad, 3> at;
};

bool random_shot(Dice& dice, const test::Scene& scene, const View& view, bool from_apex, Shot& out) {
  out.primitive = static_cast<std::uint32_t>(dice.below(static_cast<int>(scene.count())));
  out.at = test::random_point(dice, scene[out.primitive], view.apex);
  const Point off = dice.direction();
  for (std::size_t i = 0; i < 3; ++i) out.at[i] += 0.24L * view.slack * off[i];
  Quad square = 0;
  if (from_apex) {
    for (std::size_t i = 0; i < 3; ++i) {
      out.origin[i] = view.apex[i];
      out.direction[i] = static_cast<double>(out.at[i] - view.apex[i]);
      square += static_cast<Quad>(out.direction[i]) * out.direction[i];
    }
    const auto length = static_cast<double>(std::sqrt(square));
    if (!(length > 0)) return false;
    const bool unit = dice.below(2) != 0;
    for (double& d : out.direction) d = unit ? d / length : d;
    out.t = unit ? length : 1;
    return true;
  }
  // Some way behind the point, passing the apex by half of what is allowed.
  const double room = 0.9 * view.reach;
  Point axis;
  double distance = 0;
  if (view.kind == View::Kind::kParallel) {
    for (std::size_t i = 0; i < 3; ++i) axis[i] = -view.direction[i];
  } else {
    for (std::size_t i = 0; i < 3; ++i) {
      axis[i] = static_cast<double>(out.at[i] - view.apex[i]);
      distance += axis[i] * axis[i];
    }
    distance = std::sqrt(distance);
    if (!(distance > 0)) return false;
    for (double& a : axis) a /= distance;
  }
  double beyond = dice.below(3) ? room * dice.size(-14, 0) : 0;
  const Point aside = dice.direction();
  for (std::size_t i = 0; i < 3; ++i) {
    out.origin[i] = static_cast<double>(out.at[i] + static_cast<Quad>(axis[i]) * beyond);
    out.direction[i] = -axis[i];
    if (view.kind == View::Kind::kPoint) out.origin[i] += 0.4 * view.aim * aside[i] * (dice.below(2) ? 1 : 0);
  }
  return aims_at(view, out.origin, out.direction, 0);
}

struct Totals {
  std::uint64_t shots = 0, tests = 0, possible = 0, deepest = 0, leaves = 0, splits = 0;
};

void shoot(std::uint64_t seed, int shots, Totals& totals) {
  Dice dice(seed);
  const World world = random_world(dice);
  const test::Scene scene(world.primitives);
  const View view = random_view(dice, scene, world);
  const bool from_apex = view.kind == View::Kind::kPoint && dice.below(2);
  Pool pool(std::size_t{64} << 20);
  Tuner tuner;
  const Split split = dice.below(3) ? Split::kAdaptive : Split::kAlways;
  HyperTree tree(view, scene, pool, tuner, 0, split);
  ThreadState state(pool);
  std::vector<Shot> group;
  LeafGroups groups;
  struct Probed {
    std::uint8_t u, v;
  };
  std::vector<Probed> probed;
  for (int i = 0; i < shots; ++i) {
    Shot shot;
    if (!random_shot(dice, scene, view, from_apex, shot)) continue;
    ++totals.shots;
    bool found = false;
    std::uint64_t tests = 0;
    const auto test = [&](std::uint32_t id) {
      found = found || id == shot.primitive;
      ++tests;
      return false;
    };
    bool occluded = false;
    const Place place = from_apex ? nearest_from_apex(
                                        tree, state, shot.direction, [&] { return shot.t; }, test)
                                  : occluded_toward(tree, state, shot.origin, test, occluded);
    ASSERT_EQ(place, Place::kLeaf) << "seed " << seed << ", shot " << i;
    ASSERT_TRUE(found) << "seed " << seed << ", shot " << i << ", form " << int(scene[shot.primitive].form)
                       << ", split " << int(split) << ", from the apex " << from_apex << ", kind "
                       << int(view.kind);
    totals.tests += tests;
    totals.possible += scene.count();
    group.push_back(shot);
    if (group.size() < 300 && i + 1 < shots) continue;

    // The same rays again, by leaf.
    groups.clear();
    probed.resize(group.size());
    for (std::uint32_t k = 0; k < group.size(); ++k) {
      const HyperTree::Query query =
          from_apex ? tree.from_apex(group[k].direction) : tree.toward(group[k].origin);
      const Leaf* leaf = nullptr;
      ASSERT_EQ(tree.find(query, state, state.cache(0), leaf, probed[k].u, probed[k].v), Place::kLeaf);
      groups.add(tree, leaf, query, k, static_cast<std::uint32_t>(group.size()));
    }
    std::vector<char> met(group.size(), 0);
    for (const LeafGroups::Group& g : groups.groups()) {
      std::uint32_t next = g.first;
      for (std::uint32_t left = g.count; left > 0;) {
        GroupProbe probe;
        std::uint32_t places[GroupProbe::kMost];
        double depths[GroupProbe::kMost];
        for (; left > 0 && probe.count < GroupProbe::kMost; --left, next = groups.next(next)) {
          const Shot& s = group[next];
          places[probe.count] = next;
          probe.u[probe.count] = probed[next].u;
          probe.v[probe.count] = probed[next].v;
          const int axis = from_apex ? tree.from_apex(s.direction).face >> 1 : 0;
          depths[probe.count++] =
              from_apex ? s.t * std::fabs(s.direction[axis]) : tree.toward(s.origin).depth;
        }
        const auto see = [&](std::uint32_t id, std::uint64_t mask) {
          for (; mask != 0; mask &= mask - 1) {
            const std::uint32_t at = places[std::countr_zero(mask)];
            if (group[at].primitive == id) met[at] = 1;
          }
          return std::uint64_t{0};
        };
        if (from_apex)
          nearest_in_group(tree, state, *g.leaf, g.any, probe, see, [&](int k) { return depths[k]; });
        else
          occluded_in_group(tree, state, *g.leaf, g.any, probe, depths, see);
      }
    }
    for (std::size_t k = 0; k < group.size(); ++k)
      ASSERT_TRUE(met[k]) << "in a group, seed " << seed << ", shot " << i << ", place " << k;
    group.clear();
  }
  EXPECT_FALSE(pool.exhausted());
  double area[6] = {}, whole[6] = {};
  std::uint64_t leaves = 0;
  tree.each_leaf([&](int face, double, double, double size, const Leaf& leaf) {
    ++leaves;
    area[face] += size * size;
    whole[face] = std::max(whole[face], std::ldexp(size, leaf.depth));
    totals.deepest = std::max<std::uint64_t>(totals.deepest, leaf.depth);
  });
  for (int face = 0; face < 6; ++face) ASSERT_LE(area[face], whole[face] * whole[face] * (1 + 1e-9));
  totals.leaves += leaves;
  totals.splits += state.cache(0).counts.splits;
  ASSERT_LE(leaves, state.cache(0).counts.leaves);
  ASSERT_EQ(state.cache(0).counts.elsewhere, 0u);
}

TEST(HyperTree, RaysFindWhatTheyMeet) {
  Totals totals;
  for (std::uint64_t seed = 1; seed <= 1'500 && !HasFailure(); ++seed) shoot(seed, 1'000, totals);
  if (HasFailure()) return;
  EXPECT_GT(totals.shots, 1'300'000u);
  EXPECT_LT(totals.tests, totals.possible / 3) << "or else nothing is left out";
  EXPECT_EQ(totals.deepest, static_cast<std::uint64_t>(HyperTree::kDeepest));
  EXPECT_GT(totals.splits, 0u);
  std::printf("%llu rays, %llu tests, %llu leaves\n", static_cast<unsigned long long>(totals.shots),
              static_cast<unsigned long long>(totals.tests), static_cast<unsigned long long>(totals.leaves));
}

/// More primitives than are looked at for the extent of the root.
TEST(HyperTree, ManyPrimitives) {
  Dice dice(77);
  World world;
  for (int i = 0; i < 40'000; ++i)
    world.primitives.push_back(test::random_geometry(dice, dice.in_box(1), dice.size(-3, -2)));
  const test::Scene scene(world.primitives);
  for (const bool far : {false, true}) {
    const View view = make_view(View::Kind::kPoint, {far ? 300.0 : 2.0, 0, 0}, scene.bounds(), 1);
    Pool pool(std::size_t{256} << 20);
    Tuner tuner;
    HyperTree tree(view, scene, pool, tuner, 0);
    ThreadState state(pool);
    std::uint64_t tests = 0;
    for (int i = 0; i < 20'000; ++i) {
      Shot shot;
      ASSERT_TRUE(random_shot(dice, scene, view, true, shot));
      bool found = false;
      const Place place = nearest_from_apex(
          tree, state, shot.direction, [&] { return shot.t; },
          [&](std::uint32_t id) {
            found = found || id == shot.primitive;
            ++tests;
            return false;
          });
      ASSERT_EQ(place, Place::kLeaf);
      ASSERT_TRUE(found) << i;
    }
    EXPECT_LT(tests, 20'000u * 200u);
  }
}

/// Opaque triangles hide what is behind them, and nothing else: nearest hits and occlusion are those of a
/// loop over all.
TEST(HyperTree, CoversHideOnlyWhatIsBehind) {
  std::uint64_t truncated = 0, hits = 0, stopped = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Dice dice(5'000 + seed);
    std::vector<Geometry> triangles;
    for (int i = 0; i < 150; ++i) {
      Geometry g;
      g.form = Geometry::Form::kPolygon;
      g.opaque = dice.below(5) != 0;
      const double size = dice.size(-2, 0.7);
      const Point at = dice.in_box(2);
      g.points = {at, test::along(at, dice.direction(), size), test::along(at, dice.direction(), size)};
      test::set_box(g);
      triangles.push_back(g);
    }
    const test::Scene scene(triangles);
    const View view = make_view(View::Kind::kPoint, dice.in_box(dice.below(2) ? 1 : 8), scene.bounds(), 1);
    Pool pool(std::size_t{64} << 20);
    Tuner tuner;
    HyperTree tree(view, scene, pool, tuner, 0, seed % 2 ? Split::kAlways : Split::kAdaptive);
    ThreadState state(pool);
    for (int i = 0; i < 2'000; ++i) {
      Shot shot;
      if (!random_shot(dice, scene, view, true, shot)) continue;
      const auto nearest = [&](std::uint32_t id, double& t, std::uint32_t& best) {
        const double at = test::triangle_hit(scene[id], shot.origin, shot.direction);
        if (!(at > 0) || at > t || (at == t && id >= best)) return false;
        t = at, best = id;
        return true;
      };
      double t = 1e30, truth_t = 1e30;
      std::uint32_t best = ~0u, truth = ~0u;
      for (std::uint32_t id = 0; id < scene.count(); ++id) nearest(id, truth_t, truth);
      const Place place = nearest_from_apex(
          tree, state, shot.direction, [&] { return t; },
          [&](std::uint32_t id) { return nearest(id, t, best); });
      ASSERT_NE(place, Place::kElsewhere);
      ASSERT_EQ(best, truth) << "seed " << seed << ", shot " << i;
      ASSERT_EQ(t, truth_t);
      hits += best != ~0u;
      // And back, from some way beyond the target.
      double o[3], d[3];
      const double along = shot.t * dice.size(-2, 1);
      for (std::size_t k = 0; k < 3; ++k) {
        o[k] = shot.origin[k] + along * shot.direction[k];
        d[k] = view.apex[k] - o[k];
      }
      if (!aims_at(view, o, d, 1)) continue;
      const auto stops = [&](std::uint32_t id) {
        const double at = test::triangle_hit(scene[id], o, d);
        return at > 1e-9 && at < 1;
      };
      bool expected = false, occluded = false;
      for (std::uint32_t id = 0; id < scene.count() && !expected; ++id) expected = stops(id);
      const Place back = occluded_toward(tree, state, o, stops, occluded);
      ASSERT_NE(back, Place::kElsewhere);
      ASSERT_EQ(occluded, expected) << "seed " << seed << ", shot " << i;
      stopped += occluded;
    }
    truncated += state.cache(0).counts.truncated;
  }
  EXPECT_GT(truncated, 1'000u);
  EXPECT_GT(hits, 50'000u);
  EXPECT_GT(stopped, 30'000u);
}

/// Directions and starts that arithmetic cannot place are the hierarchy's.
TEST(HyperTree, AbsurdRaysGoElsewhere) {
  Dice dice(3);
  Geometry ball;
  ball.form = Geometry::Form::kSpheres;
  ball.spheres = 1;
  ball.radius[0] = 1;
  test::set_box(ball);
  const test::Scene scene({ball});
  const View view = make_view(View::Kind::kPoint, {}, scene.bounds(), 1);
  Pool pool(std::size_t{1} << 20);
  Tuner tuner;
  HyperTree tree(view, scene, pool, tuner, 0);
  ThreadState state(pool);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const Point& d :
       {Point{0, 0, 0}, Point{nan, 0, 0}, Point{0, nan, 1}, Point{inf, inf, 0}, Point{-inf, 1, inf},
        Point{1e-310, 0.5e-310, 0}, Point{1e-310, 0.5e-310, 0.2e-310}, Point{0, 0, 5e-324}}) {
    bool tested = false;
    const Place place = nearest_from_apex(
        tree, state, d.data(), [] { return 1e14; }, [&](std::uint32_t) { return tested = true; });
    EXPECT_TRUE(place == Place::kElsewhere || tested) << d[0] << ' ' << d[1] << ' ' << d[2];
  }
  const double at_apex[3] = {0, 0, 0};
  bool occluded = false;
  EXPECT_EQ(occluded_toward(
                tree, state, at_apex, [](std::uint32_t) { return true; }, occluded),
            Place::kElsewhere);
  const double ahead[3] = {1, 0, 0}, off[3] = {0, 1, 0}, far[3] = {1e9, 0, 0}, toward[3] = {-1, 0, 0};
  EXPECT_TRUE(aims_at(view, ahead, toward, 1));
  EXPECT_FALSE(aims_at(view, ahead, toward, 1.001)) << "goes on behind the apex";
  EXPECT_FALSE(aims_at(view, off, toward, 1));
  EXPECT_FALSE(aims_at(view, far, toward, 1)) << "beyond the reach";
  const double not_a_number[3] = {nan, 0, 0};
  EXPECT_FALSE(aims_at(view, not_a_number, toward, 1));
}

/// An empty structure is in nobody's way.
TEST(HyperTree, NothingAtAll) {
  class Empty final : public Candidates {
   public:
    std::uint32_t count() const override { return 0; }
    Bounds bounds() const override { return {}; }
    void geometry(std::uint32_t, Geometry&) const override {}
    int open(std::uint32_t, Child (&)[kMostChildren]) const override { return 0; }
  };
  const Empty empty;
  Pool pool(std::size_t{1} << 20);
  Tuner tuner;
  HyperTree tree(make_view(View::Kind::kPoint, {}, {}, 1), empty, pool, tuner, 0);
  ThreadState state(pool);
  const double d[3] = {0.3, -1, 0.2};
  const auto test = [](std::uint32_t) { return true; };
  EXPECT_EQ(nearest_from_apex(
                tree, state, d, [] { return 1e14; }, test),
            Place::kNothing);
  bool occluded = true;
  EXPECT_EQ(occluded_toward(tree, state, d, test, occluded), Place::kNothing);
  EXPECT_FALSE(occluded);
}

}  // namespace
}  // namespace fas
