// SPDX-License-Identifier: MIT
// Random hierarchies for tests, and rays toward what they hold.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "fas/hierarchy.h"
#include "tests/unit/fas/random_geometry.h"

namespace fas::test {

/// Boxes of very unlike sizes, flat and empty of volume ones among them, some in the same place.
inline std::vector<Bounds> random_boxes(Dice& dice, int count) {
  std::vector<Bounds> out;
  for (int i = 0; i < count; ++i) {
    if (i > 0 && dice.below(10) == 0) {
      out.push_back(out[static_cast<std::size_t>(dice.below(i))]);
      continue;
    }
    const Point at = dice.in_box(10);
    Bounds box{at, at};
    const double size = dice.size(-6, 0.5);
    for (double& x : box.hi) x += dice.below(4) == 0 ? 0 : size * dice.uniform();
    out.push_back(box);
  }
  return out;
}

struct Built {
  explicit Built(const std::vector<Bounds>& boxes, std::vector<std::uint8_t> given = {}, int threads = 1)
      : masks(given.empty() ? std::vector<std::uint8_t>(boxes.size(), 1) : std::move(given)),
        hierarchy(boxes, masks, threads, order) {}
  std::vector<std::uint8_t> masks;
  std::vector<std::uint32_t> order;
  Hierarchy hierarchy;
};

/// A ray through a point of a box, often one on a face or edge, often along axes or nearly so.
inline void aim(Dice& dice, const Bounds& box, double* o, double* d, double& t) {
  const Point direction = dice.direction();
  for (std::size_t i = 0; i < 3; ++i) d[i] = direction[i];
  if (dice.below(3) == 0) d[dice.below(3)] = dice.below(2) ? 0.0 : 1e-200;
  if (dice.below(4) == 0) d[dice.below(3)] = -0.0;
  if (dice.below(3) == 0) {
    const double factor = dice.size(-5, 5);
    for (int i = 0; i < 3; ++i) d[i] *= factor;
  }
  if (d[0] == 0 && d[1] == 0 && d[2] == 0) d[1] = -1;
  const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  t = std::ldexp(1, dice.below(12)) / length;
  for (std::size_t i = 0; i < 3; ++i) {
    const double share = dice.below(2) ? dice.uniform() : dice.below(2);
    const double target = share == 1 ? box.hi[i] : box.lo[i] + share * (box.hi[i] - box.lo[i]);
    o[i] = target - t * d[i];
  }
}

}  // namespace fas::test
