// SPDX-License-Identifier: MIT
// Blocks: every worker has a starting block and takes the free block that comes first in rings around it.
#pragma once

#include <cstdint>
#include <unordered_map>

#include "rayshade/schedule/free_blocks.h"
#include "rayshade/schedule/schedule.h"
#include "rayshade/schedule/starting_blocks.h"

namespace rayshade {

class RingBlocks final : public Schedule {
 public:
  RingBlocks(const BlockGrid& grid, StartingBlocks starts, int workers);
  std::int64_t next(int worker) override;

 private:
  BlockGrid grid_;
  StartingBlocks starts_;
  int workers_;
  FreeBlocks free_;
  std::unordered_map<int, std::int64_t>
      place_;  ///< in the pattern, of each worker: nothing before it is free
};

}  // namespace rayshade
