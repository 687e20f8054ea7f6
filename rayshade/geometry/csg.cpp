// SPDX-License-Identifier: MIT
// Constructive solid geometry (objects.md 7) for one ray, by nearest hits of the operands.
#include "rayshade/geometry/csg_steps.h"
#include "rayshade/geometry/trace_context.h"

namespace rayshade {
namespace {

class CsgQuery {
 public:
  CsgQuery(TraceContext& context, const Csg& csg, GroupRay& ray, double hi)
      : context_(context), csg_(csg), ray_(ray), hi_(hi), outer_instances_(context.instances.count) {}

  /// The hit, or nothing where there is none before the far limit. Its t may lie beyond it.
  const Hit* run(double lo) {
    if (search(0, lo) || csg_.operation == NodeKind::kUnion) search(1, lo);
    for (int step = 0; step < csg_steps::kMost; ++step) {
      const csg_steps::Next next = csg_steps::next_step(csg_.operation, *this, hi_);
      switch (next.what) {
        case csg_steps::Next::What::kMiss:
          return nullptr;
        case csg_steps::Next::What::kHit:
          result_enters_ = next.entering;
          return &sides_[next.second].hit;
        case csg_steps::Next::What::kSearch:
          search_beyond(next.second, t(!next.second));
      }
    }
    return nullptr;
  }
  bool result_enters() const { return result_enters_; }

  // For csg_steps::next_step().
  bool found(std::size_t side) const { return sides_[side].found; }
  double t(std::size_t side) const { return sides_[side].hit.shape.t; }
  /// The entering property of objects.md 7.2.
  bool enters(std::size_t side) const {
    const Side& s = sides_[side];
    if (s.hit.flag != EnterFlag::kUnset) return s.hit.flag == EnterFlag::kEntering;
    const CompiledScene& scene = context_.scene;
    const Leaf& leaf = scene.leaves[s.hit.leaf];
    if (s.hit.instances.count == outer_instances_)
      return primitive_enters(scene, leaf, ray_.in(context_, leaf), s.lo, s.hit.shape);
    Ray local = ray_.ray();
    const auto descend = [&](const Leaf& to) {
      if (to.placement == kNone) return;
      local = transformed(local, context_.placement_of(to.placement, to.animated, local.time).inverse);
    };
    for (std::uint32_t i = outer_instances_; i < s.hit.instances.count; ++i)
      descend(scene.leaves[s.hit.instances.leaves[i]]);
    descend(leaf);
    return primitive_enters(scene, leaf, local, s.lo, s.hit.shape);
  }

 private:
  struct Side {
    Hit hit;
    double lo = 0;  ///< with which it was found
    bool found = false;
  };

  bool search(std::size_t side, double lo) {
    Side& s = sides_[side];
    s.lo = lo;
    start_search(s.hit, kFar);
    s.found = improve_by_group(context_, side == 0 ? csg_.left : csg_.right, ray_, lo, kAnyOpacity, 0, s.hit);
    return s.found;
  }

  /// Most rays are answered before anything needs them.
  void find_tolerances() {
    const Ray& ray = ray_.ray();
    const Affine* inverse = nullptr;
    if (csg_.placement != kNone) {
      const bool animated = context_.scene.placements[csg_.placement].animated();
      inverse = &context_.placement_of(csg_.placement, animated, ray.time).inverse;
    }
    tolerance_ = csg_steps::tolerance(csg_, ray, inverse);
    rounding_ = csg_steps::rounding(ray);
  }

  void search_beyond(std::size_t side, double t) {
    if (!(tolerance_ >= 0)) find_tolerances();
    search(side, csg_steps::beyond(t, tolerance_, rounding_));
  }

  TraceContext& context_;
  const Csg& csg_;
  GroupRay& ray_;
  double hi_;
  std::uint32_t outer_instances_;
  double tolerance_ = -1, rounding_ = 0;  ///< negative: not found yet
  Side sides_[2];
  bool result_enters_ = true;
};

}  // namespace

bool improve_by_csg(TraceContext& context, const Leaf& leaf, GroupRay& ray, double lo, std::uint64_t base,
                    Hit& best) {
  constexpr auto kKind = static_cast<std::size_t>(LeafKind::kCsg);
  ++context.scratch.counts.tests[kKind];
  CsgQuery query(context, context.scene.csgs[leaf.shape], ray, best.shape.t);
  const Hit* hit = query.run(lo);
  if (!hit || !(hit->shape.t >= lo)) return false;
  const std::uint64_t rank = rank_of(LeafKind::kCsg, base + leaf.order);
  if (!(hit->shape.t < best.shape.t || (hit->shape.t == best.shape.t && rank < best.rank))) return false;
  ++context.scratch.counts.hits[kKind];
  best = *hit;
  best.flag = query.result_enters() ? EnterFlag::kEntering : EnterFlag::kLeaving;
  best.rank = rank;
  return true;
}

}  // namespace rayshade
