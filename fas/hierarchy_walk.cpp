// SPDX-License-Identifier: MIT
#include <algorithm>
#include <bit>

#include "fas/compiled_targets.h"
#include "fas/hierarchy.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fas/hierarchy_walk.cpp"  // NOLINT: Highway includes this file once per target
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "fas/dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace fas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// A ray spread out over vectors.
struct Slabs {
  using D = hn::CappedTag<float, Hierarchy::kWidth>;
  using V = hn::Vec<D>;
  V near_x, near_y, near_z, far_x, far_y, far_z, inverse_x, inverse_y, inverse_z, limit;
  // Offsets within a node: of the near planes, and of the far ones, which are the other side's.
  std::size_t x, y, z, x1, y1, z1;

  HWY_ATTR HWY_INLINE Slabs(const BoxProbe& probe, float far) {
    constexpr std::size_t kAxis = Hierarchy::kWidth, kSide = 3 * kAxis;
    const D d;
    near_x = hn::Set(d, probe.near_origin[0]), far_x = hn::Set(d, probe.far_origin[0]);
    near_y = hn::Set(d, probe.near_origin[1]), far_y = hn::Set(d, probe.far_origin[1]);
    near_z = hn::Set(d, probe.near_origin[2]), far_z = hn::Set(d, probe.far_origin[2]);
    inverse_x = hn::Set(d, probe.inverse[0]);
    inverse_y = hn::Set(d, probe.inverse[1]);
    inverse_z = hn::Set(d, probe.inverse[2]);
    limit = hn::Set(d, far);
    x = probe.near_side[0] * kSide, x1 = kSide - x;
    y = probe.near_side[1] * kSide + kAxis, y1 = kSide + 2 * kAxis - y;
    z = probe.near_side[2] * kSide + 2 * kAxis, z1 = kSide + 4 * kAxis - z;
  }

  /// Which lanes are met, and where they begin.
  HWY_ATTR HWY_INLINE std::uint32_t test(const Hierarchy::Node& node, float* nears) const {
    const D d;
    const float* planes = node.planes[0][0];
    std::uint32_t met = 0;
    for (std::size_t i = 0; i < Hierarchy::kWidth; i += hn::Lanes(d)) {
      const V nx = hn::Mul(hn::Sub(hn::Load(d, planes + x + i), near_x), inverse_x);
      const V ny = hn::Mul(hn::Sub(hn::Load(d, planes + y + i), near_y), inverse_y);
      const V nz = hn::Mul(hn::Sub(hn::Load(d, planes + z + i), near_z), inverse_z);
      const V fx = hn::Mul(hn::Sub(hn::Load(d, planes + x1 + i), far_x), inverse_x);
      const V fy = hn::Mul(hn::Sub(hn::Load(d, planes + y1 + i), far_y), inverse_y);
      const V fz = hn::Mul(hn::Sub(hn::Load(d, planes + z1 + i), far_z), inverse_z);
      const V in = hn::Max(hn::Max(nx, ny), hn::Max(nz, hn::Zero(d)));
      const V out = hn::Min(hn::Min(fx, fy), hn::Min(fz, limit));
      hn::Store(in, d, nears + i);
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, hn::Le(in, hn::Mul(out, hn::Set(d, 1 + 0x1p-20f))), bits);
      met |= static_cast<std::uint32_t>(bits[0]) << i;
    }
    return met;
  }
};

/// Puts the lanes of `node` that are met on the stack above `base`, the nearest on top.
HWY_ATTR inline void push_met(const Hierarchy::Node& node, std::uint32_t met, const float* nears,
                              std::uint8_t mask, int base, Walk& walk) {
  int size = walk.size;
  for (; met != 0; met &= met - 1) {
    const int lane = std::countr_zero(met);
    if ((node.opacity[lane] & mask) == 0) continue;
    int at = size++;
    for (; at > base && walk.pending[at - 1].near < nears[lane]; --at)
      walk.pending[at] = walk.pending[at - 1];
    walk.pending[at] = {node.child[lane], nears[lane]};
  }
  walk.size = size;
}

HWY_ATTR void start(Cut cut, const BoxProbe& probe, float far, std::uint8_t mask, Walk& walk) {
  const Slabs slabs(probe, far);
  alignas(32) float nears[Hierarchy::kWidth];
  walk.size = 0;
  walk.box_tests += cut.count;
  for (std::uint32_t i = 0; i < cut.count; ++i)
    push_met(cut.nodes[i], slabs.test(cut.nodes[i], nears), nears, mask, 0, walk);
}

