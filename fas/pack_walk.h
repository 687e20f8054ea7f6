// SPDX-License-Identifier: MIT
// The traversal of a hierarchy by up to 64 rays of like direction at once: nodes are opened once for all of
// them.
//
// A box is first tested against the intervals in which the origins and reciprocals of all rays lie (eight
// boxes at a time), and, when its turn comes, against the rays one by one (eight rays at a time), each as far
// as it is still of interest by then. The test of a ray is that of its BoxProbe, operation by operation; that
// of the intervals leaves out no box that a ray's test would meet, since rounding is monotonic: with o the
// largest near origin, plane - o is the least difference, and its product with a reciprocal is at least the
// lesser of those with the least and the largest one. Below nodes that only few rays meet these go on alone.
// (S. Boulos, I. Wald, P. Shirley, "Geometric and arithmetic culling methods for entire ray packets", 2006;
// I. Wald, C. Benthin, S. Boulos, "Getting rid of packets", RT 2008.)
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "fas/bit_counts.h"
#include "fas/hierarchy.h"

namespace fas {

/// Rays side by side; arrays of PackProbe::kMost, aligned to 64 bytes. Directions have the same signs.
struct PackRays {
  const double* origin[3];
  const double* direction[3];
  const double* inverse[3];  ///< of the direction: infinity of their sign for components of 0
  const double* size;        ///< largest coordinate of the origin, without sign
  const double *lo, *hi;
  int count;
};

/// BoxProbes side by side.
struct PackProbe {
  static constexpr int kMost = 64;
  using Mask = std::uint64_t;  ///< bit i: ray i

  alignas(64) float near_origin[3][kMost];
  alignas(64) float far_origin[3][kMost];
  alignas(64) float inverse[3][kMost];
  alignas(64) float limit[kMost];  ///< far limits; negative: the ray meets nothing any more
  alignas(64) float slack[kMost];
  alignas(64) double entry[kMost];
  alignas(64) double scale[kMost];
  std::uint8_t near_side[3];
  // Of all rays:
  float near_bound[3], far_bound[3];  ///< of the origins: the one that meets a box first, and last
  float inverse_bound[3][2];
  float limit_bound;
  bool shortened;  ///< limits have changed since limit_bound was found

  /// Ray i is of interest up to `t` only.
  void shorten(std::size_t i, double t) {
    limit[i] = BoxProbe::limit(t, entry[i], scale[i], slack[i]);
    shortened = true;
  }
  /// Ray i is of interest no more.
  void drop(std::size_t i) {
    limit[i] = -1;
    shortened = true;
  }
  BoxProbe ray(std::size_t i) const {
    BoxProbe out;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      out.near_origin[axis] = near_origin[axis][i];
      out.far_origin[axis] = far_origin[axis][i];
      out.inverse[axis] = inverse[axis][i];
      out.near_side[axis] = near_side[axis];
    }
    out.usable = true;
    out.slack = slack[i];
    out.entry = entry[i];
    out.scale = scale[i];
    return out;
  }
};

/// make_probe() for every ray. `met`: those that may meet the box; `unusable`: those of them that must test
/// everything, since their numbers are out of range; the probe is of the others.
void make_probes(const ClipBox& box, double condition, const PackRays& rays, PackProbe& probe,
                 PackProbe::Mask& met, PackProbe::Mask& unusable);

/// The state of a traversal: what is still to be visited.
struct PackWalk {
  /// Nodes met by so few rays are left to these.
  static constexpr int kFewRays = 2;
  struct Pending {
    std::uint32_t child;
    std::uint32_t place;  ///< of its box: node and lane; Hierarchy::kEnd: the root has none
    float near;
    PackProbe::Mask mask;
  };
  int size = 1;
  std::array<Pending, Hierarchy::kStackSize> pending;  // NOLINT: only the first `size` are meaningful
  explicit PackWalk(PackProbe::Mask mask) { pending[0] = {0, Hierarchy::kEnd, 0, mask}; }  // NOLINT
};

/// Goes on to the next run of primitives that rays of `alive` may meet within their limits and whose mask has
/// a bit in common with `opacity`, or to a node that no more than kFewRays meet: an encoded child and the
/// rays, or Hierarchy::kEnd. Counts a box test for the rays of every node that it opens. All instruction sets
/// visit the same in the same order.
std::uint32_t pack_next(const Hierarchy::Node* nodes, PackProbe& probe, std::uint8_t opacity,
                        PackProbe::Mask alive, PackWalk& walk, BitCounts& box_tests, PackProbe::Mask& rays);

/// Visits runs of primitives that rays of `alive` may meet, roughly front to back. `visit(first, count,
/// rays)` tests the primitives at those places against these rays, shortens them in `probe`, and returns
/// those that need nothing more. `box_tests` counts nodes for every ray.
template <class Visit>
void traverse(const Hierarchy& hierarchy, PackProbe& probe, std::uint8_t opacity, PackProbe::Mask alive,
              BitCounts& box_tests, const Visit& visit) {
  const Hierarchy::Node* nodes = hierarchy.nodes().data();
  PackWalk walk(alive);
  const auto visit_run = [&](std::uint32_t child, PackProbe::Mask rays) {
    PackProbe::Mask done = visit(Hierarchy::first(child), Hierarchy::count(child), rays);
    alive &= ~done;
    for (; done != 0; done &= done - 1) probe.drop(static_cast<std::size_t>(std::countr_zero(done)));
  };
  while (alive != 0) {
    PackProbe::Mask rays = 0;
    const std::uint32_t child = pack_next(nodes, probe, opacity, alive, walk, box_tests, rays);
    if (child == Hierarchy::kEnd) return;
    if ((child & Hierarchy::kLeafBit) != 0) {
      visit_run(child, rays);
      continue;
    }
    for (; rays != 0; rays &= rays - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(rays));
      const PackProbe::Mask bit = PackProbe::Mask{1} << i;
      const BoxProbe one = probe.ray(i);
      Walk alone;
      alone.pending[0] = {child, 0};
      while ((alive & bit) != 0) {
        const std::uint32_t next = walk_kernel().next(nodes, one, probe.limit[i], opacity, alone);
        if (next == Hierarchy::kEnd) break;
        visit_run(next, bit);
      }
      for (std::uint32_t n = 0; n < alone.box_tests; ++n) box_tests.add(bit);
    }
  }
}

}  // namespace fas
