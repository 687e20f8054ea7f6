// SPDX-License-Identifier: MIT
#include "pafas/simulator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

namespace pafas {
namespace {

using namespace rayshade;

/// A picture with an expensive disc in its middle.
BlockCosts disc(int width, int side, double seconds_per_block) {
  BlockCosts costs;
  costs.width = costs.height = width;
  costs.side = side;
  const BlockGrid grid(width, width, side);
  for (std::int64_t i = 0; i < grid.count(); ++i) {
    costs.blocks.push_back(grid.block(i));
    const double x = static_cast<double>(i % grid.columns()) / grid.columns() - .5;
    const double y = static_cast<double>(i / grid.columns()) / grid.rows() - .5;
    costs.seconds.push_back(seconds_per_block * (x * x + y * y < .1 ? 8 : 1));
  }
  return costs;
}

SimulatorOptions ideal(int ranks) {
  SimulatorOptions options;
  options.ranks = ranks;
  options.latency_seconds = options.service_seconds = options.service_per_byte = 0;
  options.bytes_per_second = 1e30;
  return options;
}

TEST(SimulatorTest, OneRankTakesTheSumOfTheCosts) {
  const BlockCosts costs = disc(256, 16, .01);
  for (const char* schedule : {"roundrobin", "bands", "blocks", "cost"}) {
    SimulatorOptions options = ideal(1);
    options.schedule = schedule;
    const SimulatorReport report = simulate(costs, options);
    EXPECT_NEAR(report.makespan_seconds, costs.total_seconds(), 1e-9);
    EXPECT_NEAR(report.efficiency, 1, 1e-9);
    EXPECT_NEAR(report.idle_seconds, 0, 1e-9);
    EXPECT_EQ(report.messages, 0);
  }
}

TEST(SimulatorTest, EqualBlocksOnEqualRanksAreShared) {
  BlockCosts costs = disc(256, 16, .01);
  for (double& seconds : costs.seconds) seconds = .01;
  SimulatorOptions options = ideal(4);
  options.schedule = "blocks";
  const SimulatorReport report = simulate(costs, options);
  EXPECT_NEAR(report.makespan_seconds, .64, .02);
  EXPECT_NEAR(report.idle_seconds, 4 * report.makespan_seconds - 2.56, 1e-6);
  options.dedicated_master = true;
  EXPECT_NEAR(simulate(costs, options).makespan_seconds, 2.56 / 3, .03);
}

TEST(SimulatorTest, OverheadsCost) {
  BlockCosts costs = disc(256, 16, .001);
  const double best = simulate(costs, ideal(8)).makespan_seconds;
  SimulatorOptions options = ideal(8);
  options.start_seconds = .5;
  EXPECT_GT(simulate(costs, options).makespan_seconds, best);
  options = ideal(8);
  options.latency_seconds = .01;
  EXPECT_GT(simulate(costs, options).makespan_seconds, best);
  options = ideal(8);
  options.service_seconds = .01;
  EXPECT_GT(simulate(costs, options).makespan_seconds, best);
  costs.tree_fixed_seconds = .1;
  EXPECT_GT(simulate(costs, ideal(8)).makespan_seconds, best + .09);
  costs.tree_fixed_seconds = 0;
  costs.tree_region_seconds = .1;
  const SimulatorReport trees = simulate(costs, ideal(8));
  EXPECT_GT(trees.tree_seconds, .1);
  EXPECT_LE(trees.tree_seconds, .8 + 1e-9);
  EXPECT_NEAR(simulate(costs, ideal(1)).makespan_seconds, costs.total_seconds(), 1e-9);
}

TEST(SimulatorTest, UnequalSpeedsAreUsed) {
  const BlockCosts costs = disc(512, 16, .01);
  SimulatorOptions options = ideal(3);
  options.speeds = {1, .1, 1};
  // A rank ten times slower than the others is known for that only after its first long message.
  EXPECT_GT(simulate(costs, options).efficiency, .8);
  options.speeds = {};
  options.speed_spread = .5;
  options.ranks = 10;
  EXPECT_GT(simulate(costs, options).efficiency, .9);
}

TEST(SimulatorTest, TheJobSurvivesItsRanks) {
  const BlockCosts costs = disc(512, 16, .01);
  for (const char* schedule : {"roundrobin", "bands", "blocks", "cost"}) {
    for (const double killed : {.3, 1.}) {
      SimulatorOptions options = ideal(20);
      options.schedule = schedule;
      options.killed = killed;
      options.silence_seconds = .1;
      const SimulatorReport report = simulate(costs, options);
      EXPECT_GT(report.lost_workers, killed == 1 ? 10 : 1) << schedule;
      EXPECT_GT(report.makespan_seconds, costs.total_seconds() / 20);
    }
  }
}

TEST(SimulatorTest, SameOptionsSameReport) {
  const BlockCosts costs = disc(256, 16, .01);
  SimulatorOptions options;
  options.ranks = 30;
  options.speed_spread = .3;
  options.killed = .2;
  EXPECT_EQ(report_json(simulate(costs, options)), report_json(simulate(costs, options)));
}

TEST(SimulatorTest, TheReportIsTextOrJson) {
  const std::string path = "simulator_test_costs.txt";
  BlockCosts costs = disc(128, 16, .01);
  write_block_costs(costs, path);
  SimulatorOptions options = ideal(1);
  const std::string text = run_simulator(path, options, false);
  EXPECT_THAT(text, testing::HasSubstr("1 ranks, 1 of them render; schedule cost, "));
  EXPECT_THAT(text, testing::HasSubstr("speed-up 1.00, efficiency 1.000\n"));
  const auto json = nlohmann::json::parse(run_simulator(path, options, true));
  EXPECT_NEAR(json["makespan_seconds"].get<double>(), costs.total_seconds(), 1e-6);
  EXPECT_EQ(json["schedule"], "cost");
  std::filesystem::remove(path);
  EXPECT_THROW(run_simulator(path, options, true), BlockCostsError);
}

TEST(SimulatorTest, NonsenseIsRefused) {
  const BlockCosts costs = disc(64, 16, .01);
  for (const auto spoil :
       {+[](SimulatorOptions& o) { o.ranks = 0; }, +[](SimulatorOptions& o) { o.speeds = {0}; },
        +[](SimulatorOptions& o) { o.speed_spread = 1; },
        +[](SimulatorOptions& o) { o.bytes_per_second = 0; },
        +[](SimulatorOptions& o) { o.latency_seconds = std::nan(""); },
        +[](SimulatorOptions& o) { o.schedule = "spiral"; }}) {
    SimulatorOptions options;
    spoil(options);
    EXPECT_THROW(simulate(costs, options), std::invalid_argument);
  }
}

}  // namespace
}  // namespace pafas
