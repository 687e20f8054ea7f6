// SPDX-License-Identifier: MIT
#include "rayshade/schedule/block_grid.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace rayshade {
namespace {

TEST(BlockGridTest, BlocksTileThePictureExactlyOnce) {
  for (const auto& [width, height, side] :
       {std::array{1, 1, 32}, std::array{64, 64, 32}, std::array{65, 31, 16}, std::array{7, 100, 1},
        std::array{33, 33, 64}}) {
    const BlockGrid grid(width, height, side);
    std::vector<int> covered(static_cast<std::size_t>(width) * height);
    for (std::int64_t i = 0; i < grid.count(); ++i) {
      const Block block = grid.block(i);
      EXPECT_EQ(block.number, i);
      for (int y = 0; y < block.height; ++y) {
        for (int x = 0; x < block.width; ++x)
          ++covered[static_cast<std::size_t>(block.y + y) * width + block.x + x];
      }
    }
    for (const int times : covered) EXPECT_EQ(times, 1);
  }
}

TEST(BlockGridTest, LargePicturesNeed64Bits) {
  const BlockGrid grid(1'000'000, 1'000'000, 1);
  EXPECT_EQ(grid.count(), 1'000'000'000'000);
  const Block last = grid.block(grid.count() - 1);
  EXPECT_EQ(last.x, 999'999);
  EXPECT_EQ(last.y, 999'999);
}

TEST(BlockSideTest, GivesEachWorkerDozensOfBlocksWhereThePictureAllows) {
  EXPECT_EQ(default_block_side(2000, 2000, 1), 64);
  const int side = default_block_side(512, 512, 8);
  EXPECT_GE(BlockGrid(512, 512, side).count(), 8 * 12);
  EXPECT_EQ(default_block_side(16, 16, 64), 16);
}

}  // namespace
}  // namespace rayshade
