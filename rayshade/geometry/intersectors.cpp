// SPDX-License-Identifier: MIT
#include <algorithm>
#include <numeric>
#include <vector>

#include "rayshade/geometry/hierarchy_packs.h"
#include "rayshade/geometry/intersector.h"
#include "rayshade/geometry/intersector_report.h"
#include "rayshade/geometry/pack_tracer.h"
#include "rayshade/geometry/trace_context.h"

namespace rayshade {
namespace {

/// Worlds whose leaves cost no more than so many spheres are looped over by packs of rays: a vector test of
/// every leaf costs less than finding out which to test.
constexpr int kFewSpheres = 16;
/// More leaves than this are never looped over.
constexpr std::uint32_t kPackLeaves = 24;

/// What the test of a leaf costs, about, in tests of spheres; of kinds worth a box, that of the box.
int cost(LeafKind kind) {
  switch (kind) {
    case LeafKind::kPlane:
    case LeafKind::kSphere:
    case LeafKind::kDisc:
      return 1;
    case LeafKind::kCylinder:
    case LeafKind::kCone:
      return 3;
    default:
      return 2;
  }
}

bool worth_a_box(LeafKind kind) {
  switch (kind) {
    case LeafKind::kTorus:
    case LeafKind::kBlob:
    case LeafKind::kHeightField:
    case LeafKind::kCsg:
    case LeafKind::kInstance:
      return true;
    default:
      return false;
  }
}

/// More leaves than this without a vector test are better left to a hierarchy.
constexpr std::ptrdiff_t kSlowLeaves = 3;

/// So many bounded leaves are worth asking first whether a ray comes near any of them.
constexpr std::uint32_t kWorthAWorldBox = 6;

}  // namespace

bool traces_in_packs(const CompiledScene& scene) {
  const Group& world = scene.groups[0];
  const auto first = scene.leaves.begin() + world.first, last = first + world.count;
  const auto slow = [&](const Leaf& leaf) { return !tested_in_packs(scene, leaf); };
  if (world.count > kPackLeaves || std::count_if(first, last, slow) > kSlowLeaves) return false;
  const auto add = [](int sum, const Leaf& leaf) { return sum + cost(leaf.kind); };
  return !world.hierarchy || std::accumulate(first, last, 0, add) <= kFewSpheres;
}

namespace {

/// Answers from the groups of the compiled scene: by loops over every leaf, or by their hierarchies.
class GroupIntersector : public Intersector {
 public:
  GroupIntersector(const CompiledScene& scene, bool brute_force) : scene_(scene), brute_force_(brute_force) {
    scene_changed();
  }

  void scene_changed() override {
    const Group& world = scene_.groups[0];
    boxes_.clear();
    in_packs_ = !brute_force_ && traces_in_packs(scene_);
    if (!in_packs_) return;
    for (LeafId id = world.first; id < world.first + world.count; ++id) {
      boxes_.push_back(worth_a_box(scene_.leaves[id].kind)
                           ? scene_.leaf_bounds(id, scene_.shutter, scene_.frame)
                           : Bounds3::everything());
    }
  }

  void nearest(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
               TraceScratch& scratch) const override {
    const Mode mode(scratch, brute_force_);
    std::size_t i = 0;
    if (in_packs_) {
      PackTracer tracer(scene_, scratch);
      for (std::size_t n = 0; (n = run_of_one_mask(queries.subspan(i))) >= PackTracer::kFewest; i += n) {
        tracer.load(queries.subspan(i), answers.subspan(i), nullptr, static_cast<int>(n));
        nearest_in_pack(tracer);
      }
    } else if (!brute_force_ && scene_.groups[0].hierarchy) {
      HierarchyPacks(scene_, scratch).ask(queries, answers);
      return;
    }
    for (; i < queries.size(); ++i) ask_world(scene_, queries[i], answers[i], scratch);
  }

