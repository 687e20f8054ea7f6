// SPDX-License-Identifier: MIT
// A bounding volume hierarchy over the bounded leaves of one group: four boxes per node, in single precision,
// tested with one SSE instruction per operation. It only culls.
//
// Boxes are stored relative to the centre of the group and rounded outward. A ray is first clipped to the
// group's own box in double precision and its origin moved to where it enters; what single precision then
// loses, and what the exact tests themselves may be off by (in proportion to the distance of the origin and
// to the condition of the placements), is added to every box as a slack, by shifting the ray's origin toward
// the near and away from the far planes. Directions are scaled to a largest component of 1 and other
// components are kept from zero, so no operation can give NaN. The slab distances are relative to float
// rounding: compare T. Ize, "Robust BVH ray traversal", JCGT 2013. Sources of the construction: binned SAH,
// I. Wald 2007.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "rayshade/geometry/ray.h"
#include "rayshade/math/bounds.h"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace rayshade {

/// The part of a ray inside a group's box, made ready for single precision.
struct BoxProbe {
  alignas(16) float near_origin[3][4];  ///< each value four times
  alignas(16) float far_origin[3][4];
  alignas(16) float inverse[3][4];
  std::uint8_t near_side[3];  ///< 0: the low plane comes first
  bool usable = false;        ///< false: numbers out of range; test everything
  double entry = 0;           ///< t where the ray enters the box
  double scale = 1;           ///< distance in the scaled space = (t - entry) * scale
  float slack = 0;

  /// The far limit `t` in the scaled space, rounded up.
  float limit(double t) const {
    const double s = (t - entry) * scale;
    return static_cast<float>(s < 1e30 ? s : 1e30) * (1 + 0x1p-20f) + slack;
  }
};

/// Clips the ray to `box` within (lo, hi). False: it certainly misses, whatever the exact tests round.
/// `condition`: Group::condition.
bool clip_to_box(const Bounds3& box, double condition, const Ray& ray, double lo, double hi);
/// The same, and fills `probe`.
bool make_probe(const Bounds3& box, double condition, const Ray& ray, double lo, double hi, BoxProbe& probe);

class Hierarchy {
 public:
  static constexpr int kWidth = 4;
  static constexpr std::uint32_t kLeafBit = 0x80000000u;
  static constexpr int kCountShift = 27;
  static constexpr std::uint32_t kMostPerLeaf = 16;
  /// A traversal stack of this size never overflows.
  static constexpr int kStackSize = 384;

  struct alignas(64) Node {
    float planes[2][3][kWidth];    ///< low and high, axis, child
    std::uint32_t child[kWidth];   ///< node, or kLeafBit | (count - 1) << kCountShift | first leaf
    std::uint8_t opacity[kWidth];  ///< of all leaves below
  };

  /// Builds over `boxes`, none of them empty or unbounded. order()[i] tells which box belongs at place i.
  Hierarchy(std::vector<Bounds3> boxes, std::span<const std::uint8_t> opacities, const Bounds3& all);

  /// Only after construction: the permutation; released by take_order.
  std::vector<std::uint32_t> take_order() { return std::move(order_); }
  const Bounds3& bounds() const { return bounds_; }
  std::span<const Node> nodes() const { return nodes_; }
  std::size_t bytes() const { return nodes_.capacity() * sizeof(Node) + sizeof(*this); }

  static std::uint32_t first(std::uint32_t child) { return child & ((1u << kCountShift) - 1); }
  static std::uint32_t count(std::uint32_t child) { return ((child >> kCountShift) & 15u) + 1; }

 private:
  struct Builder;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
  Bounds3 bounds_;
};

