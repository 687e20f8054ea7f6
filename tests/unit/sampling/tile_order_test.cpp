// SPDX-License-Identifier: MIT
#include "rayshade/sampling/tile_order.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace rayshade {
namespace {

TEST(TileOrder, NumbersEveryPixelOnceInItsOrder) {
  for (const PixelRect rect : {PixelRect{0, 0, 1, 1}, PixelRect{5, -3, 13, 5}, PixelRect{2, 7, 35, 60},
                               PixelRect{0, 0, 7, 100}, PixelRect{-20, 1, 11, 10}}) {
    const TileOrder order(rect);
    std::size_t next = 0;
    order.each([&](int x, int y) {
      EXPECT_TRUE(rect.contains(x, y));
      ASSERT_EQ(order.index(x, y), next++);
    });
    EXPECT_EQ(next, rect.area());
  }
}

TEST(TileOrder, KeepsNeighboursTogether) {
  int x0 = 0, y0 = 0, farthest = 0;
  std::size_t i = 0;
  TileOrder({0, 0, 64, 64}).each([&](int x, int y) {
    if (i++ % 64 == 0) x0 = x, y0 = y;
    farthest = std::max({farthest, std::abs(x - x0), std::abs(y - y0)});
  });
  EXPECT_EQ(farthest, TileOrder::kSide - 1);
}

}  // namespace
}  // namespace rayshade
