// SPDX-License-Identifier: MIT
// Which of several equally near hits wins (objects.md 2 and 6.2), as one number: the smaller rank.
//
// The original lowers the far limit of a ray with every hit. Kinds whose upper test is t <= hi (disc,
// triangle, polygon, CSG) therefore take an equal hit away from whatever was tested before, and the last of
// them keeps it; kinds with t < hi never take one, so among them the first tested keeps it. The same bit
// tells whether a hit exactly at the far limit of its ray counts.
#pragma once

#include <cstdint>

#include "rayshade/geometry/compiled_scene.h"
#include "rayshade/geometry/hit.h"

namespace rayshade {

/// Ranks below this belong to kinds that are closed at the far limit.
inline constexpr std::uint64_t kFirstStrictRank = std::uint64_t{1} << 62;
/// Orders must stay below this (the compile step sees to it).
inline constexpr std::uint64_t kOrderLimit = std::uint64_t{1} << 61;

/// True where a hit exactly at the far limit of a ray counts (objects.md 2): disc, triangle, polygon, CSG.
constexpr bool closed_at_far_limit(LeafKind kind) {
  switch (kind) {
    case LeafKind::kDisc:
    case LeafKind::kTriangle:
    case LeafKind::kSmoothTriangle:
    case LeafKind::kUvTriangle:
    case LeafKind::kPolygon:
    case LeafKind::kCsg:
      return true;
    default:
      return false;
  }
}

/// `order`: of the leaf that was tested (the outermost CSG object's, inside CSG), instances before it
/// included.
constexpr std::uint64_t rank_of(LeafKind kind, std::uint64_t order) {
  return closed_at_far_limit(kind) ? kFirstStrictRank - 1 - order : kFirstStrictRank + order;
}

/// Whether a hit lies before the far limit of its ray, in the sense of its kind.
constexpr bool before_far_limit(double t, std::uint64_t rank, double far_limit) {
  return t < far_limit || (t == far_limit && rank < kFirstStrictRank);
}
inline bool before_far_limit(const Hit& hit, double far_limit) {
  return before_far_limit(hit.shape.t, hit.rank, far_limit);
}

}  // namespace rayshade
