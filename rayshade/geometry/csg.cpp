// SPDX-License-Identifier: MIT
// Constructive solid geometry as objects.md 7 says, by nearest hits of the operands: U1/U2, I1/I2 and the two
// branches of the difference. Works for lists as solids and for open operands as the original does, which
// sorted intervals of closed solids would not.
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
    switch (csg_.operation) {
      case NodeKind::kUnion:
        return run_union(lo);
      case NodeKind::kIntersect:
        return run_intersection(lo);
      default:
        return run_difference(lo);
    }
  }
  bool result_enters() const { return result_enters_; }

 private:
  struct Side {
    Hit hit;
    double lo = 0;  ///< with which it was found
    bool found = false;
    double t() const { return hit.shape.t; }
  };

  bool search(int side, double lo) {
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

  /// next(X, t).
  bool search_beyond(int side, double t) {
    if (!(tolerance_ >= 0)) find_tolerances();
    return search(side, csg_steps::beyond(t, tolerance_, rounding_));
  }

  /// The entering property of objects.md 7.2.
  bool enters(int side) {
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

  const Hit* result(int side, bool entering) {
    result_enters_ = entering;
    return &sides_[side].hit;
  }

  const Hit* run_union(double lo) {
    search(0, lo);
    search(1, lo);
    if (!sides_[0].found && !sides_[1].found) return nullptr;
    int near = sides_[0].found && !(sides_[1].found && sides_[1].t() < sides_[0].t()) ? 0 : 1;
    for (int step = 0; step < csg_steps::kMost; ++step) {
      const int far = 1 - near;
      if (sides_[near].t() > hi_) return nullptr;
      if (!sides_[far].found || enters(far)) return result(near, enters(near));
      if (!search_beyond(near, sides_[far].t())) return result(far, false);
      near = far;
    }
    return nullptr;
  }

  const Hit* run_intersection(double lo) {
    if (!search(0, lo) || !search(1, lo)) return nullptr;
    int near = sides_[1].t() < sides_[0].t() ? 1 : 0;
    for (int step = 0; step < csg_steps::kMost; ++step) {
      const int far = 1 - near;
      if (sides_[near].t() > hi_) return nullptr;
      if (!enters(far)) return result(near, enters(near));
      if (!search_beyond(near, sides_[far].t())) return nullptr;
      near = far;
    }
    return nullptr;
  }

  const Hit* run_difference(double lo) {
    if (!search(0, lo)) return nullptr;
    search(1, lo);
    for (int step = 0; step < csg_steps::kMost; ++step) {
      const Side &a = sides_[0], &b = sides_[1];
      if (!b.found) return result(0, enters(0));
      if (std::min(a.t(), b.t()) > hi_) return nullptr;
      if (a.t() < b.t()) {
        if (enters(1)) return result(0, enters(0));
        if (!search_beyond(0, b.t())) return nullptr;
      } else {
        if (!enters(0)) return result(1, !enters(1));
        search_beyond(1, a.t());
      }
    }
    return nullptr;
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
