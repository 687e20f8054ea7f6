// SPDX-License-Identifier: MIT
// What a picture will take on a cluster, from a sparse sample of it rendered here.
#pragma once

#include <string>

#include "rayshade/cli/engine.h"
#include "rayshade/schedule/block_costs.h"

namespace pafas {

struct Estimate {
  rayshade::BlockCosts costs;     ///< predicted
  double sample_seconds = 0;      ///< processor time of the sample
  double sample_share = 0;        ///< of the picture's pixels
  std::uint64_t rank_memory = 0;  ///< bytes of a slave: what this process took, the picture not counted
  std::uint64_t picture_memory = 0;
};

/// Renders a sixteenth of the picture or less, spread evenly, and takes it for the rest.
Estimate estimate_costs(const rayshade::EnginePlan& plan, std::uint64_t scene_bytes);

/// For people: the estimate, and what the simulator makes of it on so many ranks.
std::string estimate_text(const Estimate& estimate, const rayshade::Options& options);

/// Both, to standard output, and the costs to the file of --block-costs. Returns the exit code.
int run_estimate(const rayshade::EnginePlan& plan, std::uint64_t scene_bytes);

}  // namespace pafas
