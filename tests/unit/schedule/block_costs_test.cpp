// SPDX-License-Identifier: MIT
#include "rayshade/schedule/block_costs.h"

#include <gtest/gtest.h>

#include <numeric>
#include <string>

namespace rayshade {
namespace {

BlockCosts example() {
  BlockCosts costs;
  costs.width = 50;
  costs.height = 34;
  costs.side = 16;
  costs.samples = 3;
  costs.tree_fixed_seconds = .25;
  costs.tree_region_seconds = 1. / 3;
  costs.scene_bytes = 12345;
  const BlockGrid grid(50, 34, 16);
  for (std::int64_t i = 0; i < grid.count(); ++i) {
    costs.blocks.push_back(grid.block(i));
    costs.seconds.push_back(.1 * static_cast<double>(i + 1));
  }
  return costs;
}

std::string error_of(const std::string& text) {
  try {
    parse_block_costs(text, "costs.txt");
  } catch (const BlockCostsError& error) {
    return error.what();
  }
  return "none";
}

TEST(BlockCostsTest, WhatIsWrittenIsRead) {
  const BlockCosts costs = example();
  const BlockCosts read = parse_block_costs(format_block_costs(costs), "x");
  EXPECT_EQ(read.blocks, costs.blocks);
  EXPECT_EQ(read.seconds, costs.seconds);
  EXPECT_EQ(read.width, 50);
  EXPECT_EQ(read.height, 34);
  EXPECT_EQ(read.samples, 3);
  EXPECT_EQ(read.tree_fixed_seconds, .25);
  EXPECT_EQ(read.tree_region_seconds, 1. / 3);
  EXPECT_EQ(read.scene_bytes, 12345U);
  EXPECT_EQ(format_block_costs(read), format_block_costs(costs));
}

TEST(BlockCostsTest, ErrorsNameFileAndLine) {
  const std::string head = "rayshade-block-costs 1\nwidth 4\nheight 2\n";
  EXPECT_EQ(error_of(head + "blocks 1\n0 0 0 4 2 0.5\n"), "none");
  EXPECT_EQ(error_of("# remark\n\n" + head + "blocks 1\n\n# more\n0 0 0 4 2 0.5\n"), "none");
  EXPECT_EQ(error_of(""), "costs.txt:0: this is no file of block costs");
  EXPECT_EQ(error_of("P6 1\n"), "costs.txt:1: this is no file of block costs");
  EXPECT_EQ(error_of("rayshade-block-costs 2\n"), "costs.txt:1: version 2 of block costs is not known");
  EXPECT_EQ(error_of(head + "depth 3\n"), "costs.txt:4: unknown entry 'depth'");
  EXPECT_EQ(error_of(head), "costs.txt:3: the head ends without 'blocks'");
  EXPECT_EQ(error_of(head + "blocks 2\n0 0 0 4 1 1\n"), "costs.txt:5: the file ends after 1 of 2 blocks");
  EXPECT_EQ(error_of(head + "blocks 1\n0 0 0 4 1 1\n"), "costs.txt:5: the blocks do not tile the picture");
  EXPECT_EQ(error_of(head + "blocks 2\n0 0 0 4 1 1\n1 0 0 4 1 1\n"),
            "costs.txt:6: the blocks do not tile the picture");
  EXPECT_EQ(error_of(head + "blocks 1\n0 0 0 4 2 1\n1 0 0 1 1 1\n"),
            "costs.txt:6: more blocks than the head says");
  EXPECT_EQ(error_of(head + "blocks 1\n0 0 0 4 2\n"),
            "costs.txt:5: a block has six numbers: number x y width height seconds");
  for (const char* bad : {"nan", "-1", "inf", "x", "1e99", "0x1"})
    EXPECT_EQ(error_of(head + "blocks 1\n0 0 0 4 2 " + bad + "\n").rfind("costs.txt:5: seconds: '", 0), 0U)
        << bad;
  EXPECT_EQ(error_of(head + "blocks 1\n0 1 0 4 2 1\n").rfind("costs.txt:5: width: '4'", 0), 0U);
  EXPECT_EQ(error_of("rayshade-block-costs 1\nblocks 1\n"), "costs.txt:2: width and height are missing");
}

TEST(BlockCostsTest, OtherBlocksShareTheSecondsByArea) {
  const BlockCosts costs = example();
  for (const auto& grid :
       {BlockGrid(50, 34, 16), BlockGrid(50, 34, 7), BlockGrid(50, 34, 64), BlockGrid::scan_lines(50, 34)}) {
    const auto seconds = redistribute(costs, grid);
    EXPECT_NEAR(std::accumulate(seconds.begin(), seconds.end(), 0.), costs.total_seconds(), 1e-9);
  }
  EXPECT_NEAR(redistribute(costs, BlockGrid(50, 34, 8))[0], .1 / 4, 1e-12);
  EXPECT_NEAR(redistribute(costs, BlockGrid(50, 34, 32))[0], .1 + .2 + .5 + .6, 1e-12);
}

TEST(BlockCostsTest, EnlargedPicturesCostMore) {
  const BlockCosts large = enlarged(example(), 4);
  EXPECT_NEAR(large.total_seconds(), 16 * example().total_seconds(), 1e-9);
  EXPECT_EQ(parse_block_costs(format_block_costs(large), "x").width, 200);
}

}  // namespace
}  // namespace rayshade