HWY_ATTR std::uint32_t next(const Hierarchy::Node* nodes, const BoxProbe& probe, float far, std::uint8_t mask,
                            Walk& walk) {
  const Slabs slabs(probe, far);
  alignas(32) float nears[Hierarchy::kWidth];
  while (walk.size > 0) {
    const Walk::Pending top = walk.pending[--walk.size];
    if (top.near > far) continue;
    std::uint32_t child = top.child;
    for (;;) {
      if ((child & Hierarchy::kLeafBit) != 0) return child;
      const Hierarchy::Node& node = nodes[child];
      ++walk.box_tests;
      const std::uint32_t met = slabs.test(node, nears);
      if (met == 0) break;
      if ((met & (met - 1)) == 0) {  // nothing to sort, nothing to keep
        const int lane = std::countr_zero(met);
        if ((node.opacity[lane] & mask) == 0) break;
        child = node.child[lane];
        continue;
      }
      const int base = walk.size;
      push_met(node, met, nears, mask, base, walk);
      if (walk.size == base) break;
      child = walk.pending[--walk.size].child;
    }
  }
  return Hierarchy::kEnd;
}

const char* walk_name() { return hwy::TargetName(HWY_TARGET); }

}  // namespace fas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fas {
namespace {

/// Which children are met, and where they begin.
std::uint32_t scalar_test(const Hierarchy::Node& node, const BoxProbe& probe, float far, float* nears) {
  std::uint32_t met = 0;
  for (int lane = 0; lane < Hierarchy::kWidth; ++lane) {
    float in = 0, out = far;
    for (int axis = 0; axis < 3; ++axis) {
      const int side = probe.near_side[axis];
      const float n = (node.planes[side][axis][lane] - probe.near_origin[axis]) * probe.inverse[axis];
      const float f = (node.planes[1 - side][axis][lane] - probe.far_origin[axis]) * probe.inverse[axis];
      in = n > in ? n : in;
      out = f < out ? f : out;
    }
    nears[lane] = in;
    if (in <= out * (1 + 0x1p-20f)) met |= 1u << lane;
  }
  return met;
}

/// Puts the lanes of `node` that are met on the stack; above `base` it is sorted.
void scalar_push(const Hierarchy::Node& node, const BoxProbe& probe, float far, std::uint8_t mask, int base,
                 Walk& walk) {
  float nears[Hierarchy::kWidth];
  const std::uint32_t met = scalar_test(node, probe, far, nears);
  ++walk.box_tests;
  for (int lane = 0; lane < Hierarchy::kWidth; ++lane) {
    if ((met >> lane & 1) != 0 && (node.opacity[lane] & mask) != 0)
      walk.pending[walk.size++] = {node.child[lane], nears[lane]};
  }
  std::stable_sort(walk.pending + base, walk.pending + walk.size,
                   [](const Walk::Pending& a, const Walk::Pending& b) { return a.near > b.near; });
}

void scalar_start(Cut cut, const BoxProbe& probe, float far, std::uint8_t mask, Walk& walk) {
  walk.size = 0;
  for (std::uint32_t i = 0; i < cut.count; ++i) scalar_push(cut.nodes[i], probe, far, mask, 0, walk);
}

std::uint32_t scalar_next(const Hierarchy::Node* nodes, const BoxProbe& probe, float far, std::uint8_t mask,
                          Walk& walk) {
  bool fresh = false;  // the nearest of a node just opened is not looked at twice
  while (walk.size > 0) {
    const Walk::Pending top = walk.pending[--walk.size];
    if (!fresh && top.near > far) continue;
    if ((top.child & Hierarchy::kLeafBit) != 0) return top.child;
    const int base = walk.size;
    scalar_push(nodes[top.child], probe, far, mask, base, walk);
    fresh = walk.size > base;
  }
  return Hierarchy::kEnd;
}

}  // namespace

WalkKernel dispatched_walk_kernel() {
  return {FAS_VERSIONS(next).best(), FAS_VERSIONS(start).best(), FAS_VERSIONS(walk_name).best()()};
}

const WalkKernel& walk_kernel() {
  static const WalkKernel chosen = dispatched_walk_kernel();
  return chosen;
}

const WalkKernel& scalar_walk_kernel() {
  static const WalkKernel scalar{scalar_next, scalar_start, "scalar"};
  return scalar;
}

}  // namespace fas
#endif
