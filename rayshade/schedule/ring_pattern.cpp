// SPDX-License-Identifier: MIT
#include "rayshade/schedule/ring_pattern.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace rayshade {
namespace {

// Sides as they follow each other for one k. For k = 0 and for the corners there are four of them, else
// eight.
constexpr RingOffset at_side(int ring, int along, int side) {
  switch (side) {
    case 0:
      return {-ring, along};
    case 1:
      return {ring, -along};
    case 2:
      return {-ring, -along};
    case 3:
      return {ring, along};
    case 4:
      return {-along, ring};
    case 5:
      return {along, -ring};
    case 6:
      return {-along, -ring};
    default:
      return {along, ring};
  }
}

}  // namespace

RingOffset ring_offset(std::int64_t place) {
  if (place == 0) return {};
  auto ring = static_cast<std::int64_t>((std::sqrt(static_cast<double>(place)) + 1) / 2);
  while ((2 * ring - 1) * (2 * ring - 1) > place) --ring;
  while ((2 * ring + 1) * (2 * ring + 1) <= place) ++ring;
  const std::int64_t within = place - (2 * ring - 1) * (2 * ring - 1);
  const int r = static_cast<int>(ring);
  if (within < 4) {
    constexpr int kSides[4] = {0, 1, 4, 5};
    return at_side(r, 0, kSides[within]);
  }
  return at_side(r, static_cast<int>((within - 4) / 8) + 1, static_cast<int>((within - 4) % 8));
}

RingRank ring_rank(RingOffset offset) {
  const int ring = std::max(std::abs(offset.x), std::abs(offset.y));
  const int along = std::min(std::abs(offset.x), std::abs(offset.y));
  for (int side = 0; side < 8; ++side)
    if (at_side(ring, along, side) == offset) return {ring, along, side};
  return {ring, along, 8};  // not reached: one of the eight sides always matches
}

std::int64_t ring_place(RingOffset offset) {
  const RingRank rank = ring_rank(offset);
  if (rank.ring == 0) return 0;
  const std::int64_t first = (2 * std::int64_t{rank.ring} - 1) * (2 * std::int64_t{rank.ring} - 1);
  if (rank.along == 0) return first + (rank.side < 4 ? rank.side : rank.side - 2);
  return first + 4 + 8 * (std::int64_t{rank.along} - 1) + rank.side;
}

}  // namespace rayshade
