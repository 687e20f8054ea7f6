// SPDX-License-Identifier: MIT
#include "pafas/estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

#include "pafas/simulator.h"
#include "rayshade/cli/program.h"
#include "rayshade/cli/progress.h"
#include "rayshade/image/output_file.h"

namespace pafas {

using namespace rayshade;

namespace {

/// Cells of which a probe in the middle is rendered, a quarter as wide and high. Large pictures have larger
/// cells.
constexpr int kCell = 32;
constexpr int kMostCells = 64;  ///< per side of the picture

class ProbeFeed final : public BlockFeed {
 public:
  ProbeFeed(const BlockGrid& cells, int probe) : cells_(cells), probe_(probe) {
    seconds.resize(static_cast<std::size_t>(cells.count()));
  }
  std::optional<Block> next() override {
    const std::int64_t i = next_.fetch_add(1);
    if (closed_ || i >= cells_.count()) return {};
    return probe_of(i);
  }
  Block probe_of(std::int64_t i) const {
    Block block = cells_.block(i);
    const int width = std::min(probe_, block.width), height = std::min(probe_, block.height);
    return {i, block.x + (block.width - width) / 2, block.y + (block.height - height) / 2, width, height};
  }
  void finished(const Block& block, EncodedBlock&&, const BlockCost& cost) override {
    const std::lock_guard lock(mutex_);
    seconds[static_cast<std::size_t>(block.number)] = cost.seconds;
    pixels += block.pixels();
  }
  void close() override { closed_ = true; }

  std::vector<double> seconds;
  std::int64_t pixels = 0;

 private:
  const BlockGrid& cells_;
  int probe_;
  std::mutex mutex_;
  std::atomic<std::int64_t> next_{0};
  std::atomic<bool> closed_{false};
};

}  // namespace

Estimate estimate_costs(const EnginePlan& plan, std::uint64_t scene_bytes) {
  const int width = plan.settings.window_width(), height = plan.settings.window_height();
  const int cell = std::max(kCell, (std::max(width, height) - 1) / kMostCells + 1);
  const int probe = std::max(kCell / 4, 16);
  const BlockGrid cells(width, height, cell);
  ProbeFeed feed(cells, std::min(probe, cell / 2));
  const int threads = rendering_options(plan.options, 1).threads;
  const auto crew = plan.renderer.start_frame(plan.settings.first_frame, plan.format, feed, threads);
  while (!crew->wait(.1)) {
  }
  plan.renderer.finish_frame(*crew);
  const RenderStatistics& seen = plan.renderer.statistics();

  Estimate out;
  out.sample_share = static_cast<double>(feed.pixels) / (static_cast<double>(width) * height);
  BlockCosts& costs = out.costs;
  costs.width = width;
  costs.height = height;
  costs.side = cell;
  costs.samples = plan.settings.samples;
  costs.scene_bytes = scene_bytes;
  costs.compile_seconds = seen.compile_seconds;
  costs.result_bytes_per_pixel = static_cast<double>(pixel_size(plan.format.storage));
  double building = 0;
  for (const ClassReport& c : seen.intersector.classes)
    building += 1e-9 * static_cast<double>(c.in_tree.nanoseconds);
  // Trees grow with a small power of the rays; the samples beyond the borders of probes are many, those of
  // blocks few.
  const double sampled = static_cast<double>(feed.pixels);
  const double single = sampled / (sampled + static_cast<double>(seen.sampling.halo_samples));
  const double all_samples = static_cast<double>(plan.settings.samples) * plan.settings.samples;
  const double work = plan.settings.sobol()
                          ? static_cast<double>(seen.shading.eye_rays)
                          : sampled + all_samples * static_cast<double>(seen.sampling.supersampled) +
                                static_cast<double>(seen.sampling.halo_samples);
  const double halo =
      plan.settings.samples > 1 ? static_cast<double>(seen.sampling.halo_samples) / work : 1 - single;
  costs.tree_region_seconds = building * std::pow(1 / std::max(out.sample_share, 1e-6), .2);
  double sum = 0;
  for (const double s : feed.seconds) sum += s;
  out.sample_seconds = sum;
  const double without_trees = std::max(0.0, 1 - building / std::max(sum, 1e-9)) * (1 - halo);
  for (std::int64_t i = 0; i < cells.count(); ++i) {
    const Block block = cells.block(i), probed = feed.probe_of(i);
    const double scale = static_cast<double>(block.pixels()) / static_cast<double>(probed.pixels());
    costs.blocks.push_back(block);
    costs.seconds.push_back(feed.seconds[static_cast<std::size_t>(i)] * scale * without_trees);
  }
  const double plain = costs.total_seconds();
  for (double& s : costs.seconds) s *= 1 + costs.tree_region_seconds / std::max(plain, 1e-9);

  out.rank_memory = peak_memory();
  out.picture_memory = estimate_picture_bytes(plan.settings, pixel_size(plan.format.storage));
  return out;
}

std::string estimate_text(const Estimate& estimate, const Options& options) {
  const BlockCosts& costs = estimate.costs;
  std::string out = fmt::format("sampled {:.1f} % of the picture in {} of processor time\n",
                                100 * estimate.sample_share, duration_text(estimate.sample_seconds));
  out += fmt::format("processor time of the whole picture: {}, {} of it for trees in one process\n",
                     duration_text(costs.total_seconds()), duration_text(costs.tree_region_seconds));
  const SimulatorReport report = simulate(costs, simulator_options(options, options.cluster.estimate));
  out += fmt::format("on {} rank{} of one thread: {}, speed-up {:.2f} (schedule {})\n", report.ranks,
                     report.ranks == 1 ? "" : "s", duration_text(report.makespan_seconds), report.speed_up,
                     report.schedule);
  out += fmt::format("memory: {:.0f} MB for each rank, and {:.0f} MB for the picture on rank 0\n",
                     static_cast<double>(estimate.rank_memory) / 1e6,
                     static_cast<double>(estimate.picture_memory) / 1e6);
  return out;
}

int run_estimate(const EnginePlan& plan, std::uint64_t scene_bytes) {
  const Estimate estimate = estimate_costs(plan, scene_bytes);
  fmt::print("{}", estimate_text(estimate, plan.options));
  if (plan.options.block_costs) write_block_costs(estimate.costs, *plan.options.block_costs);
  return kComplete;
}

}  // namespace pafas
