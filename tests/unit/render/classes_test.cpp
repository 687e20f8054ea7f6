// SPDX-License-Identifier: MIT
// What intersectors report of their classes of rays adds up to what the renderer asked.
#include <gtest/gtest.h>

#include <numeric>

#include "tests/unit/render/crowd.h"

namespace rayshade {
namespace {

using test::crowd;
using test::Rendered;
using Method = IntersectorReport::Method;
using Rays = ClassReport::Rays;

std::uint64_t sum(const RenderStatistics& statistics, std::uint64_t (*count)(const ClassReport&)) {
  std::uint64_t out = 0;
  for (const ClassReport& c : statistics.intersector.classes) out += count(c);
  return out;
}
std::uint64_t queries(const RenderStatistics& s) {
  return sum(s, [](const ClassReport& c) { return c.queries(); });
}
std::uint64_t in_trees(const RenderStatistics& s) {
  return sum(s, [](const ClassReport& c) { return c.in_tree.rays; });
}

const char* kPlain = "screen 60 44 sample 1 nojitter";

TEST(ClassReportTest, RaysOfAllClassesAreTheQueriesOfTheRenderer) {
  RenderOptions chosen, usual, always, small, none, threads;
  usual.fas_choose = none.fas_choose = threads.fas_choose = false;
  always.fas_split = fas::Split::kAlways;
  small.fas_memory = std::size_t{256} << 10;
  small.fas_split = fas::Split::kAlways;
  none.fas_memory = 1;
  threads.threads = 3;
  threads.block_side = 8;
  for (const char* view : {kPlain, "screen 50 40 sample 2", "screen 40 30 sample 2 aperture .1 focaldist 12",
                           "screen 40 30 sample 1 shadowtransp"}) {
    for (const RenderOptions& options : {chosen, usual, always, small, none, threads}) {
      const Rendered rendered(crowd(view), options);
      const RenderStatistics& s = rendered.statistics();
      ASSERT_EQ(s.intersector.method, Method::kTrees);
      EXPECT_EQ(queries(s), s.shading.queries()) << view;
      // Where there is a choice, it is the clock's.
      if (!options.fas_choose || options.fas_split == fas::Split::kAlways) {
        EXPECT_GT(in_trees(s), 0u);
      }
      for (const ClassReport& c : s.intersector.classes) {
        EXPECT_GE(c.in_hierarchy.rays, c.left_by_place());
        EXPECT_LE(c.in_tree.cached_leaf + c.in_tree.outside, c.in_tree.rays + c.in_tree.elsewhere);
        if (c.rays == Rays::kEye) {
          EXPECT_EQ(c.queries(), s.shading.eye_rays);
        }
        if (c.rays == Rays::kReflected) {
          EXPECT_EQ(c.queries(), s.shading.reflected_rays);
        }
        if (c.rays == Rays::kTransmitted) {
          EXPECT_EQ(c.queries(), s.shading.transmitted_rays);
        }
      }
    }
  }
}

TEST(ClassReportTest, EveryLightHasItsName) {
  const Rendered rendered(crowd(kPlain), {});
  const RenderStatistics& s = rendered.statistics();
  std::vector<std::string> names;
  for (const ClassReport& c : s.intersector.classes) {
    if (c.rays == Rays::kLight) names.push_back(s.light_names.at(c.light));
  }
  ASSERT_EQ(names.size(), 8u);
  // In the order of evaluation, the reverse of definition; the area light is four cells.
  EXPECT_EQ(names.front(), "light 8 (area)");
  EXPECT_EQ(names[4], "light 4 (extended)");
  EXPECT_EQ(names[5], "light 3 (spot)");
  EXPECT_EQ(names[6], "light 2 (directional)");
  EXPECT_EQ(names.back(), "light 1 (point)");
}

TEST(ClassReportTest, FramesAddUpAndMemoryIsReported) {
  RenderOptions usual;
  usual.fas_choose = false;
  Rendered rendered(crowd(kPlain), usual);
  const std::uint64_t one = queries(rendered.statistics());
  const std::atomic<bool> stop{false};
  rendered.picture.clear();
  ASSERT_TRUE(rendered.renderer.render_frame({1, rendered.picture, stop}));
  const RenderStatistics& s = rendered.statistics();
  EXPECT_GT(queries(s), one);
  EXPECT_EQ(queries(s), s.shading.queries());
  EXPECT_GT(s.intersector.pool_used, 0u);
  EXPECT_GE(s.intersector.pool_held, s.intersector.pool_used);
  EXPECT_GE(s.intersector.pool_budget, s.intersector.pool_held);
  EXPECT_FALSE(s.intersector.pool_exhausted);
  RenderOptions none = usual;
  none.fas_memory = 1;
  const Rendered starved(crowd(kPlain), none);
  EXPECT_TRUE(starved.statistics().intersector.pool_exhausted);
  EXPECT_EQ(starved.statistics().intersector.pool_used, 0u);
}

TEST(ClassReportTest, OtherIntersectorsSayWhatTheyAre) {
  RenderOptions options;
  options.intersector = IntersectorKind::kHierarchy;
  EXPECT_EQ(Rendered(crowd(kPlain), options).statistics().intersector.method, Method::kHierarchy);
  options.intersector = IntersectorKind::kBruteForce;
  const Rendered brute(crowd(kPlain), options);
  EXPECT_EQ(brute.statistics().intersector.method, Method::kBruteForce);
  EXPECT_TRUE(brute.statistics().intersector.classes.empty());
  EXPECT_EQ(Rendered("screen 8 8 sphere 1 0 0 0", {}).statistics().intersector.method, Method::kPacks);
}

TEST(ClassReportTest, VerificationReportsForTheOneItChecks) {
  RenderOptions options;
  options.verify = .1;
  const Rendered rendered(crowd(kPlain), options);
  EXPECT_EQ(rendered.statistics().intersector.method, Method::kTrees);
  EXPECT_EQ(queries(rendered.statistics()), rendered.statistics().shading.queries());
  EXPECT_NE(rendered.renderer.eye_tree(), nullptr);
}

/// With one sample per pixel no ray is traced for a pixel of another block: pixels add up to the whole, tests
/// in the leaves of trees included.
TEST(CostMapTest, PixelsAddUpToTheStatistics) {
  for (const fas::Split split : {fas::Split::kAdaptive, fas::Split::kAlways}) {
    RenderOptions options;
    options.cost = true;
    options.fas_split = split;
    options.fas_choose = false;
    const Rendered rendered(crowd(kPlain), options, {"tests", "bounds_tests", "rays", "tree_rays"});
    const RenderStatistics& s = rendered.statistics();
    ASSERT_EQ(s.intersector.method, Method::kTrees);
    EXPECT_EQ(rendered.sum_of("tests"), static_cast<double>(s.trace.total_tests()));
    EXPECT_EQ(rendered.sum_of("bounds_tests"), static_cast<double>(s.trace.bounds_tests));
    EXPECT_EQ(rendered.sum_of("rays"), static_cast<double>(s.shading.queries()));
    EXPECT_EQ(rendered.sum_of("tree_rays"), static_cast<double>(in_trees(s)));
    const std::uint64_t leaf_tests = sum(s, [](const ClassReport& c) { return c.in_tree.tests; });
    EXPECT_GT(leaf_tests, s.trace.total_tests() / 4);
  }
}

}  // namespace
}  // namespace rayshade
