// SPDX-License-Identifier: MIT
// The one pure function of all intersectors: exact(leaf, ray, interval), and the loops over groups that CSG operands
// and instances need. Everything a thread must remember between calls is in its own TraceScratch.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "rayshade/geometry/compiled_scene.h"
#include "rayshade/geometry/hit.h"

namespace rayshade {

/// Work done, by kind of leaf; added up over threads at the end.
struct TraceCounts {
  std::array<std::uint64_t, kLeafKinds> tests{};
  std::array<std::uint64_t, kLeafKinds> hits{};
  std::uint64_t bounds_tests = 0;
  void add(const TraceCounts& other);
  std::uint64_t total_tests() const;
};

/// The placement of an animated leaf, or the level transform of an animated list, at the time of the ray at hand;
/// recomputed only when the time changes. One per thread.
class MotionCache {
 public:
  const AffinePair& placement(const CompiledScene& scene, std::uint32_t placement, double time);
  const AffinePair& level(const CompiledScene& scene, std::uint32_t transform, double time);

 private:
  struct Entry { double time = 0; double frame = 0; bool valid = false; AffinePair map; };
  std::vector<Entry> placements_, levels_;
};

/// What one thread owns while tracing.
struct TraceScratch {
  MotionCache motion;
  TraceCounts counts;
  bool brute_force = false;   ///< loop over all leaves, ignore hierarchies
};

/// The nearest hit of one leaf with t beyond `lo` (open or closed as objects.md 2 says) and t <= hi. A function of
/// (leaf, ray, lo) alone, except that hits beyond `hi` are not reported. `order_base` is added to the order of leaves
/// in shared groups; hit.instances is extended by the instances passed.
bool exact_nearest(const CompiledScene& scene, LeafId leaf, const Ray& ray, double lo, double hi,
                   std::uint64_t order_base, TraceScratch& scratch, Hit& hit);

/// The best hit (t, then rank) among the leaves of a group whose opacity meets `mask`.
bool nearest_in_group(const CompiledScene& scene, std::uint32_t group, const Ray& ray, double lo, double hi,
                      Opacity mask, std::uint64_t order_base, TraceScratch& scratch, Hit& hit);

/// Whether anything of the group whose opacity is within `mask` (leaves that may also be something else are not
/// asked) lies between lo and hi.
bool occluded_in_group(const CompiledScene& scene, std::uint32_t group, const Ray& ray, double lo, double hi,
                       Opacity mask, TraceScratch& scratch);

/// True where a hit exactly at the far limit of a ray counts (objects.md 2): disc, triangle, polygon, CSG.
bool closed_at_far_limit(LeafKind kind);

}  // namespace rayshade
