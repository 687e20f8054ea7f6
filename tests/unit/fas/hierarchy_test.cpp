// SPDX-License-Identifier: MIT
// What the hierarchy leaves out is certainly not met; what it visits is the same on every processor.
#include "fas/hierarchy.h"

#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "fas/hierarchy_candidates.h"
#include "tests/unit/fas/random_hierarchy.h"
#include "tests/unit/fas/targets.h"

namespace fas {
namespace {

using test::aim;
using test::Built;
using test::Dice;
using test::random_boxes;
constexpr double kFar = 1e100;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::vector<std::uint32_t> visits(const Hierarchy& hierarchy, const WalkKernel& kernel, const BoxProbe& probe,
                                  float far, std::uint8_t mask, std::uint32_t& tests) {
  std::vector<std::uint32_t> out;
  Walk walk;
  for (;;) {
    const std::uint32_t child = kernel.next(hierarchy.nodes().data(), probe, far, mask, walk);
    tests = walk.box_tests;
    if (child == Hierarchy::kEnd) return out;
    out.push_back(child);
    far *= 0.99f;  // as if something had been hit
  }
}

class WalkTest : public test::TargetTest {};

TEST_P(WalkTest, VisitsWhatTheScalarTwinVisitsInTheSameOrder) {
  const WalkKernel kernel = dispatched_walk_kernel();
  ASSERT_STREQ(kernel.name, hwy::TargetName(GetParam()));
  Dice dice(21);
  std::size_t visited = 0;
  for (int scene = 0; scene < 60; ++scene) {
    const std::vector<Bounds> boxes = random_boxes(dice, 1 + dice.below(400));
    std::vector<std::uint8_t> masks(boxes.size());
    for (std::uint8_t& mask : masks) mask = static_cast<std::uint8_t>(1 + dice.below(3));
    const Built built(boxes, masks);
    for (int i = 0; i < 300; ++i) {
      double o[3], d[3], t = 0;
      aim(dice, boxes[static_cast<std::size_t>(dice.below(static_cast<int>(boxes.size())))], o, d, t);
      BoxProbe probe;
      if (!make_probe(built.hierarchy.clip_box(), 1, ClipRay(o, d), 0, kFar, probe)) continue;
      const float far = probe.limit(dice.below(2) ? kFar : t * dice.uniform(0, 2));
      const auto mask = static_cast<std::uint8_t>(1 + dice.below(3));
      std::uint32_t tests = 0, scalar_tests = 0;
      const auto a = visits(built.hierarchy, kernel, probe, far, mask, tests);
      const auto b = visits(built.hierarchy, scalar_walk_kernel(), probe, far, mask, scalar_tests);
      ASSERT_EQ(a, b);
      ASSERT_EQ(tests, scalar_tests);
      visited += a.size();
    }
  }
  EXPECT_GT(visited, 10'000u);
}

INSTANTIATE_TEST_SUITE_P(Targets, WalkTest, testing::ValuesIn(test::targets()), test::target_name);

/// No box that the ray meets in exact arithmetic is left out, whatever the zeros and signs of its direction;
/// boxes are often tiny, or at the border of the whole, where the ray has just entered: there the distance is
/// small, but the coordinates that it comes from are not.
TEST(Hierarchy, IsConservative) {
  Dice dice(22);
  int rays = 0;
  for (int scene = 0; scene < 120; ++scene) {
    const double scale = dice.size(-6, 6);
    const Point shift = dice.below(2) ? dice.in_box(100) : Point{};
    std::vector<Bounds> boxes = random_boxes(dice, 1 + dice.below(200));
    for (Bounds& box : boxes) {
      for (std::size_t i = 0; i < 3; ++i) {
        box.lo[i] = (box.lo[i] + shift[i]) * scale;
        box.hi[i] = (box.hi[i] + shift[i]) * scale;
      }
    }
    const Built built(boxes);
    for (int i = 0; i < 1000; ++i) {
      const auto at = static_cast<std::uint32_t>(dice.below(static_cast<int>(boxes.size())));
      double o[3], d[3], t = 0;
      aim(dice, boxes[at], o, d, t);
      ASSERT_TRUE(may_meet(ClipBox(boxes[at]), 1, ClipRay(o, d), 0, t));
      BoxProbe probe;
      ASSERT_TRUE(make_probe(built.hierarchy.clip_box(), 1, ClipRay(o, d), 0, kFar, probe));
      ASSERT_TRUE(probe.usable);
      bool found = false;
      std::uint32_t tests = 0;
      traverse(
          built.hierarchy, {}, probe, 1, tests, [&] { return t; },
          [&](std::uint32_t first, std::uint32_t count) {
            for (std::uint32_t k = first; k < first + count; ++k) found |= built.order[k] == at;
            return false;
          });
      ASSERT_TRUE(found) << "scene " << scene << " ray " << i;
      ++rays;
    }
  }
  EXPECT_EQ(rays, 120'000);
}

/// Every box once, within all boxes above it, under a mask that has its bits.
TEST(Hierarchy, HoldsEveryBoxOnce) {
  Dice dice(23);
  for (const int count : {1, 2, 3, 8, 9, 17, 100, 5000}) {
    const std::vector<Bounds> boxes = random_boxes(dice, count);
    std::vector<std::uint8_t> masks(boxes.size());
    for (std::uint8_t& mask : masks) mask = static_cast<std::uint8_t>(1 << dice.below(8));
    const Built built(boxes, masks);
    std::vector<int> seen(boxes.size(), 0);
    const auto nodes = built.hierarchy.nodes();
    for (std::uint32_t index = 0; index < nodes.size(); ++index) {
      for (int lane = 0; lane < Hierarchy::kWidth; ++lane) {
        const Hierarchy::Node& node = nodes[index];
        if (node.opacity[lane] == 0) {
          EXPECT_EQ(node.planes[0][0][lane], kInfinity);
          continue;
        }
        const std::uint32_t child = node.child[lane];
        if ((child & Hierarchy::kLeafBit) == 0) {
          ASSERT_GT(child, index);
          for (int below = 0; below < Hierarchy::kWidth; ++below) {
            if (nodes[child].opacity[below] == 0) continue;
            EXPECT_EQ(nodes[child].opacity[below] & ~node.opacity[lane], 0);
            for (int axis = 0; axis < 3; ++axis) {
              EXPECT_GE(nodes[child].planes[0][axis][below], node.planes[0][axis][lane]);
              EXPECT_LE(nodes[child].planes[1][axis][below], node.planes[1][axis][lane]);
            }
          }
          continue;
        }
        for (std::uint32_t k = 0; k < Hierarchy::count(child); ++k) {
          const std::uint32_t id = built.order[Hierarchy::first(child) + k];
          ++seen[id];
          EXPECT_EQ(masks[id] & ~node.opacity[lane], 0);
          for (std::size_t axis = 0; axis < 3; ++axis) {
            EXPECT_LE(built.hierarchy.center()[axis] + static_cast<double>(node.planes[0][axis][lane]),
                      boxes[id].lo[axis]);
            EXPECT_GE(built.hierarchy.center()[axis] + static_cast<double>(node.planes[1][axis][lane]),
                      boxes[id].hi[axis]);
          }
        }
      }
    }
    EXPECT_EQ(std::accumulate(seen.begin(), seen.end(), 0), count);
    EXPECT_EQ(*std::max_element(seen.begin(), seen.end()), 1);
  }
}

TEST(Hierarchy, IsTheSameWhateverTheThreads) {
  Dice dice(24);
  const std::vector<Bounds> boxes = random_boxes(dice, 60'000);
  const Built one(boxes, {}, 1), many(boxes, {}, 7);
  EXPECT_EQ(one.order, many.order);
  ASSERT_EQ(one.hierarchy.nodes().size(), many.hierarchy.nodes().size());
  for (std::size_t i = 0; i < one.hierarchy.nodes().size(); ++i) {
    const Hierarchy::Node &a = one.hierarchy.nodes()[i], &b = many.hierarchy.nodes()[i];
    for (int lane = 0; lane < Hierarchy::kWidth; ++lane) {
      ASSERT_EQ(a.child[lane], b.child[lane]);
      ASSERT_EQ(a.planes[0][0][lane], b.planes[0][0][lane]);
      ASSERT_EQ(a.planes[1][2][lane], b.planes[1][2][lane]);
    }
  }
}

/// Boxes that cannot be told apart, or ever nearer to each other, must not make it deep.
TEST(Hierarchy, StaysShallow) {
  std::vector<Bounds> boxes(100'000, Bounds{{1, 1, 1}, {2, 2, 2}});
  for (int i = 0; i < 3000; ++i) {
    const double x = std::ldexp(1, -i / 3);
    boxes.push_back({{x, x, 0}, {x * 1.25, x, 0}});
  }
  const Built built(boxes);
  std::vector<int> depth(built.hierarchy.nodes().size(), 1);
  int deepest = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    deepest = std::max(deepest, depth[i]);
    for (const std::uint32_t child : built.hierarchy.nodes()[i].child)
      if ((child & Hierarchy::kLeafBit) == 0) depth[child] = depth[i] + 1;
  }
  EXPECT_LE(7 * deepest + 32, Hierarchy::kStackSize);
}

/// Opening a subtree step by step gives every primitive once, with the counts that were announced.
TEST(HierarchyCandidates, OpenToAllPrimitives) {
  class Boxes final : public HierarchyCandidates {
   public:
    using HierarchyCandidates::HierarchyCandidates;
    void geometry(std::uint32_t /*primitive*/, Geometry& /*out*/) const override {}
  };
  Dice dice(25);
  for (const int count : {1, 2, 7, 300}) {
    const std::vector<Bounds> boxes = random_boxes(dice, count);
    const Built built(boxes);
    const Boxes candidates(built.hierarchy, static_cast<std::uint32_t>(count));
    EXPECT_EQ(candidates.count(), static_cast<std::uint32_t>(count));
    std::vector<int> seen(boxes.size(), 0);
    const auto open = [&](auto&& self, std::uint32_t entry) -> std::uint32_t {
      Candidates::Child children[Candidates::kMostChildren];
      const int n = candidates.open(entry, children);
      std::uint32_t total = 0;
      for (int i = 0; i < n; ++i) {
        if ((children[i].entry & Candidates::kSubtree) == 0) {
          ++seen[built.order[children[i].entry]];
          ++total;
          continue;
        }
        const std::uint32_t below = self(self, children[i].entry);
        EXPECT_EQ(below, children[i].below);
        total += below;
      }
      return total;
    };
    EXPECT_EQ(open(open, Candidates::kWhole), static_cast<std::uint32_t>(count));
    EXPECT_EQ(*std::min_element(seen.begin(), seen.end()), 1);
  }
}

}  // namespace
}  // namespace fas
