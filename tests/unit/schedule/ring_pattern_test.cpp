// SPDX-License-Identifier: MIT
#include "rayshade/schedule/ring_pattern.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "rayshade/schedule/free_blocks.h"

namespace rayshade {
namespace {

TEST(RingPatternTest, CoreIsThatOfTheMethod) {
  // As published, places from 1, rows from the top.
  constexpr int kCore[7][7] = {
      {48, 44, 36, 29, 35, 43, 47}, {40, 24, 20, 13, 19, 23, 39}, {32, 16, 8, 5, 7, 15, 31},
      {26, 10, 2, 1, 3, 11, 27},    {30, 14, 6, 4, 9, 17, 33},    {38, 22, 18, 12, 21, 25, 41},
      {46, 42, 34, 28, 37, 45, 49},
  };
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 7; ++x) {
      EXPECT_EQ(ring_offset(kCore[y][x] - 1), (RingOffset{x - 3, y - 3})) << kCore[y][x];
      EXPECT_EQ(ring_place({x - 3, y - 3}), kCore[y][x] - 1);
    }
  }
}

TEST(RingPatternTest, EveryRingIsCoveredBeforeTheNext) {
  std::set<std::pair<int, int>> seen;
  int ring = 0;
  for (std::int64_t place = 0; place < 101 * 101; ++place) {
    const RingOffset offset = ring_offset(place);
    const int now = std::max(std::abs(offset.x), std::abs(offset.y));
    EXPECT_GE(now, ring);
    ring = now;
    EXPECT_TRUE(seen.emplace(offset.x, offset.y).second) << place;
    EXPECT_EQ(ring_place(offset), place);
  }
  EXPECT_EQ(ring, 50);
}

TEST(RingPatternTest, FarPlacesAreExact) {
  for (const std::int64_t place : {3'999'999'999'999LL, 4'000'000'000'000LL, 4'000'000'000'001LL})
    EXPECT_EQ(ring_place(ring_offset(place)), place);
}

TEST(RingPatternTest, RanksAreOrderedAsPlaces) {
  for (std::int64_t place = 1; place < 2000; ++place)
    EXPECT_LT(ring_rank(ring_offset(place - 1)), ring_rank(ring_offset(place))) << place;
}

TEST(FreeBlocksTest, FindWhatAWalkAlongTheRingsFinds) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    const int columns = 1 + static_cast<int>(random() % 20), rows = 1 + static_cast<int>(random() % 20);
    FreeBlocks free(columns, rows);
    std::vector<bool> is_free(static_cast<std::size_t>(columns) * rows, true);
    for (int i = 0; i < columns * rows; ++i) {
      const int x = static_cast<int>(random() % columns), y = static_cast<int>(random() % rows);
      std::int64_t expected = -1;
      for (std::int64_t place = 0; expected < 0; ++place) {
        const RingOffset offset = ring_offset(place);
        const int at_x = x + offset.x, at_y = y + offset.y;
        if (at_x >= 0 && at_y >= 0 && at_x < columns && at_y < rows &&
            is_free[static_cast<std::size_t>(at_y) * columns + at_x])
          expected = std::int64_t{at_y} * columns + at_x;
      }
      ASSERT_FALSE(free.empty());
      ASSERT_EQ(free.first_around(x, y), expected) << "seed " << seed;
      free.remove(static_cast<int>(expected % columns), static_cast<int>(expected / columns));
      is_free[static_cast<std::size_t>(expected)] = false;
    }
    EXPECT_TRUE(free.empty());
    EXPECT_EQ(free.first_around(0, 0), -1);
  }
}

}  // namespace
}  // namespace rayshade
