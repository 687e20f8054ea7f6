// SPDX-License-Identifier: MIT
#include "fas/pack_walk.h"

#include <cmath>
#include <limits>

#include "fas/compiled_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fas/pack_walk.cpp"  // NOLINT: Highway includes this file once per target
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "fas/dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace fas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Mask = PackProbe::Mask;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Doubles, for the probes of rays.
using DD = hn::CappedTag<double, 8>;
using VD = hn::Vec<DD>;
using MD = hn::Mask<DD>;
using DF = hn::Rebind<float, DD>;

HWY_ATTR inline VD constant(double x) { return hn::Set(DD(), x); }
HWY_ATTR inline VD most(VD a, VD b) { return hn::IfThenElse(hn::Lt(a, b), b, a); }
HWY_ATTR inline VD least(VD a, VD b) { return hn::IfThenElse(hn::Lt(b, a), b, a); }
HWY_ATTR inline Mask bits_of(MD mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(DD(), mask, bits);
  return bits[0];
}

/// make_probe(), lane by lane the same operations.
HWY_ATTR void probes(const ClipBox& box, double condition, const PackRays& rays, PackProbe& probe, Mask& met,
                     Mask& unusable) {
  const DD d;
  const DF f;
  const std::size_t n = hn::Lanes(d), count = static_cast<std::size_t>(rays.count);
  const VD unit = constant(BoxProbe::kUnit), scaled = constant(BoxProbe::kUnit * condition);
  const double sign[3] = {probe.near_side[0] == 0 ? 1.0 : -1.0, probe.near_side[1] == 0 ? 1.0 : -1.0,
                          probe.near_side[2] == 0 ? 1.0 : -1.0};
  met = unusable = 0;
  for (std::size_t i = 0; i < count; i += n) {
    const VD exact = scaled * (hn::Load(d, rays.size + i) + constant(box.size));
    VD first = hn::Load(d, rays.lo + i), last = hn::Load(d, rays.hi + i);
    const VD hi = last;
    VD largest = constant(0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t near = probe.near_side[axis];
      const VD o = hn::Load(d, rays.origin[axis] + i), inverse = hn::Load(d, rays.inverse[axis] + i);
      const VD outward = constant(sign[axis]) * exact;
      first = most(first, (constant(box.planes[near][axis]) - outward - o) * inverse);
      last = least(last, (constant(box.planes[1 - near][axis]) + outward - o) * inverse);
      largest = most(largest, hn::Abs(hn::Load(d, rays.direction[axis] + i)));
    }
    const VD room = constant(8 * std::numeric_limits<double>::epsilon()) * hn::Abs(last);
    const MD meets = hn::Le(first, last + room);
    VD start[3], far = constant(0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      start[axis] = hn::Load(d, rays.origin[axis] + i) + first * hn::Load(d, rays.direction[axis] + i) -
                    constant(box.center[axis]);
      far = most(far, hn::Abs(start[axis]));
    }
    const VD slack =
        constant(0x1p-21) * (far + constant(box.extent)) + exact + unit * hn::Abs(first) * largest;
    const VD sum = start[0] + start[1] + start[2];  // NaN if one of them is: it would spoil the bounds
    const MD finite = hn::And(hn::Lt(far, constant(1e30)), hn::Eq(sum, sum));
    const MD usable = hn::And(hn::And(hn::Gt(largest, constant(1e-280)), hn::Lt(largest, constant(1e280))),
                              hn::And(hn::Lt(slack, constant(1e30)), finite));
    const VD float_slack = constant(2) * slack;
    hn::Store(first, d, probe.entry + i);
    hn::Store(largest, d, probe.scale + i);
    const auto slack32 = hn::DemoteTo(f, float_slack);
    hn::Store(slack32, f, probe.slack + i);
    const VD s = (hi - first) * largest;
    const auto s32 = hn::DemoteTo(f, hn::IfThenElse(hn::Lt(s, constant(1e30)), s, constant(1e30)));
    hn::Store(hn::Add(hn::Mul(s32, hn::Set(f, 1 + 0x1p-20f)), slack32), f, probe.limit + i);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const VD toward = constant(sign[axis]) * slack, inverse = hn::Load(d, rays.inverse[axis] + i);
      hn::Store(hn::DemoteTo(f, start[axis] + toward), f, probe.near_origin[axis] + i);
      hn::Store(hn::DemoteTo(f, start[axis] - toward), f, probe.far_origin[axis] + i);
      const MD large = hn::Ge(hn::Abs(hn::Load(d, rays.direction[axis] + i)),
                              constant(BoxProbe::kLeastComponent) * largest);
      const VD tiny = constant(sign[axis] / BoxProbe::kLeastComponent);
      hn::Store(hn::DemoteTo(f, hn::IfThenElse(large, inverse * largest, tiny)), f, probe.inverse[axis] + i);
    }
    met |= bits_of(meets) << i;
    unusable |= bits_of(hn::And(meets, hn::Not(usable))) << i;
  }
  const Mask all = count == PackProbe::kMost ? ~Mask{0} : (Mask{1} << count) - 1;
  met &= all;
  unusable &= all;
}

