// SPDX-License-Identifier: MIT
// Scrambled points against Sobol's own direction numbers, as nets, and as uniform numbers without relation.
#include "rayshade/sampling/sobol.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace rayshade {
namespace {

TEST(Sobol, FirstTwoDimensions) {
  // Direction numbers by the recurrence of the primitive polynomial x + 1: m = 1, 3, 5, 15, 17, ...
  std::uint32_t directions[32], m = 1;
  for (int k = 0; k < 32; ++k) {
    directions[k] = m << (31 - k);
    m = (m << 1) ^ m;
  }
  for (std::uint32_t i = 0; i < 5000; ++i) {
    std::uint32_t first = 0, second = 0;
    for (int k = 0; k < 32; ++k) {
      if (!(i >> k & 1u)) continue;
      first ^= 1u << (31 - k);
      second ^= directions[k];
    }
    const auto bits = sobol_bits(i);
    ASSERT_EQ(bits[0], first) << i;
    ASSERT_EQ(bits[1], second) << i;
  }
}

TEST(Sobol, FurtherDimensions) {
  // The first points by hand, from the direction numbers 1, 3, 3; 1, 3, 1, 5; 1, 1, 1, 11 over 2, 4, 8, 16.
  const double expected[8][3] = {{0, 0, 0},          {.5, .5, .5},       {.75, .75, .25},
                                 {.25, .25, .75},    {.375, .125, .125}, {.875, .625, .625},
                                 {.625, .875, .375}, {.125, .375, .875}};
  for (std::uint32_t i = 0; i < 8; ++i) {
    const auto bits = sobol_bits_further(i);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(bits[k] * 0x1p-32, expected[i][k]) << i << " " << k;
  }
  const auto sixteenth = sobol_bits_further(8);
  EXPECT_EQ(sixteenth[1] * 0x1p-32, 5 / 16.0);
  EXPECT_EQ(sixteenth[2] * 0x1p-32, 11 / 16.0);
}

/// In how many boxes of 2^columns x 2^rows the points of a run are, in two of the five dimensions.
std::size_t boxes_met(std::uint64_t stream, std::uint32_t first, std::uint32_t count, std::size_t a,
                      std::size_t b, int columns, int rows) {
  std::set<int> boxes;
  for (std::uint32_t i = first; i < first + count; ++i) {
    const auto p = sobol5(stream, 5, i);
    boxes.insert(static_cast<int>(std::ldexp(p[a], columns)) << 10 |
                 static_cast<int>(std::ldexp(p[b], rows)));
  }
  return boxes.size();
}

TEST(Sobol, EyeRaysAreStratifiedInAllTheirDimensionsTogether) {
  for (int pixel = 0; pixel < 20; ++pixel) {
    const std::uint64_t stream = pixel_stream(7, 0, static_cast<std::uint32_t>(pixel), 3);
    for (int m = 0; m <= 8; ++m) {
      const std::uint32_t count = 1u << m;
      for (std::uint32_t first = 0; first < 3 * count; first += count) {
        for (std::size_t a = 0; a < 5; ++a)
          ASSERT_EQ(boxes_met(stream, first, count, a, a, m, 0), count) << a << " of " << count;
        for (int columns = 0; columns <= m; ++columns)
          ASSERT_EQ(boxes_met(stream, first, count, 0, 1, columns, m - columns), count);
        // The third with the first two: at worst two points to a box.
        for (int columns = 0; columns < m; ++columns) {
          for (const std::size_t a : {0u, 1u})
            ASSERT_EQ(boxes_met(stream, first, count, a, 2, columns, m - 1 - columns), count / 2) << m;
        }
      }
    }
  }
}

TEST(Sobol, EyeRaysBeginWithThePointsOfOthers) {
  for (std::uint32_t i = 0; i < 100; ++i) {
    const std::uint64_t stream = pixel_stream(3, 1, i % 7, 2);
    const auto two = sobol2(stream, 9, i);
    const auto five = sobol5(stream, 9, i);
    EXPECT_EQ(five[0], two[0]);
    EXPECT_EQ(five[1], two[1]);
  }
}

TEST(Sobol, ScramblingKeepsCommonDigits) {
  for (std::uint32_t key = 1; key < 200; ++key) {
    for (int k = 1; k < 31; ++k) {
      // Two fractions whose first k digits agree, and the next does not: so do the scrambled ones.
      const std::uint32_t a = static_cast<std::uint32_t>(mix64(key)), b = a ^ (1u << (31 - k)) ^ (key & 1u);
      const std::uint32_t difference =
          owen_scramble(a, key * 0x9e3779b9u) ^ owen_scramble(b, key * 0x9e3779b9u);
      ASSERT_EQ(difference >> (31 - k), 1u) << key << " " << k;
    }
  }
}

TEST(Sobol, EveryAlignedRunIsANet) {
  for (int pixel = 0; pixel < 20; ++pixel) {
    const std::uint64_t stream = pixel_stream(7, 0, static_cast<std::uint32_t>(pixel), 3);
    for (int m = 0; m <= 8; ++m) {
      const std::uint32_t count = 1u << m;
      for (std::uint32_t first = 0; first < 3 * count; first += count) {
        for (int columns = 0; columns <= m; ++columns) {
          std::set<int> boxes;
          for (std::uint32_t i = first; i < first + count; ++i) {
            const auto p = sobol2(stream, 5, i);
            const int column = static_cast<int>(std::ldexp(p[0], columns));
            const int row = static_cast<int>(std::ldexp(p[1], m - columns));
            boxes.insert(column << 10 | row);
          }
          ASSERT_EQ(boxes.size(), count) << "pixel " << pixel << ", from " << first << ", " << columns;
        }
      }
    }
  }
}

TEST(Sobol, PointsOfPixelsAreUniformAndUnrelated) {
  // The same sample of many pixels and dimensions: means, and the correlations of neighbours.
  constexpr int kCount = 40'000;
  for (const std::uint32_t index : {0u, 1u, 5u, 63u}) {
    double sum_u = 0, sum_v = 0, uv = 0, next_pixel = 0, next_row = 0, next_dimension = 0;
    for (int i = 0; i < kCount; ++i) {
      const std::uint32_t x = static_cast<std::uint32_t>(i % 200), y = static_cast<std::uint32_t>(i / 200);
      const auto p = sobol2(pixel_stream(0, 0, x, y), 1, index);
      const double u = p[0] - .5, v = p[1] - .5;
      sum_u += u;
      sum_v += v;
      uv += u * v;
      next_pixel += u * (sobol2(pixel_stream(0, 0, x + 1, y), 1, index)[0] - .5);
      next_row += u * (sobol2(pixel_stream(0, 0, x, y + 1), 1, index)[0] - .5);
      next_dimension += u * (sobol2(pixel_stream(0, 0, x, y), 2, index)[0] - .5);
    }
    const double deviation = std::sqrt(kCount / 12.0), product = std::sqrt(kCount) / 12;
    EXPECT_LT(std::fabs(sum_u), 4 * deviation) << index;
    EXPECT_LT(std::fabs(sum_v), 4 * deviation) << index;
    for (const double sum : {uv, next_pixel, next_row, next_dimension})
      EXPECT_LT(std::fabs(sum), 4 * product) << index;
  }
}

TEST(Sobol, SeedFrameAndPixelMakeTheStream) {
  std::set<std::uint64_t> streams;
  for (const std::uint64_t seed : {0u, 1u}) {
    for (const int frame : {0, 1, -1}) {
      for (std::uint32_t x = 0; x < 4; ++x)
        for (std::uint32_t y = 0; y < 4; ++y) streams.insert(pixel_stream(seed, frame, x, y));
    }
  }
  EXPECT_EQ(streams.size(), 2u * 3 * 16);
}

}  // namespace
}  // namespace rayshade
