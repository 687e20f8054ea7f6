// SPDX-License-Identifier: MIT
// Where workers start in the picture, so that they meet late.
#pragma once

#include <cstdint>
#include <string_view>

#include "rayshade/schedule/block_grid.h"

namespace rayshade {

/// For a picture of n blocks per side (where its sides differ, circles are ellipses):
enum class StartingBlocks : std::uint8_t {
  kThird,       ///< evenly on a circle of diameter n / 3 around the centre
  kHalf,        ///< on one of diameter n / 2
  kTwoCircles,  ///< every third worker on a circle of diameter n / 3, the others on one of diameter n; where
                ///< there are no more than 8 workers, all are on the larger
};

/// "third", "half" or "two-circles"; the empty name is "two-circles". Throws std::invalid_argument.
StartingBlocks parse_starting_blocks(std::string_view name);

/// The block with which worker `worker` of `workers` starts. Several may have the same one. Workers that come
/// in addition (worker >= workers) start where an earlier one did.
std::int64_t starting_block(StartingBlocks scheme, const BlockGrid& grid, int worker, int workers);

}  // namespace rayshade