// Floats, for boxes.
using D = hn::CappedTag<float, 8>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

HWY_ATTR inline M lanes_of(Mask bits) {
  alignas(8) const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits)};
  return hn::LoadMaskBits(D(), bytes);
}
HWY_ATTR inline Mask bits_of(M mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(D(), mask, bits);
  return bits[0];
}

/// The lanes of a probe that hold no ray of the pack get numbers that meet nothing; then the bounds.
HWY_ATTR void find_bounds(PackProbe& probe, Mask rays) {
  const D d;
  const std::size_t n = hn::Lanes(d);
  const V infinity = hn::Set(d, kInfinity), minus_infinity = hn::Set(d, -kInfinity);
  V limit = hn::Set(d, -1);
  V near_low[3], near_high[3], far_low[3], far_high[3], inverse_low[3], inverse_high[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    near_low[axis] = far_low[axis] = inverse_low[axis] = infinity;
    near_high[axis] = far_high[axis] = inverse_high[axis] = minus_infinity;
  }
  for (std::size_t i = 0; i < PackProbe::kMost; i += n) {
    const M here = lanes_of(rays >> i & ((Mask{1} << n) - 1));
    const V own = hn::IfThenElse(here, hn::Load(d, probe.limit + i), hn::Set(d, -1));
    hn::Store(own, d, probe.limit + i);
    limit = hn::Max(limit, own);
    if (hn::AllFalse(d, here)) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const V near = hn::Load(d, probe.near_origin[axis] + i), far = hn::Load(d, probe.far_origin[axis] + i);
      const V inverse = hn::Load(d, probe.inverse[axis] + i);
      near_low[axis] = hn::Min(near_low[axis], hn::IfThenElse(here, near, infinity));
      near_high[axis] = hn::Max(near_high[axis], hn::IfThenElse(here, near, minus_infinity));
      far_low[axis] = hn::Min(far_low[axis], hn::IfThenElse(here, far, infinity));
      far_high[axis] = hn::Max(far_high[axis], hn::IfThenElse(here, far, minus_infinity));
      inverse_low[axis] = hn::Min(inverse_low[axis], hn::IfThenElse(here, inverse, infinity));
      inverse_high[axis] = hn::Max(inverse_high[axis], hn::IfThenElse(here, inverse, minus_infinity));
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool forward = probe.near_side[axis] == 0;
    probe.near_bound[axis] =
        hn::GetLane(forward ? hn::MaxOfLanes(d, near_high[axis]) : hn::MinOfLanes(d, near_low[axis]));
    probe.far_bound[axis] =
        hn::GetLane(forward ? hn::MinOfLanes(d, far_low[axis]) : hn::MaxOfLanes(d, far_high[axis]));
    probe.inverse_bound[axis][0] = hn::GetLane(hn::MinOfLanes(d, inverse_low[axis]));
    probe.inverse_bound[axis][1] = hn::GetLane(hn::MaxOfLanes(d, inverse_high[axis]));
  }
  probe.limit_bound = hn::GetLane(hn::MaxOfLanes(d, limit));
  probe.shortened = false;
}

HWY_ATTR inline void find_limit_bound(PackProbe& probe) {
  const D d;
  V limit = hn::Set(d, -1);
  for (std::size_t i = 0; i < PackProbe::kMost; i += hn::Lanes(d))
    limit = hn::Max(limit, hn::Load(d, probe.limit + i));
  probe.limit_bound = hn::GetLane(hn::MaxOfLanes(d, limit));
  probe.shortened = false;
}

/// Which rays of `rays` meet the box of a lane.
HWY_ATTR inline Mask meet(const Hierarchy::Node& node, std::size_t lane, const PackProbe& probe, Mask rays) {
  const D d;
  const std::size_t n = hn::Lanes(d);
  const Mask lanes = (Mask{1} << n) - 1;
  V near[3], far[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t side = probe.near_side[axis];
    near[axis] = hn::Set(d, node.planes[side][axis][lane]);
    far[axis] = hn::Set(d, node.planes[1 - side][axis][lane]);
  }
  Mask met = 0;
  for (std::size_t i = 0; i < PackProbe::kMost; i += n) {
    if ((rays >> i & lanes) == 0) continue;
    V in = hn::Zero(d), out = hn::Load(d, probe.limit + i);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const V inverse = hn::Load(d, probe.inverse[axis] + i);
      in = hn::Max(hn::Mul(hn::Sub(near[axis], hn::Load(d, probe.near_origin[axis] + i)), inverse), in);
      out = hn::Min(hn::Mul(hn::Sub(far[axis], hn::Load(d, probe.far_origin[axis] + i)), inverse), out);
    }
    met |= bits_of(hn::Le(in, hn::Mul(out, hn::Set(d, 1 + 0x1p-20f)))) << i;
  }
  return met & rays;
}

