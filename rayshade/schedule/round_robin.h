// SPDX-License-Identifier: MIT
// Round robin: scan line s belongs to worker s mod n.
#pragma once

#include <cstdint>
#include <vector>

#include "rayshade/schedule/schedule.h"

namespace rayshade {

/// Static: a worker has no lines but its own, until those of workers at rest (which have not come, are lost,
/// or do not fetch more) are the only ones left.
class RoundRobin final : public Schedule {
 public:
  RoundRobin(std::int64_t blocks, int workers);
  std::int64_t next(int worker) override;
  void rest(int worker, bool at_rest) override;

 private:
  std::int64_t take(int owner);
  void set_listed(int owner, bool listed);

  std::int64_t blocks_;
  int workers_;
  std::vector<std::int64_t> next_;  ///< of each owner
  std::vector<int> at_rest_;        ///< owners at rest that have lines left
  std::vector<int> place_;          ///< of an owner in at_rest_, or -1
};

}  // namespace rayshade