  void occluded(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers,
                TraceScratch& scratch) const override {
    const Mode mode(scratch, brute_force_);
    std::size_t i = 0;
    if (in_packs_) {
      PackTracer tracer(scene_, scratch);
      for (std::size_t n = 0; (n = run_of_one_mask(queries.subspan(i))) >= PackTracer::kFewest; i += n) {
        tracer.load(queries.subspan(i), nullptr, static_cast<int>(n));
        occluded_in_pack(tracer);
        tracer.answer_occluded(answers.subspan(i));
      }
    } else if (!brute_force_ && scene_.groups[0].hierarchy) {
      HierarchyPacks(scene_, scratch).ask(queries, answers);
      return;
    }
    for (; i < queries.size(); ++i) ask_world(scene_, queries[i], answers[i], scratch);
  }

  /// Rays of a span share packs, of one octant of directions each.
  std::size_t preferred_span() const override { return brute_force_ || in_packs_ ? RayPack::kMost : 512; }

  void report(const TraceScratch& /*scratch*/, IntersectorReport& into) const override {
    using Method = IntersectorReport::Method;
    into.method = brute_force_ ? Method::kBruteForce : in_packs_ ? Method::kPacks : Method::kHierarchy;
  }

 private:
  /// Sets the scratch's mode for the duration of one span.
  class Mode {
   public:
    Mode(TraceScratch& scratch, bool brute_force) : scratch_(scratch), before_(scratch.brute_force) {
      scratch.brute_force = brute_force;
    }
    ~Mode() { scratch_.brute_force = before_; }
    Mode(const Mode&) = delete;
    Mode& operator=(const Mode&) = delete;

   private:
    TraceScratch& scratch_;
    bool before_;
  };

  /// How many queries from the first on ask for the same opacity, up to a pack.
  template <class Query>
  static std::size_t run_of_one_mask(std::span<const Query> queries) {
    const std::size_t most = std::min<std::size_t>(queries.size(), RayPack::kMost);
    std::size_t n = 0;
    while (n < most && queries[n].mask == queries[0].mask) ++n;
    return n;
  }

  /// Those of `mask` that may meet bounded leaves.
  RayPack::Mask near_world(PackTracer& tracer, RayPack::Mask mask) const {
    const Group& world = scene_.groups[0];
    if (world.count - world.unbounded < kWorthAWorldBox) return mask;
    return tracer.near_box(world.bounds, world.condition, mask);
  }

  RayPack::Mask near_box(PackTracer& tracer, std::size_t place, RayPack::Mask mask) const {
    const Bounds3& box = boxes_[place];
    return box.unbounded() ? mask : tracer.near_box(box, scene_.groups[0].condition, mask);
  }

  void nearest_in_pack(PackTracer& tracer) const {
    const Group& world = scene_.groups[0];
    RayPack::Mask near = tracer.pack().all();
    for (std::uint32_t k = 0; k < world.count && near != 0; ++k) {
      if (k == world.unbounded) near = near_world(tracer, near);
      const RayPack::Mask mask = near_box(tracer, k, near);
      if (mask != 0) tracer.improve(world.first + k, mask);
    }
    tracer.answer_nearest();
  }

  void occluded_in_pack(PackTracer& tracer) const {
    const Group& world = scene_.groups[0];
    RayPack::Mask open = tracer.pack().all();
    for (std::uint32_t k = 0; k < world.count && open != 0; ++k) {
      if (k == world.unbounded) open = near_world(tracer, open);
      const RayPack::Mask mask = near_box(tracer, k, open);
      if (mask != 0) open &= ~tracer.occlude(world.first + k, mask);
    }
  }

  const CompiledScene& scene_;
  bool brute_force_;
  bool in_packs_ = false;
  std::vector<Bounds3> boxes_;  ///< where in_packs_, of leaves whose test costs more than that of a box
};

}  // namespace

std::unique_ptr<Intersector> make_brute_force(const CompiledScene& scene) {
  return std::make_unique<GroupIntersector>(scene, true);
}

std::unique_ptr<Intersector> make_hierarchy(const CompiledScene& scene) {
  return std::make_unique<GroupIntersector>(scene, false);
}

}  // namespace rayshade
