// SPDX-License-Identifier: MIT
// What a rank did, as it tells the master at the end.
#pragma once

#include <cstdint>
#include <string>

#include "rayshade/render/statistics.h"

namespace pafas {

struct RankReport {
  std::string host;
  std::int64_t process = 0;
  std::uint32_t threads = 0;
  std::uint64_t blocks = 0;  ///< rendered, those that another rank had done before included
  double cpu_seconds = 0;    ///< of the rendering threads
  double wait_seconds = 0;   ///< that they waited for work, their sum
  double compile_seconds = 0;
  std::uint64_t peak_memory = 0;  ///< bytes
  rayshade::RenderStatistics statistics;

  std::uint64_t rays() const { return statistics.shading.total_rays(); }
  /// Of the hyper-trees.
  std::uint64_t tree_nodes() const;
  std::uint64_t tree_bytes() const { return statistics.intersector.pool_used; }
};

/// Adds the counts of `from` (rays, tests, samples, trees, times of threads) to those of another rank; what
/// is a property of the scene stays.
void add_counts(const rayshade::RenderStatistics& from, rayshade::RenderStatistics& into);

template <class Archive>
void fields(Archive& a, RankReport& r) {
  a(r.host, r.process, r.threads, r.blocks, r.cpu_seconds, r.wait_seconds, r.compile_seconds, r.peak_memory,
    r.statistics);
}

}  // namespace pafas

namespace rayshade {

// The counts that are sent; what the scene alone determines, the master knows.
template <class Archive>
void fields(Archive& a, RenderStatistics& s) {
  for (std::uint64_t& n : s.trace.tests) a(n);
  for (std::uint64_t& n : s.trace.hits) a(n);
  a(s.trace.bounds_tests, s.shading, s.sampling, s.intersector.method, s.intersector.classes,
    s.intersector.pool_used, s.intersector.pool_held, s.intersector.pool_budget, s.intersector.pool_exhausted,
    s.verify.nearest, s.verify.occlusion, s.verify.differing, s.peak_tree_nodes, s.cpu_seconds);
}
template <class Archive>
void fields(Archive& a, ShadingCounts& c) {
  a(c.eye_rays, c.shadow_rays, c.reflected_rays, c.transmitted_rays, c.shaded_hits, c.shadow_hits,
    c.transparent_walks, c.total_reflections, c.nearest_queries, c.occlusion_queries, c.skipped_back_lights,
    c.skipped_dark_lights, c.skipped_unshadowed, c.skipped_cutoff, c.skipped_depth, c.skipped_textures);
}
template <class Archive>
void fields(Archive& a, SamplingCounts& c) {
  a(c.pixels, c.supersampled, c.halo_samples, c.blocks);
}
template <class Archive>
void fields(Archive& a, ClassReport& c) {
  fas::TreeCounts& t = c.in_tree;
  a(c.rays, c.tree, c.light, t.rays, t.elsewhere, t.outside, t.cached_leaf, t.cached_hit, t.blocks, t.tests,
    t.hits, t.nodes, t.leaves, t.candidates, t.splits, t.truncated, t.bytes, t.nanoseconds,
    c.in_hierarchy.rays, c.in_hierarchy.tests, c.in_hierarchy.bounds_tests);
}

}  // namespace rayshade
