// SPDX-License-Identifier: MIT
// What a rendering did. Threads count for themselves; the sums do not depend on timing, except for the times.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rayshade/geometry/compiled_scene.h"
#include "rayshade/geometry/intersector_report.h"
#include "rayshade/geometry/trace.h"
#include "rayshade/geometry/verify.h"
#include "rayshade/shading/counts.h"

namespace rayshade {

/// Counts of one block renderer.
struct SamplingCounts {
  std::uint64_t pixels = 0;
  std::uint64_t supersampled = 0;  ///< pixels that got all their samples, borders included
  std::uint64_t halo_samples = 0;  ///< single samples beyond the border of a block, for refinement
  std::uint64_t blocks = 0;
  void add(const SamplingCounts& o) {
    pixels += o.pixels;
    supersampled += o.supersampled;
    halo_samples += o.halo_samples;
    blocks += o.blocks;
  }
};

struct RenderStatistics {
  TraceCounts trace;
  ShadingCounts shading;
  SamplingCounts sampling;
  CompileCounts compile;
  IntersectorReport intersector;
  std::vector<std::string> light_names;  ///< of ClassReport::light
  VerifyCounts verify;
  double verify_share = 0;  ///< of queries that were asked again of brute force
  /// In the pictures of this run's frames, whoever rendered their pixels: earlier runs, other ranks.
  std::uint64_t nan_pixels = 0, negative_pixels = 0;
  std::uint64_t peak_tree_nodes = 0;
  double compile_seconds = 0;  ///< wall clock
  double render_seconds = 0;   ///< wall clock, all frames
  double cpu_seconds = 0;      ///< of the rendering threads
  int threads = 1;
  int frames = 0;
  // Features that the scene does not use, and whose code therefore never ran:
  bool without_motion = false, without_lens = false, without_csg = false, without_transparency = false,
       without_textures = false, without_atmosphere = false;
};

}  // namespace rayshade
