// SPDX-License-Identifier: MIT
// Bands: every worker starts with a pair of neighbouring scan lines, the pairs spread evenly over the
// picture, and goes on with the lines nearest to those it has had.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "rayshade/schedule/schedule.h"

namespace rayshade {

/// The first of the two lines with which a worker of `workers` starts, in a picture of `lines`: the first
/// worker has the first two, the last worker the last two.
std::int64_t first_band(std::int64_t lines, int worker, int workers);

class Bands final : public Schedule {
 public:
  Bands(std::int64_t lines, int workers);
  std::int64_t next(int worker) override;

 private:
  /// A worker's lines reach from first to last: what lies between has been given to it or to others.
  struct Reach {
    std::int64_t first = 0, last = 0;
  };
  std::int64_t free_at_or_after(std::int64_t line);
  std::int64_t free_at_or_before(std::int64_t line);

  std::int64_t lines_;
  int workers_;
  std::vector<std::int64_t> after_, before_;  ///< from each line, where to go on looking for a free one
  std::unordered_map<int, Reach> reach_;
};

}  // namespace rayshade
