// SPDX-License-Identifier: MIT
// The nearest hit of a ray with a compiled scene.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "rayshade/geometry/ray.h"

namespace rayshade {

using LeafId = std::uint32_t;

/// The instances that a hit went through, outermost first: leaf numbers of kInstance leaves. Its capacity
/// bounds the nesting of *shared* structures only (objects used once are inlined whatever their depth); the
/// compile step refuses scenes that share deeper, which would hold more than 2^32 primitives.
struct InstancePath {
  static constexpr int kCapacity = 32;
  std::uint32_t count = 0;
  std::array<LeafId, kCapacity>
      leaves;  // NOLINT: deliberately uninitialised; only the first `count` are meaningful

  InstancePath() {}  // NOLINT(modernize-use-equals-default): must not zero the array
  InstancePath(const InstancePath& other) { *this = other; }
  InstancePath& operator=(const InstancePath& other) {
    count = other.count;
    std::copy_n(other.leaves.begin(), count, leaves.begin());
    return *this;
  }
};

/// What CSG says of a hit (objects.md 1.10); unset outside CSG.
enum class EnterFlag : std::uint8_t { kUnset, kEntering, kLeaving };

struct Hit {
  ShapeHit shape;   ///< shape.t is the world distance
  LeafId leaf = 0;  ///< the primitive's leaf, also inside CSG and instances
  EnterFlag flag = EnterFlag::kUnset;
  /// Decides between equal t: the smaller wins (objects.md 2 and 6.2, rule 2).
  std::uint64_t rank = std::numeric_limits<std::uint64_t>::max();
  InstancePath instances;

  double t() const { return shape.t; }
  /// Nearer, or equally near and of better rank.
  bool beats(const Hit& other) const {
    return shape.t < other.shape.t || (shape.t == other.shape.t && rank < other.rank);
  }
};

}  // namespace rayshade
