// SPDX-License-Identifier: MIT
// Up to 64 rays side by side, and the exact tests of common shapes for many of them at once.
//
// A vector test is, lane by lane, the scalar test of the shape: the same operations on the same doubles in
// the same order, only + - * / and square root, comparisons and selections, never contracted; so it gives the
// same bits (rule 3), and tests compare the two. Which instruction set runs is chosen by the processor at
// hand.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#include "rayshade/geometry/compiled_scene.h"

namespace rayshade {

struct RayPack {
  static constexpr int kMost = 64;
  using Mask = std::uint64_t;  ///< bit i: ray i
  static constexpr std::int64_t kNoRank = std::numeric_limits<std::int64_t>::max();

  int count = 0;
  alignas(64) double origin[3][kMost];
  alignas(64) double direction[3][kMost];
  // For boxes; see prepare_pack():
  bool clip_ready = false;               ///< false: they are of other rays
  alignas(64) double inverse[3][kMost];  ///< of the direction
  alignas(64) double size[kMost];        ///< largest coordinate of the origin, without sign
  alignas(64) double lo[kMost];
  alignas(64) double t[kMost];           ///< far limit, or the best hit so far
  alignas(64) std::int64_t rank[kMost];  ///< of the best hit; a rank fits 63 bits
  alignas(64) double a[kMost], b[kMost];
  alignas(64) double part[kMost];  ///< ShapeHit::part
  std::uint32_t leaf[kMost];
  EnterFlag flag[kMost];

  Mask all() const { return count == kMost ? ~Mask{0} : (Mask{1} << count) - 1; }
};

/// Calls `f` with the number of every ray of a mask.
template <class F>
void for_each_ray(RayPack::Mask mask, const F& f) {
  for (; mask != 0; mask &= mask - 1) f(static_cast<std::size_t>(std::countr_zero(mask)));
}

/// Whether leaves of this kind have a vector test.
constexpr bool has_vector_test(LeafKind kind) {
  switch (kind) {
    case LeafKind::kPlane:
    case LeafKind::kSphere:
    case LeafKind::kBox:
    case LeafKind::kDisc:
    case LeafKind::kCylinder:
    case LeafKind::kCone:
    case LeafKind::kTriangle:
    case LeafKind::kSmoothTriangle:
    case LeafKind::kUvTriangle:
    case LeafKind::kPolygon:
      return true;
    default:
      return false;
  }
}

/// Whether a leaf is tested many rays at once: it has a vector test and stands still, or is CSG of such.
inline bool tested_in_packs(const CompiledScene& scene, const Leaf& leaf) {
  return leaf.kind == LeafKind::kCsg ? scene.csgs[leaf.shape].in_packs
                                     : has_vector_test(leaf.kind) && !leaf.animated;
}

/// Tests a leaf that has_vector_test and is not animated against the rays of `mask`, whose directions are of
/// unit length as far as the renderer knows (Ray::unit). Those for which it is the better hit by (t, rank)
/// get it; returns which.
RayPack::Mask improve_pack(const CompiledScene& scene, LeafId id, RayPack& pack, RayPack::Mask mask);
/// Which rays of `mask` the leaf stops between lo and t (before the far limit in the sense of its kind).
RayPack::Mask occlude_pack(const CompiledScene& scene, const Leaf& leaf, const RayPack& pack,
                           RayPack::Mask mask);
/// Finds what is needed for boxes, unless it is known.
void prepare_pack(RayPack& pack);
/// Which rays of `mask` may meet the box, which is not empty, within (lo, t) of `limits`, whatever the exact
/// tests round (fas::may_meet).
RayPack::Mask clip_pack(const Bounds3& box, double condition, RayPack& rays, const RayPack& limits,
                        RayPack::Mask mask);

}  // namespace rayshade
