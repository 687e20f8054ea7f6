// SPDX-License-Identifier: MIT
#include "pafas/rank_report.h"

#include <algorithm>

namespace pafas {

std::uint64_t RankReport::tree_nodes() const {
  std::uint64_t nodes = 0;
  for (const rayshade::ClassReport& c : statistics.intersector.classes) nodes += c.in_tree.nodes;
  return nodes;
}

void add_counts(const rayshade::RenderStatistics& from, rayshade::RenderStatistics& into) {
  into.trace.add(from.trace);
  into.shading.add(from.shading);
  into.sampling.add(from.sampling);
  rayshade::IntersectorReport& report = into.intersector;
  if (report.method == rayshade::IntersectorReport::Method::kUnknown) report.method = from.intersector.method;
  for (const rayshade::ClassReport& c : from.intersector.classes) {
    const auto same = std::find_if(report.classes.begin(), report.classes.end(),
                                   [&](const auto& o) { return o.rays == c.rays && o.light == c.light; });
    if (same != report.classes.end())
      same->add(c);
    else
      report.classes.push_back(c);
  }
  // Of the largest rank: memory is bounded on each machine.
  report.pool_used = std::max(report.pool_used, from.intersector.pool_used);
  report.pool_held = std::max(report.pool_held, from.intersector.pool_held);
  report.pool_budget = std::max(report.pool_budget, from.intersector.pool_budget);
  report.pool_exhausted |= from.intersector.pool_exhausted;
  into.verify.nearest += from.verify.nearest;
  into.verify.occlusion += from.verify.occlusion;
  into.verify.differing += from.verify.differing;
  into.peak_tree_nodes = std::max(into.peak_tree_nodes, from.peak_tree_nodes);
  into.cpu_seconds += from.cpu_seconds;
}

}  // namespace pafas
