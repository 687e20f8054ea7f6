// SPDX-License-Identifier: MIT
#include "rayshade/cli/cluster_options.h"

#include <algorithm>

#include "rayshade/cli/options.h"
#include "rayshade/schedule/granularity.h"

namespace rayshade {
namespace {

using Values = std::span<const std::string>;
constexpr const char* kCluster = "Cluster";
/// More than any machine has, and few enough for the memory of one that simulates them.
constexpr int kMostRanks = 1'000'000;

/// The value, if it is one of the choices.
std::string chosen(const std::string& option, const std::string& value,
                   const std::vector<const char*>& choices) {
  if (std::find(choices.begin(), choices.end(), value) != choices.end()) return value;
  std::string list;
  for (const char* choice : choices) list += (list.empty() ? "" : ", ") + std::string(choice);
  throw UsageError(option + ": '" + value + "' is none of " + list);
}

}  // namespace

std::vector<OptionSpec> cluster_option_table() {
  const std::vector<const char*> schedules = {"auto", "roundrobin", "bands", "blocks", "cost"};
  const std::vector<const char*> starts = {"third", "half", "two-circles"};
  return {
      {0,
       "schedule",
       {"NAME"},
       kCluster,
       "Who renders which blocks: roundrobin (scan lines in turn), bands (pairs of scan lines), blocks "
       "(rings "
       "around a starting block), cost (blocks by what they are expected to cost) or auto (the default: the "
       "best of them for the number of ranks). The picture is the same.",
       [schedules](Options& o, Values v) { o.cluster.schedule = chosen("--schedule", v[0], schedules); },
       schedules},
      {0,
       "start",
       {"PLACE"},
       kCluster,
       "Where the starting blocks of the blocks schedule lie: on a circle a third as wide as the picture "
       "(third), on one half as wide (half), or on two circles (two-circles, the default).",
       [starts](Options& o, Values v) { o.cluster.start = chosen("--start", v[0], starts); },
       starts},
      {0,
       "granularity",
       {"N"},
       kCluster,
       "Blocks per message at most; messages have fewer toward the end. 0 (the default): chosen.",
       [](Options& o, Values v) {
         o.cluster.granularity = parse_int(v[0], "--granularity", 0, kMostBlocksPerMessage);
       }},
      {0,
       "dedicated-master",
       {},
       kCluster,
       "Rank 0 hands out work and renders none.",
       [](Options& o, Values) { o.cluster.dedicated_master = true; }},
      {0,
       "tile-map",
       {"FILE.png"},
       kCluster,
       "Write a picture that shows by colour which rank rendered which block.",
       [](Options& o, Values v) { o.cluster.tile_map = v[0]; },
       {"FILE"}},
      {0,
       "timeline",
       {"FILE.svg"},
       kCluster,
       "Draw when each rank rendered which blocks.",
       [](Options& o, Values v) { o.cluster.timeline = v[0]; },
       {"FILE"}},
      {0,
       "simulate",
       {"N"},
       kCluster,
       "Do not render: replay the block costs of --costs on N simulated ranks with the chosen schedule, and "
       "report how long they take, how well they are used, and what they say to each other.",
       [](Options& o, Values v) { o.cluster.simulate = parse_int(v[0], "--simulate", 1, kMostRanks); }},
      {0,
       "costs",
       {"FILE"},
       kCluster,
       "Block costs, as --block-costs wrote them, to simulate with; or for the cost schedule to begin with.",
       [](Options& o, Values v) { o.cluster.costs = v[0]; },
       {"FILE"}},
      {0,
       "assume",
       {"KEY=VALUE"},
       kCluster,
       "An assumption of --simulate and --estimate; may be given several times. latency (seconds of a "
       "message), "
       "bandwidth (bytes per second), start and compile (seconds until a rank can be reached, and from then "
       "until "
       "it can render), service (seconds of the master per message), spread (speeds differ by so much, from "
       "0 to "
       "1), deaths (share of the ranks that die), silence (seconds until that is noticed), seed.",
       [](Options& o, Values v) { o.cluster.assume.push_back(v[0]); }},
      {0,
       "estimate",
       {"N"},
       kCluster,
       "Render a sparse sample of the picture on this machine, predict from it how long N ranks will take "
       "and how much memory each needs, and stop.",
       [](Options& o, Values v) { o.cluster.estimate = parse_int(v[0], "--estimate", 1, kMostRanks); }},
  };
}

}  // namespace rayshade
