// SPDX-License-Identifier: MIT
#include "rayshade/schedule/schedule.h"

#include <stdexcept>

#include "rayshade/schedule/bands.h"
#include "rayshade/schedule/cost_order.h"
#include "rayshade/schedule/ring_blocks.h"
#include "rayshade/schedule/round_robin.h"

namespace rayshade {
namespace {

constexpr int kManyWorkers = 64;

}  // namespace

std::string resolve_schedule(const std::string& name) {
  return name.empty() || name == "auto" ? "cost" : name;
}

BlockGrid schedule_grid(int width, int height, const ScheduleOptions& options) {
  const std::string name = resolve_schedule(options.name);
  if (name == "roundrobin" || name == "bands") return BlockGrid::scan_lines(width, height);
  if (options.block_side > 0) return {width, height, options.block_side};
  // With many workers the last blocks of some take a good part of the whole time: smaller ones are worth
  // their borders.
  const int workers = options.workers > kManyWorkers ? 4 * options.workers : options.workers;
  return {width, height, default_block_side(width, height, workers)};
}

std::unique_ptr<Schedule> make_schedule(const ScheduleOptions& options, const BlockGrid& grid,
                                        const CostForecast& forecast) {
  const std::string name = resolve_schedule(options.name);
  const StartingBlocks starts = parse_starting_blocks(options.starts);
  if (name == "roundrobin") return std::make_unique<RoundRobin>(grid.count(), options.workers);
  if (name == "bands") return std::make_unique<Bands>(grid.count(), options.workers);
  if (name == "blocks") return std::make_unique<RingBlocks>(grid, starts, options.workers);
  if (name == "cost") return std::make_unique<CostOrder>(grid, forecast);
  throw std::invalid_argument("unknown schedule '" + options.name + "'");
}

}  // namespace rayshade
