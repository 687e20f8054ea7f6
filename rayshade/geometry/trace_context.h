// SPDX-License-Identifier: MIT
// Inside the intersectors: one query on its way through groups, instances and CSG. `best` holds the far limit
// (its t) and, once something is found, the hit; everything narrows it by (t, rank). All of these answer
// "improved".
#pragma once

#include <limits>
#include <optional>

#include "fas/hierarchy.h"
#include "rayshade/geometry/intersector.h"
#include "rayshade/geometry/trace.h"

namespace rayshade {

struct TraceContext {
  const CompiledScene& scene;
  TraceScratch& scratch;
  std::uint32_t tests = 0;
  std::uint32_t bounds_tests = 0;
  InstancePath instances;  ///< entered so far, outermost first

  TraceContext(const CompiledScene& s, TraceScratch& c) : scene(s), scratch(c) {}
  TraceContext(const TraceContext&) = delete;
  TraceContext& operator=(const TraceContext&) = delete;
  ~TraceContext() { scratch.counts.bounds_tests += bounds_tests; }

  const AffinePair& placement_of(std::uint32_t placement, bool animated, double time) {
    return animated ? scratch.motion.placement(scene, placement, time) : scene.placements[placement].map;
  }
};

/// Nothing found yet; hits up to and including `hi` are of interest.
inline void start_search(Hit& best, double hi) {
  best.shape.t = hi;
  best.rank = std::numeric_limits<std::uint64_t>::max();
}

/// A ray in the space of a group, with what was worked out for it on the way: neighbours mostly share their
/// placement, operands of CSG the space.
class GroupRay {
 public:
  explicit GroupRay(const Ray& ray) : ray_(ray) {}
  GroupRay(const GroupRay&) = delete;
  GroupRay& operator=(const GroupRay&) = delete;

  const Ray& ray() const { return ray_; }
  /// In the space of a leaf of the group; valid until another leaf is asked for.
  const Ray& in(TraceContext& context, const Leaf& leaf) {
    if (leaf.placement == kNone) return ray_;
    if (leaf.placement != placement_) {
      placement_ = leaf.placement;
      local_ = transformed(ray_, context.placement_of(leaf.placement, leaf.animated, ray_.time).inverse);
    }
    return *local_;
  }
  /// For boxes of the group's space.
  const fas::ClipRay& clip() {
    if (!clip_) {
      const double o[3] = {ray_.origin.x, ray_.origin.y, ray_.origin.z};
      const double d[3] = {ray_.direction.x, ray_.direction.y, ray_.direction.z};
      clip_.emplace(o, d);
    }
    return *clip_;
  }

 private:
  const Ray& ray_;
  std::uint32_t placement_ = kNone;
  std::optional<Ray> local_;
  std::optional<fas::ClipRay> clip_;
};

bool improve_by_leaf(TraceContext& context, LeafId leaf, const Ray& ray, double lo, Opacity mask,
                     std::uint64_t base, Hit& best);
/// Whether a leaf that is within `mask` as a whole lies between lo and hi.
bool leaf_occludes(TraceContext& context, LeafId leaf, const Ray& ray, double lo, double hi, Opacity mask);
bool improve_by_group(TraceContext& context, std::uint32_t group, GroupRay& ray, double lo, Opacity mask,
                      std::uint64_t base, Hit& best);
/// In csg.cpp.
bool improve_by_csg(TraceContext& context, const Leaf& leaf, GroupRay& ray, double lo, std::uint64_t base,
                    Hit& best);
bool group_occludes(TraceContext& context, std::uint32_t group, GroupRay& ray, double lo, double hi,
                    Opacity mask);
/// One query, answered by the world's group alone. `cut`: of the world's hierarchy, if all that the ray could
/// meet is below it.
void ask_world(const CompiledScene& scene, const NearestQuery& query, NearestAnswer& answer,
               TraceScratch& scratch, const fas::Cut& cut = {});
void ask_world(const CompiledScene& scene, const OcclusionQuery& query, OcclusionAnswer& answer,
               TraceScratch& scratch, const fas::Cut& cut = {});
/// The enter test of objects.md 3 for a primitive.
bool primitive_enters(const CompiledScene& scene, const Leaf& leaf, const Ray& local, double lo,
                      const ShapeHit& hit);

}  // namespace rayshade
