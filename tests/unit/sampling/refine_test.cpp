// SPDX-License-Identifier: MIT
#include "rayshade/sampling/refine.h"

#include <gtest/gtest.h>

#include <array>
#include <random>

namespace rayshade {
namespace {

std::array<Color, 5> same(const Color& c) { return {c, c, c, c, c}; }

TEST(ContrastTest, ComparesEachChannelWithItsThreshold) {
  const Color threshold{0.2, 0.15, 0.3};
  std::array<Color, 5> colors = same({0.5, 0.5, 0.5});
  EXPECT_FALSE(contrast_exceeds(colors, threshold));
  colors[3].g = 0.5 * (1 - 0.15) / (1 + 0.15) + 1e-6;  // just within: (max - min) / (max + min) = .15
  EXPECT_FALSE(contrast_exceeds(colors, threshold));
  colors[3].g -= 1e-5;
  EXPECT_TRUE(contrast_exceeds(colors, threshold));
}

TEST(ContrastTest, IgnoresWhatIsNearlyBlack) {
  std::array<Color, 5> colors = same({});
  colors[4] = {5e-6, 5e-6, 5e-6};
  EXPECT_FALSE(contrast_exceeds(colors, {0, 0, 0}));
  colors[4].b = 5e-5;
  EXPECT_TRUE(contrast_exceeds(colors, {0, 0, 0}));
}

TEST(ChooseFullTest, BorderOfTheScreenIsAlwaysFull) {
  const std::vector<Color> flat(6 * 5, Color{1, 1, 1});
  const std::vector<bool> full = choose_full({0, 0, 6, 5}, flat, {0.2, 0.15, 0.3}, 6, 5);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 6; ++x) {
      EXPECT_EQ(full[static_cast<std::size_t>(y) * 6 + x], x == 0 || y == 0 || x == 5 || y == 4)
          << x << ' ' << y;
    }
  }
}

TEST(ChooseFullTest, ALoneOddSampleCostsFivePixels) {
  for (int offset = 0; offset < 5; ++offset) {
    std::vector<Color> single(13 * 11, Color{0.1, 0.1, 0.1});
    const int at = 4 + offset;
    single[5 * 13 + static_cast<std::size_t>(at)] = {0.16, 0.16, 0.16};
    const std::vector<bool> full = choose_full({0, 0, 13, 11}, single, {0.2, 0.15, 0.3}, 13, 11);
    int count = 0;
    for (int y = 1; y < 10; ++y) {
      for (int x = 1; x < 12; ++x)
        count += full[static_cast<std::size_t>(y) * 13 + static_cast<std::size_t>(x)];
    }
    EXPECT_EQ(count, 5) << offset;
    EXPECT_TRUE(full[5 * 13 + static_cast<std::size_t>(at)]) << offset;
  }
}

TEST(ChooseFullTest, AnEdgeIsSampledOnBothSidesAllAlong) {
  const int width = 24, height = 20;
  for (const double slope : {0.0, 0.4, 1.0, 2.5}) {
    std::vector<Color> single;
    const auto bright = [&](int x, int y) { return x > 4 + slope * y; };
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) single.push_back(bright(x, y) ? Color{1, 1, 1} : Color{.2, .2, .2});
    }
    const std::vector<bool> full =
        choose_full({0, 0, width, height}, single, {0.2, 0.15, 0.3}, width, height);
    for (int y = 1; y < height - 1; ++y) {
      for (int x = 1; x < width - 1; ++x) {
        const bool edge = bright(x, y) != bright(x - 1, y) || bright(x, y) != bright(x + 1, y) ||
                          bright(x, y) != bright(x, y - 1) || bright(x, y) != bright(x, y + 1);
        EXPECT_TRUE(!edge || full[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)])
            << slope << ' ' << x << ' ' << y;
      }
    }
  }
}

/// The choice for a pixel is the same whatever rectangle it is asked for in.
TEST(ChooseFullTest, DoesNotDependOnTheRectangle) {
  const int width = 23, height = 17;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> value(0.3, 0.5);
  std::vector<Color> screen;
  for (int i = 0; i < width * height; ++i) screen.push_back({value(random), value(random), value(random)});
  const Color threshold{0.2, 0.15, 0.3};
  const std::vector<bool> whole = choose_full({0, 0, width, height}, screen, threshold, width, height);
  int chosen = 0;
  for (const PixelRect rect : {PixelRect{0, 0, 5, 5}, PixelRect{4, 3, 9, 17}, PixelRect{20, 10, 23, 17},
                               PixelRect{7, 7, 8, 8}, PixelRect{1, 1, 22, 16}}) {
    const PixelRect outer = halo(rect, kRefinementReach, width, height);
    std::vector<Color> part;
    for (int y = outer.y0; y < outer.y1; ++y) {
      for (int x = outer.x0; x < outer.x1; ++x)
        part.push_back(screen[static_cast<std::size_t>(y) * width + x]);
    }
    const std::vector<bool> full = choose_full(rect, part, threshold, width, height);
    std::size_t i = 0;
    for (int y = rect.y0; y < rect.y1; ++y) {
      for (int x = rect.x0; x < rect.x1; ++x, ++i) {
        EXPECT_EQ(full[i], whole[static_cast<std::size_t>(y) * width + x]) << x << ' ' << y;
        chosen += full[i];
      }
    }
  }
  EXPECT_GT(chosen, 20);
}

}  // namespace
}  // namespace rayshade