/// Which lanes of a node some ray within the bounds may meet, and where at the earliest.
HWY_ATTR inline std::uint32_t meet_any(const Hierarchy::Node& node, const PackProbe& probe, float* nears) {
  const D d;
  std::uint32_t met = 0;
  for (std::size_t i = 0; i < Hierarchy::kWidth; i += hn::Lanes(d)) {
    V in = hn::Zero(d), out = hn::Set(d, probe.limit_bound);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t side = probe.near_side[axis];
      const V a = hn::Set(d, probe.inverse_bound[axis][0]), b = hn::Set(d, probe.inverse_bound[axis][1]);
      const V near = hn::Sub(hn::Load(d, node.planes[side][axis] + i), hn::Set(d, probe.near_bound[axis]));
      const V far = hn::Sub(hn::Load(d, node.planes[1 - side][axis] + i), hn::Set(d, probe.far_bound[axis]));
      in = hn::Max(hn::Min(hn::Mul(near, a), hn::Mul(near, b)), in);
      out = hn::Min(hn::Max(hn::Mul(far, a), hn::Mul(far, b)), out);
    }
    hn::Store(in, d, nears + i);
    met |= static_cast<std::uint32_t>(bits_of(hn::Le(in, hn::Mul(out, hn::Set(d, 1 + 0x1p-20f))))) << i;
  }
  return met;
}

HWY_ATTR std::uint32_t next_run(const Hierarchy::Node* nodes, PackProbe& probe, std::uint8_t opacity,
                                Mask alive, PackWalk& walk, BitCounts& box_tests, Mask& rays) {
  alignas(32) float nears[Hierarchy::kWidth];
  if (probe.shortened) find_limit_bound(probe);
  while (walk.size > 0) {
    const PackWalk::Pending top = walk.pending[static_cast<std::size_t>(--walk.size)];
    if (top.near > probe.limit_bound) continue;
    Mask mask = top.mask & alive;
    if (mask != 0 && top.place != Hierarchy::kEnd)
      mask = meet(nodes[top.place / Hierarchy::kWidth], top.place % Hierarchy::kWidth, probe, mask);
    if (mask == 0) continue;
    if ((top.child & Hierarchy::kLeafBit) != 0 || std::popcount(mask) <= PackWalk::kFewRays) {
      rays = mask;
      return top.child;
    }
    box_tests.add(mask);
    const Hierarchy::Node& node = nodes[top.child];
    const int base = walk.size;
    for (std::uint32_t met = meet_any(node, probe, nears); met != 0; met &= met - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(met));
      if ((node.opacity[lane] & opacity) == 0) continue;
      int at = walk.size++;
      for (; at > base && walk.pending[static_cast<std::size_t>(at - 1)].near < nears[lane]; --at)
        walk.pending[static_cast<std::size_t>(at)] = walk.pending[static_cast<std::size_t>(at - 1)];
      walk.pending[static_cast<std::size_t>(at)] = {node.child[lane], top.child * Hierarchy::kWidth + lane,
                                                    nears[lane], mask};
    }
  }
  return Hierarchy::kEnd;
}

}  // namespace fas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fas {

namespace {
constexpr auto kProbes = FAS_VERSIONS(probes);
constexpr auto kFindBounds = FAS_VERSIONS(find_bounds);
constexpr auto kNextRun = FAS_VERSIONS(next_run);
}  // namespace

void make_probes(const ClipBox& box, double condition, const PackRays& rays, PackProbe& probe,
                 PackProbe::Mask& met, PackProbe::Mask& unusable) {
  met = unusable = 0;
  if (box.empty) return;
  for (std::size_t axis = 0; axis < 3; ++axis)
    probe.near_side[axis] = std::signbit(rays.direction[axis][0]) ? 1 : 0;
  kProbes.best()(box, condition, rays, probe, met, unusable);
  kFindBounds.best()(probe, met & ~unusable);
}

std::uint32_t pack_next(const Hierarchy::Node* nodes, PackProbe& probe, std::uint8_t opacity,
                        PackProbe::Mask alive, PackWalk& walk, BitCounts& box_tests, PackProbe::Mask& rays) {
  return kNextRun.best()(nodes, probe, opacity, alive, walk, box_tests, rays);
}

}  // namespace fas
#endif
