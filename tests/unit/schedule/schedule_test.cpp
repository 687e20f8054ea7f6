// SPDX-License-Identifier: MIT
#include "rayshade/schedule/schedule.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "rayshade/schedule/bands.h"
#include "rayshade/schedule/cost_forecast.h"
#include "rayshade/schedule/cost_order.h"
#include "rayshade/schedule/ring_blocks.h"
#include "rayshade/schedule/ring_pattern.h"
#include "rayshade/schedule/round_robin.h"
#include "rayshade/schedule/starting_blocks.h"

namespace rayshade {
namespace {

using Numbers = std::vector<std::int64_t>;

Numbers take(Schedule& schedule, int worker, int count) {
  Numbers numbers;
  for (int i = 0; i < count; ++i) numbers.push_back(schedule.next(worker));
  return numbers;
}

TEST(RoundRobinTest, LineBelongsToItsNumberModuloWorkers) {
  RoundRobin schedule(10, 3);
  for (int worker = 0; worker < 3; ++worker) schedule.rest(worker, false);
  EXPECT_EQ(take(schedule, 1, 4), (Numbers{1, 4, 7, -1}));
  EXPECT_EQ(take(schedule, 0, 5), (Numbers{0, 3, 6, 9, -1}));
  EXPECT_EQ(take(schedule, 2, 4), (Numbers{2, 5, 8, -1}));
}

TEST(RoundRobinTest, LinesOfAbsentWorkersGoToOthersLast) {
  RoundRobin schedule(6, 3);
  schedule.rest(0, false);
  schedule.rest(2, false);
  EXPECT_EQ(take(schedule, 0, 5), (Numbers{0, 3, 1, 4, -1}));
  schedule.rest(2, true);
  EXPECT_EQ(take(schedule, 7, 3), (Numbers{2, 5, -1}));
}

TEST(BandsTest, StartsAreSpreadFromTheFirstTwoLinesToTheLastTwo) {
  EXPECT_EQ(first_band(100, 0, 5), 0);
  EXPECT_EQ(first_band(100, 4, 5), 98);
  EXPECT_EQ(first_band(100, 2, 5), 49);
  EXPECT_EQ(first_band(100, 0, 1), 0);
  EXPECT_EQ(first_band(1, 1, 2), 0);
}

TEST(BandsTest, NextAreTheUnassignedLinesClosestToItsOwn) {
  Bands schedule(20, 3);
  EXPECT_EQ(take(schedule, 0, 2), (Numbers{0, 1}));
  EXPECT_EQ(take(schedule, 1, 2), (Numbers{9, 10}));
  EXPECT_EQ(take(schedule, 2, 2), (Numbers{18, 19}));
  EXPECT_EQ(take(schedule, 1, 4), (Numbers{11, 8, 12, 7}));
  EXPECT_EQ(take(schedule, 0, 6), (Numbers{2, 3, 4, 5, 6, 13}));  // beyond those of worker 1
  EXPECT_EQ(take(schedule, 1, 2), (Numbers{14, 15}));
  EXPECT_EQ(take(schedule, 2, 3), (Numbers{17, 16, -1}));
}

/// The rule of bands, by looking at all lines.
TEST(BandsTest, AgreeWithASearchOfAllLines) {
  for (int workers = 1; workers < 12; ++workers) {
    constexpr int kLines = 61;
    Bands schedule(kLines, workers);
    std::vector<int> owner(kLines, -1);
    for (int turn = 0; turn < kLines; ++turn) {
      const int worker = turn * turn % (workers + 2);  // some late ones too
      const std::int64_t line = schedule.next(worker);
      ASSERT_TRUE(line >= 0 && line < kLines && owner[static_cast<std::size_t>(line)] < 0);
      const auto distance = [&](std::int64_t to) {
        std::int64_t least = kLines * 2;
        bool any = false;
        for (int i = 0; i < kLines; ++i)
          if (owner[static_cast<std::size_t>(i)] == worker)
            any = true, least = std::min(least, std::abs(i - to));
        return any ? least : std::abs(first_band(kLines, worker, workers) - to);
      };
      for (int i = 0; i < kLines; ++i) {
        if (owner[static_cast<std::size_t>(i)] < 0) {
          EXPECT_GE(distance(i), distance(line));
        }
      }
      owner[static_cast<std::size_t>(line)] = worker;
    }
    EXPECT_EQ(schedule.next(0), -1);
  }
}

double radius(const BlockGrid& grid, std::int64_t number) {
  const double x = static_cast<double>(number % grid.columns()) - (grid.columns() - 1) / 2.;
  const double y = static_cast<double>(number / grid.columns()) - (grid.rows() - 1) / 2.;
  return std::hypot(x, y);
}

TEST(StartingBlocksTest, LieOnTheCirclesOfTheirScheme) {
  const BlockGrid grid(3000, 3000, 10);
  for (int worker = 0; worker < 20; ++worker) {
    EXPECT_NEAR(radius(grid, starting_block(StartingBlocks::kThird, grid, worker, 20)), 50, 1);
    EXPECT_NEAR(radius(grid, starting_block(StartingBlocks::kHalf, grid, worker, 20)), 75, 1);
  }
  int inner = 0;
  for (int worker = 0; worker < 21; ++worker) {
    const double r = radius(grid, starting_block(StartingBlocks::kTwoCircles, grid, worker, 21));
    inner += r < 60;
    EXPECT_NEAR(r, r < 60 ? 50 : 150, 1);
  }
  EXPECT_EQ(inner, 7);
  for (int worker = 0; worker < 8; ++worker)
    EXPECT_NEAR(radius(grid, starting_block(StartingBlocks::kTwoCircles, grid, worker, 8)), 150, 1);
}

TEST(StartingBlocksTest, AreInThePictureAndApart) {
  for (const auto& [width, height] :
       {std::pair{640, 64}, std::pair{64, 640}, std::pair{640, 640}, std::pair{5, 5}}) {
    const BlockGrid grid(width, height, 16);
    for (const auto scheme : {StartingBlocks::kThird, StartingBlocks::kHalf, StartingBlocks::kTwoCircles}) {
      for (int worker = 0; worker < 30; ++worker) {
        const std::int64_t start = starting_block(scheme, grid, worker, 12);
        EXPECT_TRUE(start >= 0 && start < grid.count());
      }
    }
  }
  const BlockGrid grid(640, 640, 16);
  std::vector<std::int64_t> starts;
  for (int worker = 0; worker < 15; ++worker)
    starts.push_back(starting_block(StartingBlocks::kTwoCircles, grid, worker, 15));
  std::sort(starts.begin(), starts.end());
  EXPECT_EQ(std::unique(starts.begin(), starts.end()), starts.end());
}

TEST(RingBlocksTest, WorkersFollowTheRingsAroundTheirStart) {
  const BlockGrid grid(330, 330, 10);
  RingBlocks schedule(grid, StartingBlocks::kThird, 1);
  const std::int64_t start = starting_block(StartingBlocks::kThird, grid, 0, 1);
  for (std::int64_t place = 0; place < 49; ++place) {
    const RingOffset offset = ring_offset(place);
    EXPECT_EQ(schedule.next(0), start + offset.y * grid.columns() + offset.x);
  }
}

TEST(CostOrderTest, ExpensiveBlocksComeBeforeCheapOnes) {
  const BlockGrid grid(640, 640, 10);
  CostForecast forecast(grid);
  CostOrder schedule(grid, forecast);
  const auto cost = [&](std::int64_t number) {
    return 1. + static_cast<double>(number / grid.columns() / 8);
  };
  const int cells = forecast.cell_columns() * forecast.cell_rows();
  for (int i = 0; i < cells; ++i) {  // the survey: one block of every cell
    const std::int64_t number = schedule.next(0);
    EXPECT_FALSE(forecast.knows_cell(forecast.cell_of(number)));
    forecast.learn(number, cost(number));
    schedule.learned(number);
  }
  double last = 100;
  for (std::int64_t i = cells; i < grid.count(); ++i) {
    const std::int64_t number = schedule.next(0);
    ASSERT_GE(number, 0);
    EXPECT_LE(cost(number), last);
    last = cost(number);
  }
  EXPECT_EQ(schedule.next(0), -1);
}

TEST(CostForecastTest, PredictsFromTheNearestThatAreKnown) {
  const BlockGrid grid(640, 640, 10);
  CostForecast forecast(grid);
  EXPECT_FALSE(forecast.knows());
  EXPECT_EQ(forecast.seconds(0), 0);
  forecast.learn(0, 3);
  EXPECT_EQ(forecast.seconds(4095), 3);  // nothing nearer is known
  forecast.learn(4095, 5);
  EXPECT_EQ(forecast.seconds(1), 3);
  EXPECT_EQ(forecast.seconds(4094), 5);
  forecast.learn(1, std::nan(""));
  forecast.learn(1, -1);
  EXPECT_EQ(forecast.seconds(1), 3);
  EXPECT_EQ(forecast.mean_per_pixel(), 8. / 200);
}

TEST(ScheduleTest, EveryBlockIsGivenOnce) {
  for (const char* name : {"roundrobin", "bands", "blocks", "cost", "auto", ""}) {
    for (const int workers : {1, 2, 9, 50}) {
      const ScheduleOptions options{name, "", workers, 8};
      const BlockGrid grid = schedule_grid(203, 77, options);
      CostForecast forecast(grid);
      const auto schedule = make_schedule(options, grid, forecast);
      std::vector<int> given(static_cast<std::size_t>(grid.count()));
      for (std::int64_t i = 0; i < grid.count(); ++i) {
        const std::int64_t number = schedule->next(static_cast<int>(i * 7) % (workers + 3));
        ASSERT_TRUE(number >= 0 && number < grid.count()) << name;
        ++given[static_cast<std::size_t>(number)];
      }
      for (const int times : given) EXPECT_EQ(times, 1);
      for (int worker = 0; worker < workers + 3; ++worker) EXPECT_EQ(schedule->next(worker), -1);
    }
  }
}

TEST(ScheduleTest, UnknownNamesAreRefused) {
  const BlockGrid grid(10, 10, 2);
  const CostForecast forecast(grid);
  EXPECT_THROW(make_schedule({"spiral", "", 1, 0}, grid, forecast), std::invalid_argument);
  EXPECT_THROW(make_schedule({"blocks", "centre", 1, 0}, grid, forecast), std::invalid_argument);
}

}  // namespace
}  // namespace rayshade
