// SPDX-License-Identifier: MIT
// The inside test of polygons against the rule as it is written: a sum of quadrants over all edges.
#include "rayshade/geometry/shapes/polygon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rayshade {
namespace {

struct P2 {
  double u, v;
};

bool by_quadrants(const std::vector<P2>& polygon, P2 c) {
  const auto quadrant = [c](P2 p) {
    const int left = p.u >= c.u ? 0 : 1, below = p.v >= c.v ? 0 : 1;
    return below ? 3 - left : left;
  };
  int total = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const P2 p = polygon[i], q = polygon[(i + 1) % polygon.size()];
    const int turn = (quadrant(q) - quadrant(p) + 4) % 4;
    if (turn == 1) total += 1;
    if (turn == 3) total -= 1;
    if (turn == 2) total += (q.u - p.u) * (c.v - p.v) - (q.v - p.v) * (c.u - p.u) > 0 ? 2 : -2;
  }
  return total != 0;
}

class PolygonInside : public testing::TestWithParam<int> {};

TEST_P(PolygonInside, AgreesWithTheSumOfQuadrants) {
  const int corners = GetParam();
  constexpr unsigned kSeed = 77;
  std::mt19937 random(kSeed + static_cast<unsigned>(corners));
  std::uniform_int_distribution<int> grid(-6, 6), pick(0, corners - 1);
  std::uniform_real_distribution<double> real(-6, 6);
  int inside = 0, tested = 0;
  for (int trial = 0; trial < 60; ++trial) {
    // Corners on a coarse grid: many in one line, level, repeated; or anywhere; or a star, or a comb.
    std::vector<P2> shape;
    for (int i = 0; i < corners; ++i) {
      const double angle = 2 * 3.141592653589793 * i / corners, reach = i % 2 ? 5 : 3;
      switch (trial % 4) {
        case 0:
          shape.push_back({static_cast<double>(grid(random)), static_cast<double>(grid(random))});
          break;
        case 1:
          shape.push_back({real(random), real(random)});
          break;
        case 2:
          shape.push_back({reach * std::cos(2 * angle), reach * std::sin(2 * angle)});
          break;
        default:
          shape.push_back({static_cast<double>(i) / corners * 10 - 5, i % 2 ? 5.0 : -5.0});
      }
    }
    shape::Polygon form;
    for (const P2& p : shape) form.points.push_back({p.u, p.v, 0});
    const Polygon polygon(form);
    if (polygon.u_axis() != 0 || polygon.v_axis() != 1 || !std::isfinite(polygon.normal().z)) continue;
    for (int i = 0; i < 4000; ++i) {
      P2 c{real(random), real(random)};
      const P2 a = shape[static_cast<std::size_t>(pick(random))],
               b = shape[static_cast<std::size_t>(pick(random))];
      if (i % 5 == 1) c = a;                                       // on a corner
      if (i % 5 == 2) c.v = a.v;                                   // level with one
      if (i % 5 == 3) c = {0.5 * (a.u + b.u), 0.5 * (a.v + b.v)};  // on an edge, perhaps
      if (i % 5 == 4) c = {static_cast<double>(grid(random)), std::nextafter(a.v, i % 2 ? 9.0 : -9.0)};
      const auto [lo, hi] = std::pair{polygon.bounds().lo, polygon.bounds().hi};
      if (c.u < lo.x || c.u > hi.x || c.v < lo.y || c.v > hi.y) continue;
      const bool expected = by_quadrants(shape, c);
      // Outside of the corners' own box the winding number is zero either way.
      ASSERT_EQ(polygon.contains(c.u, c.v), expected)
          << corners << " corners, trial " << trial << ", " << c.u << ' ' << c.v;
      inside += expected;
      ++tested;
    }
  }
  EXPECT_GT(tested, 50'000);
  EXPECT_GT(inside, tested / 50);
}

INSTANTIATE_TEST_SUITE_P(Corners, PolygonInside, testing::Values(3, 4, 5, 12, 13, 31, 144, 700));

}  // namespace
}  // namespace rayshade
