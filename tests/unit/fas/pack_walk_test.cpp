// SPDX-License-Identifier: MIT
// Packs of rays meet what their rays meet alone, on every processor.
#include "fas/pack_walk.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "tests/unit/fas/random_hierarchy.h"
#include "tests/unit/fas/targets.h"

namespace fas {
namespace {

using test::aim;
using test::Built;
using test::Dice;
using test::random_boxes;
using Mask = PackProbe::Mask;
constexpr double kFar = 1e100;

template <class Value>
bool same_bits(const Value& a, const Value& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// Rays of one octant, each toward a box.
struct Rays {
  alignas(64) double origin[3][PackProbe::kMost], direction[3][PackProbe::kMost],
      inverse[3][PackProbe::kMost], size[PackProbe::kMost], lo[PackProbe::kMost], hi[PackProbe::kMost];
  std::vector<ClipRay> single;
  std::vector<std::uint32_t> target;  ///< number of the box
  std::vector<double> reach;          ///< t in it

  Rays(Dice& dice, const std::vector<Bounds>& boxes, int count, bool extreme) {
    const Point signs{dice.below(2) ? 1.0 : -1.0, dice.below(2) ? 1.0 : -1.0, dice.below(2) ? 1.0 : -1.0};
    const bool together = dice.below(2) != 0;  // coherent ones toward one box
    const auto common = static_cast<std::uint32_t>(dice.below(static_cast<int>(boxes.size())));
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const auto at =
          together ? common : static_cast<std::uint32_t>(dice.below(static_cast<int>(boxes.size())));
      double o[3], d[3], t = 0;
      aim(dice, boxes[at], o, d, t);
      for (std::size_t axis = 0; axis < 3; ++axis) {  // mirrored into the octant, through the same point
        const double there = o[axis] + t * d[axis];
        d[axis] = std::copysign(d[axis], signs[axis]);
        o[axis] = there - t * d[axis];
      }
      if (extreme && dice.below(8) == 0) {
        const double odd[] = {1e200, 1e300, std::nan(""), HUGE_VAL, 0};
        (dice.below(2) ? o : d)[dice.below(3)] = std::copysign(odd[dice.below(5)], signs[0]);
        for (std::size_t axis = 0; axis < 3; ++axis) d[axis] = std::copysign(d[axis], signs[axis]);
      }
      single.emplace_back(o, d);
      target.push_back(at);
      reach.push_back(t);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        origin[axis][k] = o[axis];
        direction[axis][k] = d[axis];
        inverse[axis][k] = single[k].inverse[axis];
      }
      size[k] = single[k].size;
      lo[k] = 0;
      hi[k] = dice.below(2) ? kFar : t * (dice.below(3) == 0 ? dice.uniform() : 1);
    }
  }
  PackRays pack() const {
    return {{origin[0], origin[1], origin[2]},
            {direction[0], direction[1], direction[2]},
            {inverse[0], inverse[1], inverse[2]},
            size,
            lo,
            hi,
            static_cast<int>(single.size())};
  }
};

class PackWalkTest : public test::TargetTest {
 protected:
  /// What the target under test goes through.
  static std::vector<std::pair<std::uint32_t, Mask>> runs(const Hierarchy& hierarchy, PackProbe& probe,
                                                          std::uint8_t opacity, Mask alive) {
    std::vector<std::pair<std::uint32_t, Mask>> out;
    PackWalk walk(alive);
    BitCounts counts;
    for (;;) {
      Mask rays = 0;
      const std::uint32_t child =
          pack_next(hierarchy.nodes().data(), probe, opacity, alive, walk, counts, rays);
      if (child == Hierarchy::kEnd) return out;
      out.emplace_back(child, rays);
    }
  }
};

TEST_P(PackWalkTest, ProbesAreThoseOfSingleRays) {
  Dice dice(31);
  std::size_t compared = 0, missed = 0, odd = 0;
  for (int scene = 0; scene < 300; ++scene) {
    const Built built(random_boxes(dice, 1 + dice.below(50)));
    const ClipBox& box = built.hierarchy.clip_box();
    const Rays rays(dice, random_boxes(dice, 20), 1 + dice.below(PackProbe::kMost), true);
    PackProbe probe;
    Mask met = 0, unusable = 0;
    make_probes(box, 1.5, rays.pack(), probe, met, unusable);
    EXPECT_EQ(unusable & ~met, 0u);
    for (std::size_t i = 0; i < rays.single.size(); ++i) {
      BoxProbe one;
      ASSERT_EQ(make_probe(box, 1.5, rays.single[i], rays.lo[i], rays.hi[i], one), (met >> i & 1) != 0);
      missed += (met >> i & 1) == 0;
      if ((met >> i & 1) == 0) continue;
      odd += (unusable >> i & 1) != 0;
      // Those that are not a number need not be told apart from those out of range.
      if (!one.usable) {
        ASSERT_NE(unusable >> i & 1, 0u);
      }
      if ((unusable >> i & 1) != 0) continue;
      const BoxProbe lane = probe.ray(i);
      ASSERT_TRUE(same_bits(lane.near_origin, one.near_origin) &&
                  same_bits(lane.far_origin, one.far_origin) && same_bits(lane.inverse, one.inverse) &&
                  same_bits(lane.near_side, one.near_side) && same_bits(lane.slack, one.slack) &&
                  same_bits(lane.entry, one.entry) && same_bits(lane.scale, one.scale));
      ASSERT_EQ(probe.limit[i], one.limit(rays.hi[i]));
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000u);
  EXPECT_GT(missed, 100u);
  EXPECT_GT(odd, 50u);
}

/// With limits that do not change, every ray visits exactly the runs that it visits alone; and all targets
/// go through the same in the same order.
TEST_P(PackWalkTest, RaysVisitWhatTheyVisitAlone) {
  Dice dice(32);
  std::size_t visits = 0, shared = 0;
  for (int scene = 0; scene < 60; ++scene) {
    const std::vector<Bounds> boxes = random_boxes(dice, 1 + dice.below(400));
    std::vector<std::uint8_t> masks(boxes.size());
    for (std::uint8_t& mask : masks) mask = static_cast<std::uint8_t>(1 + dice.below(3));
    const Built built(boxes, masks);
    for (int pack = 0; pack < 8; ++pack) {
      const Rays rays(dice, boxes, 1 + dice.below(PackProbe::kMost), pack % 2 == 0);
      PackProbe probe;
      Mask met = 0, unusable = 0;
      make_probes(built.hierarchy.clip_box(), 1, rays.pack(), probe, met, unusable);
      const Mask alive = met & ~unusable;
      if (alive == 0) continue;
      const auto opacity = static_cast<std::uint8_t>(1 + dice.below(3));
      std::vector<std::vector<std::uint32_t>> together(rays.single.size()), alone(rays.single.size());
      const auto visit = [&](std::uint32_t first, std::uint32_t /*count*/, Mask some) {
        shared += std::popcount(some) > 1;
        for (; some != 0; some &= some - 1)
          together[static_cast<std::size_t>(std::countr_zero(some))].push_back(first);
        return Mask{0};
      };
      BitCounts box_tests;
      traverse(built.hierarchy, probe, opacity, alive, box_tests, visit);
      for (std::size_t i = 0; i < rays.single.size(); ++i) {
        if ((alive >> i & 1) == 0) {
          EXPECT_TRUE(together[i].empty());
          continue;
        }
        const BoxProbe one = probe.ray(i);
        std::uint32_t tests = 0;
        traverse(
            built.hierarchy, {}, one, opacity, tests, [&] { return rays.hi[i]; },
            [&](std::uint32_t first, std::uint32_t /*count*/) {
              alone[i].push_back(first);
              return false;
            });
        std::sort(together[i].begin(), together[i].end());
        std::sort(alone[i].begin(), alone[i].end());
        ASSERT_EQ(together[i], alone[i]) << "scene " << scene << " pack " << pack << " ray " << i;
        EXPECT_EQ(box_tests.of(i), tests);
        visits += alone[i].size();
      }
      // The target under test against the one that the processor chose.
      const auto of_target = runs(built.hierarchy, probe, opacity, alive);
      pretend_targets(0);
      const auto of_best = runs(built.hierarchy, probe, opacity, alive);
      pretend_targets(GetParam());
      ASSERT_EQ(of_target, of_best);
    }
  }
  EXPECT_GT(visits, 10'000u);
  EXPECT_GT(shared, 500u);
}

/// However limits shrink on the way, as long as they stay beyond what a ray is for, it gets there; and a ray
/// that needs nothing more is not asked about again.
TEST_P(PackWalkTest, ShortenedRaysStillArrive) {
  Dice dice(33);
  std::size_t arrived = 0;
  for (int scene = 0; scene < 100; ++scene) {
    const std::vector<Bounds> boxes = random_boxes(dice, 1 + dice.below(300));
    const Built built(boxes);
    const Rays rays(dice, boxes, 1 + dice.below(PackProbe::kMost), false);
    PackProbe probe;
    Mask met = 0, unusable = 0;
    Rays open = rays;
    std::fill(std::begin(open.hi), std::end(open.hi), kFar);
    make_probes(built.hierarchy.clip_box(), 1, open.pack(), probe, met, unusable);
    EXPECT_EQ(met & ~unusable,
              rays.pack().count == PackProbe::kMost ? ~Mask{0} : (Mask{1} << rays.pack().count) - 1);
    Mask done = 0;
    BitCounts box_tests;
    traverse(built.hierarchy, probe, 1, met, box_tests,
             [&](std::uint32_t first, std::uint32_t count, Mask some) {
               EXPECT_EQ(some & done, 0u);
               EXPECT_NE(some, 0u);
               Mask now = 0;
               for (Mask left = some; left != 0; left &= left - 1) {
                 const auto i = static_cast<std::size_t>(std::countr_zero(left));
                 if (dice.below(2)) probe.shorten(i, rays.reach[i] * (dice.below(2) ? 1 : 2));
                 for (std::uint32_t k = first; k < first + count; ++k)
                   if (built.order[k] == rays.target[i]) now |= Mask{1} << i;
               }
               arrived += static_cast<std::size_t>(std::popcount(now));
               done |= now;
               return now;
             });
    ASSERT_EQ(done, met);
  }
  EXPECT_GT(arrived, 2000u);
}

INSTANTIATE_TEST_SUITE_P(Targets, PackWalkTest, testing::ValuesIn(test::targets()), test::target_name);

TEST(BitCounts, CountEveryRayOfEveryMask) {
  Dice dice(34);
  BitCounts counts;
  for (const int masks : {0, 1, 100, 255, 300, 3000}) {
    std::array<std::uint32_t, 64> plain{}, sums{};
    counts.clear();
    for (int i = 0; i < masks; ++i) {
      const Mask mask = dice.below(3) == 0 ? ~Mask{0} : static_cast<Mask>(dice.uniform() * 0x1p64);
      counts.add(mask);
      for (std::size_t ray = 0; ray < 64; ++ray) plain[ray] += static_cast<std::uint32_t>(mask >> ray & 1);
    }
    std::uint64_t total = 0;
    counts.add_to(sums);
    counts.add_to(sums);
    for (std::size_t ray = 0; ray < 64; ++ray) {
      EXPECT_EQ(counts.of(ray), plain[ray]);
      EXPECT_EQ(sums[ray], 2 * plain[ray]);
      total += plain[ray];
    }
    EXPECT_EQ(counts.total(), total);
  }
}

}  // namespace
}  // namespace fas
