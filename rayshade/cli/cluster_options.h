// SPDX-License-Identifier: MIT
// Options that only the program for a cluster has.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace rayshade {

struct ClusterOptions {
  std::string schedule = "auto";      ///< name of a schedule (rayshade/schedule)
  std::string start = "two-circles";  ///< where the blocks schedule starts
  int granularity = 0;                ///< blocks per message at most; 0: chosen
  bool dedicated_master = false;      ///< rank 0 renders nothing
  int simulate = 0;                   ///< ranks to simulate; 0: render
  int estimate = 0;                   ///< ranks to predict time and memory for; 0: render
  std::optional<std::string> costs;   ///< file of block costs to simulate with, or to begin with
  std::vector<std::string> assume;    ///< KEY=VALUE for the simulator
  std::optional<std::string> tile_map, timeline;

  /// Whether rank 0 of so many renders nothing; one rank alone does.
  bool master_only_serves(int ranks) const { return dedicated_master && ranks > 1; }
  /// How many of so many ranks render.
  int renderers(int ranks) const { return master_only_serves(ranks) ? ranks - 1 : ranks; }
};

}  // namespace rayshade
