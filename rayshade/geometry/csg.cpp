// SPDX-License-Identifier: MIT
// Constructive solid geometry as objects.md 7 says, by nearest hits of the operands: U1/U2, I1/I2 and the two
// branches of the difference. Works for lists as solids and for open operands as the original does, which
// sorted intervals of closed solids would not.
#include <algorithm>

#include "rayshade/geometry/trace_context.h"

namespace rayshade {
namespace {

/// A pair of operands that cross more often along one ray is taken as missed; every step of the loop
/// advances, so this only bounds the time.
constexpr int kMostSteps = 10'000;

class CsgQuery {
 public:
  CsgQuery(TraceContext& context, const Csg& csg, const Ray& ray, double hi)
      : context_(context), csg_(csg), ray_(ray), hi_(hi), outer_instances_(context.instances.count) {
    Vec3 direction = ray.direction;
    if (csg.placement != kNone) {
      const bool animated = context.scene.placements[csg.placement].animated();
      direction = context.placement_of(csg.placement, animated, ray.time).inverse.vector(direction);
    }
    tolerance_ = csg.tolerance / length(direction);
    rounding_ = 0x1p-48 * max_abs(ray.origin) / max_abs(ray.direction);
  }

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

  /// next(X, t): beyond t by the tolerance in the object's own space, and in any case by what rounding needs.
  bool search_beyond(int side, double t) {
    const double step = std::max(tolerance_, rounding_ + 0x1p-48 * std::fabs(t));
    return search(side, std::max(t + step, std::nextafter(t, kFar)));
  }

  /// The entering property of objects.md 7.2.
  bool enters(int side) {
    const Side& s = sides_[side];
    if (s.hit.flag != EnterFlag::kUnset) return s.hit.flag == EnterFlag::kEntering;
    const CompiledScene& scene = context_.scene;
    Ray local = ray_;
    const auto descend = [&](const Leaf& leaf) {
      if (leaf.placement == kNone) return;
      local = transformed(local, context_.placement_of(leaf.placement, leaf.animated, ray_.time).inverse);
    };
    for (std::uint32_t i = outer_instances_; i < s.hit.instances.count; ++i) {
      descend(scene.leaves[s.hit.instances.leaves[i]]);
    }
    const Leaf& leaf = scene.leaves[s.hit.leaf];
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
    for (int step = 0; step < kMostSteps; ++step) {
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
    for (int step = 0; step < kMostSteps; ++step) {
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
    for (int step = 0; step < kMostSteps; ++step) {
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
  const Ray& ray_;
  double hi_;
  std::uint32_t outer_instances_;
  double tolerance_, rounding_;
  Side sides_[2];
  bool result_enters_ = true;
};

}  // namespace

bool improve_by_csg(TraceContext& context, const Leaf& leaf, const Ray& ray, double lo, std::uint64_t base,
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
