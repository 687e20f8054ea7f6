// SPDX-License-Identifier: MIT
// The order in which a worker prefers blocks around the one it started with: ring by ring.
//
// Ring r holds the 8 r blocks at a larger coordinate difference of r. Within a ring, those nearest to the
// axes through the start come first: at offset k along the sides the left, right, lower and upper block (k =
// 0); then for each k the left and right sides, below and above in turn, and the lower and upper sides alike;
// the corners (k = r) last. Turned about the start, every second block is opposite to the one before, so that
// the rendered region stays round and centred.
#pragma once

#include <compare>
#include <cstdint>

namespace rayshade {

/// Blocks from the start to the right and downward.
struct RingOffset {
  int x = 0, y = 0;
  bool operator==(const RingOffset&) const = default;
};

/// The offset at a place of the pattern, from 0 (the start itself).
RingOffset ring_offset(std::int64_t place);

/// Orders offsets as the pattern does.
struct RingRank {
  int ring = 0, along = 0, side = 0;
  auto operator<=>(const RingRank&) const = default;
};
RingRank ring_rank(RingOffset offset);

/// The place of an offset in the pattern: the inverse of ring_offset.
std::int64_t ring_place(RingOffset offset);

}  // namespace rayshade
