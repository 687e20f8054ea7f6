// SPDX-License-Identifier: MIT
// Tree or hierarchy: whichever answers the rays still to come sooner takes nearly all of them, also where the
// first rays are of a place that is not like the others. Time is told, not taken.
#include "fas/choice.h"

#include <gtest/gtest.h>

#include <functional>

namespace fas {
namespace {

/// What a ray takes at some time of the run.
struct Cost {
  double hierarchy = 100;  ///< ns
  double tree = 100;       ///< ns, without what is made for it
  double making = 0;       ///< ns
  double tests = 5;        ///< through the hierarchy
};

constexpr double kRays = 4e6;
constexpr std::size_t kGroup = 512;
constexpr double kMaking = 2e6;

/// Sends all rays where the choice says; `cost` is asked with the rays that have come before a group, and
/// those that went through the tree. Returns the share of rays through the tree.
double share_through_tree(const std::function<Cost(double come, double through_tree)>& cost,
                          double rays = kRays) {
  Choice choice(rays, kMaking, {.25, 3});
  double come = 0, through_tree = 0;
  bool made = false;
  while (come < rays) {
    const Cost it = cost(come, through_tree);
    const Choice::Turn turn = choice.next(kGroup);
    come += kGroup;
    if (turn.way == Choice::Way::kTree) {
      through_tree += kGroup;
      const double making = it.making * kGroup + (made ? 0 : kMaking);
      made = true;
      choice.through_tree(kGroup, static_cast<std::uint64_t>(making),
                          turn.timed ? std::optional(it.tree * kGroup + making) : std::nullopt);
    } else if (turn.timed) {
      choice.through_hierarchy(kGroup, it.hierarchy * kGroup, static_cast<std::uint64_t>(it.tests * kGroup));
    }
  }
  return through_tree / come;
}

/// As if rays came from tiles of a picture, one after the other.
bool begins_tile(double come, double rays_of_tile) { return std::fmod(come, rays_of_tile) < 2 * kGroup; }

TEST(Choice, TheFasterWayIsTaken) {
  EXPECT_GT(share_through_tree([](double, double) { return Cost{100, 70}; }), .9);
  EXPECT_LT(share_through_tree([](double, double) { return Cost{100, 130}; }), .02);
}

TEST(Choice, WithoutExactTestsToSpareNothingIsMade) {
  EXPECT_EQ(share_through_tree([](double, double) { return Cost{100, 10, 0, 2.9}; }), 0);
}

TEST(Choice, FewRaysAreNotWorthATree) {
  EXPECT_EQ(share_through_tree([](double, double) { return Cost{100, 10}; }, 100000), 0);
}

TEST(Choice, ATreeThatIsStillColdIsNotLeft) {
  const auto cold = [](double, double through_tree) { return Cost{100, through_tree < 2000 ? 400. : 70}; };
  EXPECT_GT(share_through_tree(cold), .9);
}

TEST(Choice, ATreeThatBeginsWhereRaysMeetLittleIsNotLeft) {
  // What is known before is of rays that meet more; the tree is started by these.
  const auto sky_for_a_while = [](double come, double) {
    return come > 100000 && come < 150000 ? Cost{15, 40, 0, 0} : Cost{120, 70};
  };
  EXPECT_GT(share_through_tree(sky_for_a_while), .9);
}

TEST(Choice, ATreeThatOnlySkyNeedsIsLeft) {
  const auto sky_for_good = [](double come, double) {
    return come > 100000 ? Cost{15, 40, 0, 0} : Cost{120, 70};
  };
  EXPECT_LT(share_through_tree(sky_for_good), .2);
}

TEST(Choice, WhatIsMadeWhereATileBeginsIsSharedByItsRays) {
  const auto tiles = [](double come, double) {
    return begins_tile(come, 60000) ? Cost{100, 70, 500} : Cost{100, 70};
  };
  EXPECT_GT(share_through_tree(tiles), .9);  // 9 ns a ray for 30 that it spares
}

TEST(Choice, ATreeThatTakesMoreToMakeThanItSparesIsLeft) {
  const auto tiles = [](double come, double) {
    return begins_tile(come, 16000) ? Cost{100, 70, 900} : Cost{100, 70};
  };
  EXPECT_LT(share_through_tree(tiles), .3);  // 58 ns a ray
}

TEST(Choice, WhatBeginsLateIsSeen) {
  // Nothing to spare in the first half of the picture, much in the second.
  const auto halves = [](double come, double) {
    return come < kRays / 2 ? Cost{60, 60, 0, 2} : Cost{150, 80, 0, 8};
  };
  EXPECT_GT(share_through_tree(halves), .4);
}

TEST(Choice, LeavesATreeThatIsSlowerAloneAndComesBack) {
  using Way = Choice::Way;
  constexpr Choice::Saving kPacks{0.25, 2}, kAlone{0.3, 0};
  /// The share of groups that go through the tree, where a ray takes so long either way.
  const auto run = [](Choice& choice, double tree, double hierarchy, int groups, std::uint64_t making = 0) {
    int through_tree = 0;
    for (int i = 0; i < groups; ++i) {
      const Choice::Turn turn = choice.next(64);
      if (turn.way == Way::kTree) {
        const double ns = 64 * tree + static_cast<double>(making);
        choice.through_tree(64, making, turn.timed ? std::optional(ns) : std::nullopt);
        ++through_tree;
      } else if (turn.timed) {
        choice.through_hierarchy(64, 64 * hierarchy, 64 * 4);
      }
    }
    return static_cast<double>(through_tree) / groups;
  };
  Choice choice(1e6, 1e6, kPacks);
  EXPECT_GT(run(choice, 50, 100, 20'000), 0.9);
  EXPECT_LT(run(choice, 400, 100, 20'000), 0.5);
  // It is given another try, more and more seldom.
  EXPECT_GT(run(choice, 400, 100, 200'000), 0);
  EXPECT_LT(run(choice, 400, 100, 200'000), 0.05);
  EXPECT_GT(run(choice, 50, 100, 2'000'000), 0.4);
  // Where primitives are as many as rays, making a tree cannot pay, unless rays are costly; and not any more
  // where most rays have come.
  Choice crowded(1e6, 1e9, kPacks);
  EXPECT_EQ(crowded.next(64).way, Way::kHierarchy);
  crowded.through_hierarchy(20'000, 20'000 * 100, 20'000 * 4);
  EXPECT_EQ(crowded.next(64).way, Way::kHierarchy);
  Choice costly(1e6, 1e9, kPacks);
  costly.through_hierarchy(64, 64 * 60'000, 64 * 4);
  EXPECT_EQ(costly.next(64).way, Way::kHierarchy);  // too few to tell
  costly.through_hierarchy(20'000, 20'000 * 60'000.0, 20'000 * 4);
  EXPECT_EQ(costly.next(64).way, Way::kTree);
  Choice early(1e6, 5e6, kPacks), late(1e6, 5e6, kPacks);
  for (Choice* each : {&early, &late}) each->through_hierarchy(20'000, 20'000 * 100, 20'000 * 4);
  EXPECT_EQ(early.next(64).way, Way::kTree);
  EXPECT_EQ(late.next(900'000).way, Way::kHierarchy);
  // Nor where rays make hardly a test too many.
  Choice frugal(1e6, 0, kPacks);
  frugal.through_hierarchy(20'000, 20'000 * 100, 20'000);
  EXPECT_EQ(frugal.next(64).way, Way::kHierarchy);
  // Where tests are not looked at, a tree is tried at once, by single rays too.
  Choice alone(1e6, 1e6, kAlone), hopeless(1e6, 1e9, kAlone);
  EXPECT_EQ(alone.next(1).way, Way::kTree);
  EXPECT_EQ(hopeless.next(1).way, Way::kHierarchy);
  // What has been made is paid for: near the end a tree is kept for what its rays cost from now on.
  Choice sunk(1e5, 1.5e5, kPacks);
  sunk.through_hierarchy(20'000, 20'000 * 100, 20'000 * 4);
  EXPECT_GT(run(sunk, 60, 100, 40, 64 * 75), 0.4);
  EXPECT_GT(run(sunk, 60, 100, 1500), 0.8);
  // Building that never ends counts, too.
  Choice slow(1e4, 0, kPacks);
  EXPECT_LT(run(slow, 50, 100, 2000, 64 * 1000), 0.6);
}

}  // namespace
}  // namespace fas
