// SPDX-License-Identifier: MIT
// Queries as a pack of rays: loaded side by side, tested against leaf after leaf, answered. Leaves without a
// vector test are tested ray by ray. Either way the answer is that of the scalar tests.
#pragma once

#include <array>
#include <span>

#include "fas/pack_walk.h"
#include "rayshade/geometry/csg_pack.h"
#include "rayshade/geometry/intersector.h"
#include "rayshade/geometry/pack_counter.h"
#include "rayshade/geometry/ray_pack.h"
#include "rayshade/geometry/trace_context.h"

namespace rayshade {

/// Whether the world is small and simple enough to test every leaf with every ray, in packs.
bool traces_in_packs(const CompiledScene& scene);

class PackTracer {
 public:
  /// Fewer rays than this are not worth a pack.
  static constexpr int kFewest = 4;

  PackTracer(const CompiledScene& scene, TraceScratch& scratch)
      : context_(scene, scratch), counter_(context_), csg_(scene, scratch, counter_) {}

  /// Loads queries (at most RayPack::kMost) that all ask for leaves of the same opacity. `places`: their
  /// numbers in `queries`, or null for the first `count`.
  void load(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
            const std::uint32_t* places, int count);
  /// Tests a leaf of the world; returns the rays for which it is the best hit now.
  RayPack::Mask improve(LeafId leaf, RayPack::Mask mask);
  /// Writes the answers of the nearest queries loaded.
  void answer_nearest();

  void load(std::span<const OcclusionQuery> queries, const std::uint32_t* places, int count);
  /// Tests a leaf of the world; returns the rays whose answer is known now: those that are stopped, and that
  /// have met something outside the mask of the queries, where they have one.
  RayPack::Mask occlude(LeafId leaf, RayPack::Mask mask);
  /// Writes the answers of the occlusion queries loaded.
  void answer_occluded(std::span<OcclusionAnswer> answers);

  /// Those of `mask` that may meet a box before their far limit or best hit.
  RayPack::Mask near_box(const Bounds3& box, double condition, RayPack::Mask mask) {
    if (mask == 0) return 0;
    count_bounds(mask);
    return box.empty() ? 0 : clip_pack(box, condition, pack_, pack_, mask);
  }
  const RayPack& pack() const { return pack_; }
  Opacity opacity() const { return opacity_; }
  /// The rays, for boxes.
  fas::PackRays rays() {
    prepare_pack(pack_);
    return {{pack_.origin[0], pack_.origin[1], pack_.origin[2]},
            {pack_.direction[0], pack_.direction[1], pack_.direction[2]},
            {pack_.inverse[0], pack_.inverse[1], pack_.inverse[2]},
            pack_.size,
            pack_.lo,
            pack_.t,
            pack_.count};
  }
  /// Counts a test of a box or of a block of candidates for every ray of the mask.
  void count_bounds(RayPack::Mask mask) { counter_.add_bounds(mask); }
  /// For counting them from outside.
  PackCounter& counter() { return counter_; }

 private:
  static constexpr std::uint32_t kInAnswer = kNone;  ///< the whole hit stands in the answer

  template <class Query>
  void load_ray(const Query& query, int i);
  bool vectorised(const Leaf& leaf, RayPack::Mask mask) const {
    return leaf.kind != LeafKind::kCsg && (mask & (mask - 1)) != 0 && tested_in_packs(context_.scene, leaf) &&
           (all_unit_ || leaf.kind != LeafKind::kSphere);
  }
  bool csg_in_packs(const Leaf& leaf, RayPack::Mask mask) const {
    return leaf.kind == LeafKind::kCsg && tested_in_packs(context_.scene, leaf) && all_unit_ &&
           std::popcount(mask) >= kFewest;
  }
  /// Those of `mask` that meet the leaf between lo and hi, as far as it is within `opacity`.
  RayPack::Mask occluded_by(LeafId id, const Leaf& leaf, Opacity opacity, RayPack::Mask mask);

  TraceContext context_;
  PackCounter counter_;
  CsgPack csg_;
  RayPack pack_;
  RayPack::Mask found_ = 0;                 ///< nearest queries
  RayPack::Mask stopped_ = 0, others_ = 0;  ///< occlusion queries
  Opacity opacity_ = kAnyOpacity;
  bool all_unit_ = true;
  const NearestQuery* nearest_ = nullptr;
  NearestAnswer* answers_ = nullptr;
  const OcclusionQuery* occlusion_ = nullptr;
  std::array<std::uint32_t, RayPack::kMost> places_;
};

}  // namespace rayshade
