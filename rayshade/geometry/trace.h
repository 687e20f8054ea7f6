// SPDX-License-Identifier: MIT
// The one pure function of all intersectors: exact(leaf, ray, interval), and the loops over groups that CSG
// operands and instances need. Everything a thread must remember between calls is in its own TraceScratch.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "fas/tree.h"
#include "rayshade/geometry/compiled_scene.h"
#include "rayshade/geometry/hit.h"
#include "rayshade/geometry/rank.h"

namespace rayshade {

/// Work done, by kind of leaf; added up over threads at the end.
struct TraceCounts {
  std::array<std::uint64_t, kLeafKinds> tests{};
  std::array<std::uint64_t, kLeafKinds> hits{};
  std::uint64_t bounds_tests =
      0;  ///< of groups and of nodes of hierarchies (one per node, whatever its width)
  void add(const TraceCounts& other);
  /// Tests of primitives; those of CSG objects, whose operands are counted themselves, are not among them.
  std::uint64_t total_tests() const;
};

/// The placement of an animated leaf, or the level transform of an animated list, at the time of the ray at
/// hand; recomputed only for a time that is not among the latest. One per thread and scene. Throws
/// MotionError where a transform is degenerate at that time. A reference is valid until the same entry is
/// asked for at another time.
class MotionCache {
 public:
  const AffinePair& placement(const CompiledScene& scene, std::uint32_t placement, double time);
  const AffinePair& level(const CompiledScene& scene, std::uint32_t transform, double time);

 private:
  struct Entry {
    double time = 0, frame = 0;
    bool valid = false;
    AffinePair map;
  };
  /// Rays of a batch have as many times as it has samples, so every transform has several entries, by a hash
  /// of time.
  static Entry& entry(std::vector<std::vector<Entry>>& table, std::size_t size, std::uint32_t index,
                      double time);
  std::vector<std::vector<Entry>> placements_, levels_;
};

/// For which sample of which pixel of the screen a ray is traced.
struct RayOwner {
  std::uint32_t x = 0, y = 0, sample = 0;
};

/// Told by whoever asks an intersector, for reports about single queries.
class QueryOwners {
 public:
  virtual ~QueryOwners() = default;
  /// `query`: its number in the span at hand.
  virtual RayOwner owner(std::size_t query) const = 0;
};

struct CsgRoom;

/// What one thread owns while tracing.
struct TraceScratch {
  MotionCache motion;
  TraceCounts counts;
  bool brute_force = false;                 ///< loop over all leaves, ignore hierarchies
  std::unique_ptr<fas::ThreadState> trees;  ///< what this thread remembers of the trees of an intersector
  std::shared_ptr<void> batch;              ///< room of an intersector to sort spans in
  std::shared_ptr<CsgRoom> csg;             ///< for CSG in packs (csg_pack.h)
  const QueryOwners* owners = nullptr;      ///< of the span at hand; null: unknown
};

/// The nearest hit of one leaf with t beyond `lo` (open or closed as objects.md 2 says) and t <= hi. A
/// function of (leaf, ray, lo) alone, except that hits beyond `hi` are not reported. Whether a hit exactly at
/// the far limit of its ray counts is for the caller to ask (before_far_limit in rank.h): `hi` may be just
/// the best hit so far. `order_base` is added to the order of leaves in shared groups. On entry hit.instances
/// names the instances that `ray` has passed (none for leaves of the world); a hit has them and those below.
/// Without a hit, `hit` is left alone.
bool exact_nearest(const CompiledScene& scene, LeafId leaf, const Ray& ray, double lo, double hi,
                   std::uint64_t order_base, TraceScratch& scratch, Hit& hit);

/// The best hit (t, then rank) among the leaves of a group whose opacity meets `mask`. `hi` is the far limit
/// of the ray. hit.instances on entry: as for exact_nearest.
bool nearest_in_group(const CompiledScene& scene, std::uint32_t group, const Ray& ray, double lo, double hi,
                      Opacity mask, std::uint64_t order_base, TraceScratch& scratch, Hit& hit);

/// Whether anything of the group whose opacity is within `mask` (leaves that may also be something else are
/// not asked) lies between lo and hi.
bool occluded_in_group(const CompiledScene& scene, std::uint32_t group, const Ray& ray, double lo, double hi,
                       Opacity mask, TraceScratch& scratch);

}  // namespace rayshade
