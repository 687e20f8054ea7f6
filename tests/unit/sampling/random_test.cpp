// SPDX-License-Identifier: MIT
// Known answers of the generator, and statistics over neighbouring addresses.
#include "rayshade/sampling/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace rayshade {
namespace {

using Block = std::array<std::uint32_t, 4>;

TEST(RandomTest, PhiloxKnownAnswers) {
  // kat_vectors of Random123.
  EXPECT_EQ(philox_block({0, 0, 0, 0}, {0, 0}), (Block{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox_block({~0u, ~0u, ~0u, ~0u}, {~0u, ~0u}),
            (Block{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox_block({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Block{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(RandomTest, NumbersAreFunctionsOfTheirAddress) {
  const RandomKey key{1, 2, 3, 4, 5};
  const double number = uniform(key, 6);
  EXPECT_EQ(number, uniform(key, 6));
  EXPECT_EQ(number, uniform2(key, 6)[0]);
  EXPECT_EQ(std::floor(number * 0x1p32) * 0x1p-32, uniform4(key, 6)[0]);
  std::set<double> seen{number};
  for (const RandomKey& other :
       {RandomKey{2, 2, 3, 4, 5}, RandomKey{1, 3, 3, 4, 5}, RandomKey{1, 2, 4, 4, 5},
        RandomKey{1, 2, 3, 5, 5}, RandomKey{1, 2, 3, 4, 6}, RandomKey{1, 2, 4, 3, 5},
        RandomKey{1, -2, 3, 4, 5}, RandomKey{std::uint64_t{1} << 63 | 1, 2, 3, 4, 5}}) {
    seen.insert(uniform(other, 6));
  }
  seen.insert(uniform(key, 7));
  seen.insert(uniform(key, std::uint64_t{6} | std::uint64_t{1} << 63));
  EXPECT_EQ(seen.size(), 11u);
}

TEST(RandomTest, TheStreamIsPinned) {
  // Pictures depend on these; a change here changes every jittered picture.
  const RandomKey key{0, 0, 10, 20, 3};
  const auto pair = uniform2(key, dimension(kRootPath, Purpose::kPixel));
  EXPECT_EQ(pair[0], 0x1.540a427ed6f8cp-1);
  EXPECT_EQ(pair[1], 0x1.770fdd22964ap-5);
}

/// Pearson's statistic of counts that should be equal, as standard deviations from its mean.
double chi_square_score(const std::vector<double>& counts) {
  double total = 0, sum = 0;
  for (const double count : counts) total += count;
  const double expected = total / static_cast<double>(counts.size());
  for (const double count : counts) sum += (count - expected) * (count - expected) / expected;
  const double degrees = static_cast<double>(counts.size()) - 1;
  return (sum - degrees) / std::sqrt(2 * degrees);
}

/// Calls visit(a, b) with the numbers at neighbouring addresses: pixels, samples, dimensions, frames and
/// seeds.
template <class Visit>
void for_neighbours(int kind, Visit visit) {
  for (std::uint32_t i = 0; i < 100000; ++i) {
    RandomKey a{7, 0, i % 317, i / 317, 0};
    RandomKey b = a;
    std::uint64_t da = dimension(kRootPath, Purpose::kPixel), db = da;
    if (kind == 0) b.x += 1;
    if (kind == 1) b.y += 1;
    if (kind == 2) b.sample += 1;
    if (kind == 3) b.frame += 1;
    if (kind == 4) b.seed += 1;
    if (kind == 5) db = dimension(kRootPath, Purpose::kTime);
    if (kind == 6) db = dimension(child_path(kRootPath, 0), Purpose::kPixel);
    if (kind == 7) {
      visit(uniform2(a, da)[0], uniform2(a, da)[1]);
      continue;
    }
    if (kind == 8) {
      visit(uniform4(a, da)[2], uniform4(a, da)[3]);
      continue;
    }
    visit(uniform(a, da), uniform(b, db));
  }
}

TEST(RandomTest, UniformAndIndependentOfItsNeighbours) {
  for (int kind = 0; kind <= 8; ++kind) {
    SCOPED_TRACE(kind);
    constexpr int kCells = 32;
    std::vector<double> counts(kCells * kCells);
    double sum = 0, product = 0;
    int n = 0;
    for_neighbours(kind, [&](double a, double b) {
      ASSERT_GE(a, 0);
      ASSERT_LT(a, 1);
      ASSERT_GE(b, 0);
      ASSERT_LT(b, 1);
      counts[static_cast<std::size_t>(a * kCells) * kCells + static_cast<std::size_t>(b * kCells)] += 1;
      sum += a;
      product += (a - 0.5) * (b - 0.5);
      ++n;
    });
    // Uniform over the square: uniform each, and independent. The bounds are four standard deviations and
    // more.
    EXPECT_LT(std::fabs(chi_square_score(counts)), 4);
    EXPECT_NEAR(sum / n, 0.5, 4 / std::sqrt(12.0 * n));
    EXPECT_NEAR(product / n * 12, 0, 4 / std::sqrt(n));
  }
}

TEST(RandomTest, FineBitsAreRandomToo) {
  std::vector<double> counts(256);
  for (std::uint32_t i = 0; i < 100000; ++i) {
    const double v = uniform({3, 0, i, 0, 0}, 1) * 0x1p45;
    counts[static_cast<std::size_t>((v - std::floor(v)) * 256)] += 1;
  }
  EXPECT_LT(std::fabs(chi_square_score(counts)), 4);
}

TEST(RandomTest, DimensionsAreDistinct) {
  std::set<std::uint64_t> seen;
  std::size_t added = 0;
  std::vector<std::uint64_t> level{kRootPath};
  for (int depth = 0; depth < 8; ++depth) {
    std::vector<std::uint64_t> next;
    for (const std::uint64_t path : level) {
      for (const Purpose purpose : {Purpose::kSampleChoice, Purpose::kPixel, Purpose::kTime, Purpose::kLens,
                                    Purpose::kLight, Purpose::kGloss}) {
        for (std::uint64_t which = 0; which < 20; ++which, ++added)
          seen.insert(dimension(path, purpose, which));
      }
      for (std::uint64_t child = 0; child < 2; ++child) next.push_back(child_path(path, child));
    }
    level = next;
  }
  EXPECT_EQ(seen.size(), added);
}

}  // namespace
}  // namespace rayshade
