// SPDX-License-Identifier: MIT
// Sample numbers and filter weights, computed once per picture.
#include "rayshade/sampling/grid.h"

#include <algorithm>
#include <span>
#include <stdexcept>

#include "rayshade/math/functions.h"

namespace rayshade {
namespace {

constexpr int kLargestTable = 8;
constexpr int kLargestSide = 64;

// shading.md 7.6; those of 6, 7 and 8 as printed there, from 1.
constexpr std::uint16_t kTable1[] = {0};
constexpr std::uint16_t kTable2[] = {0, 2, 3, 1};
constexpr std::uint16_t kTable3[] = {0, 2, 7, 6, 5, 1, 3, 8, 4};
constexpr std::uint16_t kTable4[] = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
constexpr std::uint16_t kTable5[] = {0, 8, 23, 17, 2,  19, 12, 4,  20, 15, 3,  21, 16,
                                     9, 6, 14, 10, 24, 1,  13, 22, 7,  18, 11, 5};
constexpr std::uint16_t kTable6[] = {6,  32, 3,  34, 35, 1,  7,  11, 27, 28, 8,  30, 24, 14, 16, 15, 23, 19,
                                     13, 20, 22, 21, 17, 18, 25, 29, 10, 9,  26, 12, 36, 5,  33, 4,  2,  31};
constexpr std::uint16_t kTable7[] = {22, 47, 16, 41, 10, 35, 4,  5,  23, 48, 17, 42, 11, 29, 30, 6,  24,
                                     49, 18, 36, 12, 13, 31, 7,  25, 43, 19, 37, 38, 14, 32, 1,  26, 44,
                                     20, 21, 39, 8,  33, 2,  27, 45, 46, 15, 40, 9,  34, 3,  28};
constexpr std::uint16_t kTable8[] = {8,  58, 59, 5,  4,  62, 63, 1,  49, 15, 14, 52, 53, 11, 10, 56,
                                     41, 23, 22, 44, 45, 19, 18, 48, 32, 34, 35, 29, 28, 38, 39, 25,
                                     40, 26, 27, 37, 36, 30, 31, 33, 17, 47, 46, 20, 21, 43, 42, 24,
                                     9,  55, 54, 12, 13, 51, 50, 16, 64, 2,  3,  61, 60, 6,  7,  57};
constexpr std::span<const std::uint16_t> kTables[] = {{},      kTable1, kTable2, kTable3, kTable4,
                                                      kTable5, kTable6, kTable7, kTable8};

/// 0 ... n - 1 in the order in which van der Corput's sequence visits n places: neighbours end up far apart.
std::vector<int> scattered(int n) {
  std::vector<int> out;
  for (unsigned i = 0; i < 64; ++i) {
    unsigned reversed = 0;
    for (unsigned bit = 0; bit < 6; ++bit) reversed |= (i >> bit & 1u) << (5 - bit);
    if (reversed < static_cast<unsigned>(n)) out.push_back(static_cast<int>(reversed));
  }
  return out;
}

/// Lens column p = i + j and lens row (coarse time) q = i + 2 j, modulo N: for odd N these are two orthogonal
/// Latin squares, so each row and column of the pixel meets each column and row of the lens exactly once, and
/// each pair (p, q) occurs once. For even N no such pair of linear squares exists: there q = i + 2 j + [j >=
/// N/2], which is a Latin square too and gives each pair once when the last row is moved by N/2.
std::vector<std::uint16_t> latin_numbers(int n) {
  const std::vector<int> order = scattered(n);
  std::vector<std::uint16_t> out;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int p = (i + j) % n;
      int q = i + 2 * j;
      if (n % 2 == 0 && j >= n / 2) q += j == n - 1 ? 1 + n / 2 : 1;
      q %= n;
      const int s = order[static_cast<std::size_t>(p)] + n * order[static_cast<std::size_t>(q)];
      out.push_back(static_cast<std::uint16_t>(s));
    }
  }
  return out;
}

void require_side(int n) {
  if (n < 1 || n > kLargestSide) throw std::invalid_argument("samples per side must be 1 to 64");
}

}  // namespace

std::vector<std::uint16_t> sample_numbers(int samples_per_side) {
  require_side(samples_per_side);
  if (samples_per_side > kLargestTable) return latin_numbers(samples_per_side);
  const auto table = kTables[samples_per_side];
  std::vector<std::uint16_t> out(table.begin(), table.end());
  const std::uint16_t first = *std::min_element(out.begin(), out.end());
  for (std::uint16_t& s : out) s = static_cast<std::uint16_t>(s - first);
  return out;
}

std::vector<double> filter_weights(int samples_per_side, FilterKind kind, double width) {
  require_side(samples_per_side);
  const int n = samples_per_side;
  std::vector<double> out(static_cast<std::size_t>(n * n), 1.0 / (n * n));
  if (kind == FilterKind::kBox) return out;
  double sum = 0;
  for (int k = 0; k < n * n; ++k) {
    const auto center = [&](int cell) { return -width / 2 + width / (2 * n) + cell * width / n; };
    const double a = center(k % n), b = center(k / n);
    out[static_cast<std::size_t>(k)] = fn::exp(-(a * a + b * b) / 2);
    sum += out[static_cast<std::size_t>(k)];
  }
  // A filter so wide that every weight vanishes says nothing: box weights then.
  for (double& weight : out) weight = sum > 0 ? weight / sum : 1.0 / (n * n);
  return out;
}

SampleGrid::SampleGrid(int samples_per_side, bool jitter, FilterKind kind, double width)
    : side_(samples_per_side),
      jitter_(jitter),
      width_(width),
      weights_(filter_weights(samples_per_side, kind, width)),
      numbers_(sample_numbers(samples_per_side)) {
  for (int k = 0; k < count(); ++k) {
    corners_.push_back({-width / 2 + k % samples_per_side * width / samples_per_side,
                        -width / 2 + k / samples_per_side * width / samples_per_side});
  }
}

}  // namespace rayshade