/// Which children the ray may meet before `limit` (bits), and where. Twins: the same operations per lane.
inline unsigned boxes_met_scalar(const Hierarchy::Node& node, const BoxProbe& probe, float limit,
                                 float (&nears)[4]) {
  unsigned met = 0;
  for (int lane = 0; lane < 4; ++lane) {
    float near = 0, far = limit;
    for (int axis = 0; axis < 3; ++axis) {
      const int side = probe.near_side[axis];
      const float n =
          (node.planes[side][axis][lane] - probe.near_origin[axis][lane]) * probe.inverse[axis][lane];
      const float f =
          (node.planes[1 - side][axis][lane] - probe.far_origin[axis][lane]) * probe.inverse[axis][lane];
      near = n > near ? n : near;
      far = f < far ? f : far;
    }
    nears[lane] = near;
    if (near <= far * (1 + 0x1p-20f)) met |= 1u << lane;
  }
  return met;
}

#if defined(__SSE2__)
inline unsigned boxes_met(const Hierarchy::Node& node, const BoxProbe& probe, float limit,
                          float (&nears)[4]) {
  __m128 near = _mm_setzero_ps(), far = _mm_set1_ps(limit);
  for (int axis = 0; axis < 3; ++axis) {
    const int side = probe.near_side[axis];
    const __m128 inverse = _mm_load_ps(probe.inverse[axis]);
    const __m128 n = _mm_mul_ps(
        _mm_sub_ps(_mm_load_ps(node.planes[side][axis]), _mm_load_ps(probe.near_origin[axis])), inverse);
    const __m128 f = _mm_mul_ps(
        _mm_sub_ps(_mm_load_ps(node.planes[1 - side][axis]), _mm_load_ps(probe.far_origin[axis])), inverse);
    near = _mm_max_ps(n, near);
    far = _mm_min_ps(f, far);
  }
  _mm_storeu_ps(nears, near);
  return static_cast<unsigned>(
      _mm_movemask_ps(_mm_cmple_ps(near, _mm_mul_ps(far, _mm_set1_ps(1 + 0x1p-20f)))));
}
#else
inline unsigned boxes_met(const Hierarchy::Node& node, const BoxProbe& probe, float limit,
                          float (&nears)[4]) {
  return boxes_met_scalar(node, probe, limit, nears);
}
#endif

/// Visits runs of leaves that the ray may meet, roughly front to back. `limit` is asked again as it shrinks:
/// a function giving the far limit t of what is still of interest. `visit(first, count)` tests leaves `first`
/// ... within the hierarchy's own numbering and returns true to end the traversal. `mask`: opacities of
/// interest. Returns whether `visit` ended it.
template <class Limit, class Visit>
bool traverse(const Hierarchy& hierarchy, const BoxProbe& probe, std::uint8_t mask, std::uint32_t& box_tests,
              const Limit& limit, const Visit& visit) {
  struct Pending {
    std::uint32_t child;
    float near;
  };
  Pending stack[Hierarchy::kStackSize];
  int size = 0;
  const Hierarchy::Node* nodes = hierarchy.nodes().data();
  std::uint32_t child = 0;
  float far = probe.limit(limit());
  for (;;) {
    if (child & Hierarchy::kLeafBit) {
      if (visit(Hierarchy::first(child), Hierarchy::count(child))) return true;
      far = probe.limit(limit());
    } else {
      const Hierarchy::Node& node = nodes[child];
      float nears[4];
      ++box_tests;
      unsigned met = boxes_met(node, probe, far, nears);
      const int base = size;
      while (met != 0) {
        const int lane = __builtin_ctz(met);
        met &= met - 1;
        if ((node.opacity[lane] & mask) == 0) continue;
        // Insertion keeps the nearest on top.
        int at = size++;
        while (at > base && stack[at - 1].near < nears[lane]) {
          stack[at] = stack[at - 1];
          --at;
        }
        stack[at] = {node.child[lane], nears[lane]};
      }
    }
    do {
      if (size == 0) return false;
      --size;
    } while (stack[size].near > far);
    child = stack[size].child;
  }
}

}  // namespace rayshade
