// SPDX-License-Identifier: MIT
// A bounding volume hierarchy, eight boxes to a node, in single precision. It only culls: what a ray hits is
// for the exact tests.
//
// Why nothing is lost. Boxes are stored relative to the centre of the whole and rounded outward. A ray is
// first clipped to the whole box in double precision and its origin moved to where it enters; what single
// precision then loses, and what the exact tests themselves may be off by (in proportion to the distance of
// the origin and to the condition that the caller names), is added to every box as a slack, by shifting the
// ray's origin toward the near and away from the far planes. Directions are scaled to a largest component of
// 1 and other components are kept from zero, so no operation can give NaN. The slab distances are relative to
// float rounding (T. Ize, "Robust BVH ray traversal", JCGT 2(2), 2013). Construction: binned surface area
// heuristic (I. Wald, "On fast construction of SAH-based bounding volume hierarchies", RT 2007), ranges split
// up to eight ways at once.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "fas/clip_box.h"

namespace fas {

/// The part of a ray inside the box of a structure, made ready for single precision.
struct BoxProbe {
  /// What exact tests may be off by, relative to the coordinates at hand and the condition.
  static constexpr double kUnit = 64 * std::numeric_limits<double>::epsilon();
  /// Components of a direction below this share of the largest are taken for it: over the extent of a
  /// structure the difference is far below the slack.
  static constexpr double kLeastComponent = 1e-18;

  float near_origin[3], far_origin[3], inverse[3];
  std::uint8_t near_side[3];  ///< 0: the low plane comes first
  bool usable = false;        ///< false: numbers out of range; test everything
  float slack = 0;
  double entry = 0;  ///< t where the ray enters the box
  double scale = 1;  ///< distance in the scaled space = (t - entry) * scale

  /// The far limit `t` in the scaled space, rounded up.
  float limit(double t) const { return limit(t, entry, scale, slack); }
  static float limit(double t, double entry, double scale, float slack) {
    const double s = (t - entry) * scale;
    return static_cast<float>(s < 1e30 ? s : 1e30) * (1 + 0x1p-20f) + slack;
  }
};

/// may_meet(), and fills `probe`.
bool make_probe(const ClipBox& box, double condition, const ClipRay& ray, double lo, double hi,
                BoxProbe& probe);

class Hierarchy {
 public:
  static constexpr int kWidth = 8;
  static constexpr std::uint32_t kLeafBit = 0x80000000u;
  static constexpr int kCountShift = 27;
  static constexpr std::uint32_t kEnd = 0xffffffffu;
  /// A traversal stack of this size never overflows: see kDeepest of the builder, and Cut.
  static constexpr int kStackSize = 416;

  struct alignas(64) Node {
    float planes[2][3][kWidth];    ///< low and high, axis, child; empty lanes: inside out
    std::uint32_t child[kWidth];   ///< node, or kLeafBit | (count - 1) << kCountShift | first primitive
    std::uint8_t opacity[kWidth];  ///< union of the masks below; 0: empty lane
  };

  /// Builds over `boxes`, none of them empty or unbounded, with a mask for each that is not zero, on up to
  /// `threads` threads; the result does not depend on how many. `order` receives which box belongs at place
  /// i: the caller keeps its primitives in that order. Fewer than 2^27 boxes.
  Hierarchy(std::vector<Bounds> boxes, std::span<const std::uint8_t> masks, int threads,
            std::vector<std::uint32_t>& order);

  const Bounds& bounds() const { return bounds_; }
  const ClipBox& clip_box() const { return clip_box_; }
  /// What planes are relative to.
  const Point& center() const { return center_; }
  std::span<const Node> nodes() const { return nodes_; }
  std::size_t bytes() const { return nodes_.capacity() * sizeof(Node) + sizeof(*this); }

  static std::uint32_t first(std::uint32_t child) { return child & ((1u << kCountShift) - 1); }
  static std::uint32_t count(std::uint32_t child) { return ((child >> kCountShift) & 15u) + 1; }

 private:
  std::vector<Node> nodes_;  ///< children come after their parents
  Bounds bounds_;
  ClipBox clip_box_;
  Point center_{};
};

/// Where a traversal starts: lanes of nodes of their own, in place of those of the root.
struct Cut {
  const Hierarchy::Node* nodes = nullptr;  ///< null: the whole hierarchy
  std::uint32_t count = 0;                 ///< nodes; at most four
  bool whole() const { return nodes == nullptr; }
};

/// The state of a traversal: what is still to be visited.
struct Walk {
  struct Pending {
    std::uint32_t child;
    float near;
  };
  int size = 1;
  std::uint32_t box_tests = 0;
  Pending pending[Hierarchy::kStackSize];  // NOLINT: only the first `size` are meaningful
  Walk() { pending[0] = {0, 0}; }          // NOLINT: must not clear the rest
};

/// The vector code of traversals, chosen once by the processor at hand; all targets and the scalar twin do
/// the same operations lane by lane and visit the same in the same order.
struct WalkKernel {
  /// Goes on to the next run of primitives that the ray may meet within `far` and whose mask has a bit in
  /// common with `mask`: an encoded child, or Hierarchy::kEnd.
  std::uint32_t (*next)(const Hierarchy::Node* nodes, const BoxProbe& probe, float far, std::uint8_t mask,
                        Walk& walk);
  /// Starts anew with the lanes of a cut that the ray may meet, nearest first.
  void (*start)(Cut cut, const BoxProbe& probe, float far, std::uint8_t mask, Walk& walk);
  const char* name;
};
const WalkKernel& walk_kernel();
/// Those for the target that calls go to at present (dispatch.h), so that tests can go through all of them.
WalkKernel dispatched_walk_kernel();
const WalkKernel& scalar_walk_kernel();

/// Visits runs of primitives that the ray may meet, roughly front to back. `limit` is asked again as it
/// shrinks: a function giving the far limit t of what is still of interest. `visit(first, count)` tests the
/// primitives at those places and returns true to end the traversal. Returns whether `visit` ended it.
template <class Limit, class Visit>
bool traverse(const Hierarchy& hierarchy, const Cut& cut, const BoxProbe& probe, std::uint8_t mask,
              std::uint32_t& box_tests, const Limit& limit, const Visit& visit) {
  const WalkKernel& kernel = walk_kernel();
  const Hierarchy::Node* nodes = hierarchy.nodes().data();
  Walk walk;
  if (!cut.whole()) kernel.start(cut, probe, probe.limit(limit()), mask, walk);
  bool ended = false;
  for (;;) {
    const float far = probe.limit(limit());
    std::uint32_t child = Hierarchy::kEnd;
    // Runs found together with the last one are waiting on top.
    if (walk.size > 0 && (walk.pending[walk.size - 1].child & Hierarchy::kLeafBit) != 0) {
      const Walk::Pending& top = walk.pending[--walk.size];
      if (top.near > far) continue;
      child = top.child;
    } else {
      child = kernel.next(nodes, probe, far, mask, walk);
      if (child == Hierarchy::kEnd) break;
    }
    if (visit(Hierarchy::first(child), Hierarchy::count(child))) {
      ended = true;
      break;
    }
  }
  box_tests += walk.box_tests;
  return ended;
}

}  // namespace fas
