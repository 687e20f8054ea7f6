// SPDX-License-Identifier: MIT
// Sample numbers, offsets and weights against the tables and formulas of shading.md 7.
#include "rayshade/sampling/grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

namespace rayshade {
namespace {

TEST(SampleGridTest, NumbersAreAPermutation) {
  for (int n = 1; n <= 64; ++n) {
    std::vector<std::uint16_t> numbers = sample_numbers(n);
    ASSERT_EQ(numbers.size(), static_cast<std::size_t>(n * n));
    std::sort(numbers.begin(), numbers.end());
    for (std::size_t i = 0; i < numbers.size(); ++i) ASSERT_EQ(numbers[i], i) << n;
  }
}

TEST(SampleGridTest, NumbersOfTheOriginal) {
  // shading.md 7.6; 6 and 8 counted from 0.
  EXPECT_EQ(sample_numbers(1), (std::vector<std::uint16_t>{0}));
  EXPECT_EQ(sample_numbers(2), (std::vector<std::uint16_t>{0, 2, 3, 1}));
  EXPECT_EQ(sample_numbers(3), (std::vector<std::uint16_t>{0, 2, 7, 6, 5, 1, 3, 8, 4}));
  EXPECT_EQ(sample_numbers(6)[0], 5);
  EXPECT_EQ(sample_numbers(6)[35], 30);
  EXPECT_EQ(sample_numbers(7)[48], 27);
  EXPECT_EQ(sample_numbers(8)[0], 7);
  EXPECT_EQ(sample_numbers(8)[56], 63);
}

TEST(SampleGridTest, OurOwnNumbersAreStratified) {
  // Every row and every column of the pixel meets every lens column, and every lens row (a coarse slice of
  // time) once; with an even number of samples per side one slice may occur twice in a column.
  for (int n = 9; n <= 64; ++n) {
    const std::vector<std::uint16_t> numbers = sample_numbers(n);
    for (int a = 0; a < n; ++a) {
      std::set<int> row_p, row_q, column_p, column_q;
      for (int b = 0; b < n; ++b) {
        const int in_row = numbers[static_cast<std::size_t>(b + n * a)];
        const int in_column = numbers[static_cast<std::size_t>(a + n * b)];
        row_p.insert(in_row % n);
        row_q.insert(in_row / n);
        column_p.insert(in_column % n);
        column_q.insert(in_column / n);
      }
      const auto all = static_cast<std::size_t>(n);
      EXPECT_EQ(row_p.size(), all);
      EXPECT_EQ(row_q.size(), all);
      EXPECT_EQ(column_p.size(), all);
      EXPECT_GE(column_q.size(), n % 2 == 0 ? all - 1 : all) << n;
    }
  }
}

TEST(SampleGridTest, OurOwnNumbersScatterNeighbours) {
  // The mean distance in time of neighbouring cells is near that of independent ones (1/3 of the interval).
  for (const int n : {9, 16, 31, 64}) {
    const std::vector<std::uint16_t> numbers = sample_numbers(n);
    double along = 0, across = 0;
    int count = 0;
    for (int j = 0; j + 1 < n; ++j) {
      for (int i = 0; i + 1 < n; ++i, ++count) {
        const auto at = [&](int x, int y) {
          return static_cast<int>(numbers[static_cast<std::size_t>(x + n * y)]);
        };
        along += std::abs(at(i, j) - at(i + 1, j));
        across += std::abs(at(i, j) - at(i, j + 1));
      }
    }
    EXPECT_GT(along / count / (n * n), 0.25) << n;
    EXPECT_GT(across / count / (n * n), 0.2) << n;
  }
}

TEST(SampleGridTest, OffsetsAreLowCornersWithoutJitter) {
  const SampleGrid single(1, false, FilterKind::kBox, 1);
  EXPECT_EQ(single.offset(0, 0.9, 0.9), (std::array{-0.5, -0.5}));
  const SampleGrid grid(4, false, FilterKind::kBox, 1);
  EXPECT_EQ(grid.count(), 16);
  EXPECT_EQ(grid.offset(0, 0.9, 0.9), (std::array{-0.5, -0.5}));
  EXPECT_EQ(grid.offset(1, 0.9, 0.9), (std::array{-0.25, -0.5}));
  EXPECT_EQ(grid.offset(7, 0.9, 0.9), (std::array{0.25, -0.25}));
  const SampleGrid wide(1, false, FilterKind::kGauss, 1.8);
  EXPECT_EQ(wide.offset(0, 0, 0), (std::array{-0.9, -0.9}));
}

TEST(SampleGridTest, JitterStaysInItsCell) {
  const SampleGrid grid(3, true, FilterKind::kGauss, 1.8);
  for (int k = 0; k < 9; ++k) {
    for (const double xi : {0.0, 0.3, 0.999999}) {
      const auto at = grid.offset(k, xi, 1 - xi - 1e-6);
      EXPECT_NEAR(at[0], -0.9 + (k % 3 + xi) * 0.6, 1e-12);
      EXPECT_NEAR(at[1], -0.9 + (k / 3 + 1 - xi - 1e-6) * 0.6, 1e-12);
    }
  }
}

TEST(SampleGridTest, BoxWeightsAreEqual) {
  for (const int n : {1, 3, 7, 64}) {
    for (const double w : filter_weights(n, FilterKind::kBox, 1)) EXPECT_EQ(w, 1.0 / (n * n));
  }
}

TEST(SampleGridTest, GaussWeightsFollowTheBell) {
  // shading.md 7.2, by hand for N = 2, W = 1.8: all four cells are alike; for N = 3 the ratios are
  // exp(-0.6^2/2).
  for (const double w : filter_weights(2, FilterKind::kGauss, 1.8)) EXPECT_NEAR(w, 0.25, 1e-15);
  const std::vector<double> w = filter_weights(3, FilterKind::kGauss, 1.8);
  EXPECT_NEAR(w[1] / w[4], std::exp(-0.18), 1e-14);
  EXPECT_NEAR(w[3] / w[4], std::exp(-0.18), 1e-14);
  EXPECT_NEAR(w[8] / w[4], std::exp(-0.36), 1e-14);
  for (const int n : {1, 4, 9, 33}) {
    const std::vector<double> all = filter_weights(n, FilterKind::kGauss, 2.5);
    EXPECT_NEAR(std::accumulate(all.begin(), all.end(), 0.0), 1, 1e-13);
    EXPECT_NEAR(all.front(), all.back(), 1e-15);
  }
  // A filter too wide for its bell still has weights.
  for (const double x : filter_weights(2, FilterKind::kGauss, 1e6)) EXPECT_EQ(x, 0.25);
}

TEST(SampleGridTest, SizesAreChecked) {
  EXPECT_THROW(sample_numbers(0), std::invalid_argument);
  EXPECT_THROW(SampleGrid(65, true, FilterKind::kBox, 1), std::invalid_argument);
}

}  // namespace
}  // namespace rayshade
