// SPDX-License-Identifier: MIT
#include "rayshade/geometry/csg_pack.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rayshade/geometry/csg_steps.h"
#include "rayshade/geometry/rank.h"

namespace rayshade {
namespace {

using Mask = RayPack::Mask;

/// Operands of more leaves than this are better looked through by their hierarchies, ray by ray.
constexpr std::uint32_t kMostLeaves = 16;

Mask bit(std::size_t ray) { return Mask{1} << ray; }

/// Calls `f` with the number of every ray of the mask.
template <class F>
void for_each(Mask mask, const F& f) {
  for (; mask != 0; mask &= mask - 1) f(static_cast<std::size_t>(std::countr_zero(mask)));
}

Ray ray_of(const RayPack& pack, std::size_t i) {
  return {{pack.origin[0][i], pack.origin[1][i], pack.origin[2][i]},
          {pack.direction[0][i], pack.direction[1][i], pack.direction[2][i]}};
}

}  // namespace

void choose_csg_for_packs(CompiledScene& scene) {
  std::vector<std::uint8_t> vectors(scene.groups.size(), 0);
  for (const std::uint32_t index : scene.bottom_up) {
    const Group& group = scene.groups[index];
    bool all = group.count <= kMostLeaves;
    for (LeafId id = group.first; id < group.first + group.count; ++id) {
      const Leaf& leaf = scene.leaves[id];
      if (leaf.kind == LeafKind::kCsg) {
        Csg& csg = scene.csgs[leaf.shape];
        csg.in_packs = vectors[csg.left] && vectors[csg.right] &&
                       (csg.placement == kNone || !scene.placements[csg.placement].animated());
        all &= csg.in_packs;
      } else {
        all &= has_vector_test(leaf.kind) && !leaf.animated;
      }
    }
    vectors[index] = all;
  }
}

CsgLevel& CsgPack::level(std::size_t depth) {
  if (!scratch_.csg) scratch_.csg = std::make_shared<CsgRoom>();
  CsgRoom& room = *scratch_.csg;
  if (load_ == 0) load_ = ++room.loads;
  if (depth == room.levels.size()) room.levels.push_back(std::make_unique_for_overwrite<CsgLevel>());
  CsgLevel& level = *room.levels[depth];
  if (level.load == load_) return level;
  level.load = load_;
  for (CsgSide& side : level.sides) {
    side.pack.count = rays_->count;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::copy_n(rays_->origin[axis], rays_->count, side.pack.origin[axis]);
      std::copy_n(rays_->direction[axis], rays_->count, side.pack.direction[axis]);
    }
  }
  return level;
}

Mask CsgPack::improve(const Leaf& leaf, RayPack& pack, Mask mask, std::size_t depth) {
  const CsgLevel& level = run(scene_.csgs[leaf.shape], pack, mask, depth);
  const auto rank = static_cast<std::int64_t>(rank_of(leaf.kind, leaf.order));
  Mask better = 0;
  for_each(level.hit, [&](std::size_t i) {
    const RayPack& from = level.sides[level.second >> i & 1].pack;
    const double t = from.t[i];
    if (!(t >= pack.lo[i])) return;
    if (!(t < pack.t[i] || (t == pack.t[i] && rank < pack.rank[i]))) return;
    pack.t[i] = t;
    pack.rank[i] = rank;
    pack.a[i] = from.a[i];
    pack.b[i] = from.b[i];
    pack.part[i] = from.part[i];
    pack.leaf[i] = from.leaf[i];
    pack.flag[i] = (level.entering >> i & 1) != 0 ? EnterFlag::kEntering : EnterFlag::kLeaving;
    better |= bit(i);
  });
  counter_.add_tests(leaf, mask, better);
  return better;
}

Mask CsgPack::occlude(const Leaf& leaf, const RayPack& pack, Mask mask) {
  const CsgLevel& level = run(scene_.csgs[leaf.shape], pack, mask, 0);
  Mask stopped = 0;
  for_each(level.hit, [&](std::size_t i) {
    const double t = level.sides[level.second >> i & 1].pack.t[i];
    if (t >= pack.lo[i] && t <= pack.t[i]) stopped |= bit(i);  // closed at the far limit
  });
  counter_.add_tests(leaf, mask, stopped);
  return stopped;
}

/// Finds the level's results for rays of `mask` between lo and t of `pack`.
const CsgLevel& CsgPack::run(const Csg& csg, const RayPack& pack, Mask mask, std::size_t depth) {
  CsgLevel& at = level(depth);
  CsgSide &first = at.sides[0], &second = at.sides[1];
  const Group* const operands[2] = {&scene_.groups[csg.left], &scene_.groups[csg.right]};
  const NodeKind operation = csg.operation;
  at.hit = at.second = at.entering = 0;
  const auto answer = [&](std::size_t i, bool of_second, bool entering) {
    at.hit |= bit(i);
    if (of_second) at.second |= bit(i);
    if (entering) at.entering |= bit(i);
  };

  for (CsgSide& side : at.sides) {
    std::copy_n(pack.lo, pack.count, side.pack.lo);
    side.found = 0;
  }
  search(first, *operands[0], mask, depth);
  search(second, *operands[1], operation == NodeKind::kUnion ? mask : mask & first.found, depth);
  Mask active = mask & (operation == NodeKind::kUnion       ? first.found | second.found
                        : operation == NodeKind::kIntersect ? first.found & second.found
                                                            : first.found);

  for (int step = 0; active != 0 && step < csg_steps::kMost; ++step) {
    Mask searching[2] = {0, 0};
    const auto search_beyond = [&](std::size_t i, std::size_t side, double t) {
      searching[side] |= bit(i);
      at.sides[side].pack.lo[i] = beyond(csg, i, t);
    };
    for_each(active, [&](std::size_t i) {
      const bool has_first = (first.found >> i & 1) != 0, has_second = (second.found >> i & 1) != 0;
      const double t1 = first.pack.t[i], t2 = second.pack.t[i];
      if (operation == NodeKind::kDifference) {
        if (!has_second) {
          answer(i, false, enters(first, i));
        } else if (std::min(t1, t2) > pack.t[i]) {
          // None before the limit.
        } else if (t1 < t2) {
          if (!enters(second, i)) return search_beyond(i, 0, t2);
          answer(i, false, enters(first, i));
        } else {
          if (enters(first, i)) return search_beyond(i, 1, t1);
          answer(i, true, !enters(second, i));
        }
      } else {
        const std::size_t near = has_second && (!has_first || t2 < t1) ? 1 : 0;
        const CsgSide &here = at.sides[near], &other = at.sides[1 - near];
        if (here.pack.t[i] > pack.t[i]) {
          // None before the limit.
        } else if (operation == NodeKind::kUnion) {
          if ((other.found >> i & 1) != 0 && !enters(other, i))
            return search_beyond(i, near, other.pack.t[i]);
          answer(i, near == 1, enters(here, i));
        } else {
          if (enters(other, i)) return search_beyond(i, near, other.pack.t[i]);
          answer(i, near == 1, enters(here, i));
        }
      }
      active &= ~bit(i);
    });
    for (std::size_t side = 0; side < 2; ++side) {
      if (searching[side] == 0) continue;
      search(at.sides[side], *operands[side], searching[side], depth);
      const Mask none = searching[side] & ~at.sides[side].found;
      if (operation == NodeKind::kDifference && side == 1) continue;  // what is left stands alone
      active &= ~none;
      if (operation == NodeKind::kUnion) for_each(none, [&](std::size_t i) { answer(i, side == 0, false); });
    }
  }
  return at;
}

/// The nearest hit with an operand at lo or beyond, as improve_by_group() finds it.
void CsgPack::search(CsgSide& side, const Group& group, Mask mask, std::size_t depth) {
  RayPack& pack = side.pack;
  for_each(mask, [&](std::size_t i) {
    pack.t[i] = kFar;
    pack.rank[i] = std::numeric_limits<std::int64_t>::max();
  });
  const LeafId bounded = group.first + group.unbounded;
  Mask found = test_leaves(group.first, bounded, pack, mask, depth);
  if (group.unbounded < group.count) {
    Mask met = mask;
    if (!group.few_simple && mask != 0) {
      counter_.add_bounds(mask);
      met = group.bounds.empty() ? 0 : clip_pack(group.bounds, group.condition, *rays_, pack, mask);
    }
    found |= test_leaves(bounded, group.first + group.count, pack, met, depth);
  }
  side.found = (side.found & ~mask) | found;
}

Mask CsgPack::test_leaves(LeafId first, LeafId last, RayPack& pack, Mask mask, std::size_t depth) {
  Mask found = 0;
  if (mask == 0) return found;
  for (LeafId id = first; id < last; ++id) {
    const Leaf& leaf = scene_.leaves[id];
    if (leaf.kind == LeafKind::kCsg) {
      found |= improve(leaf, pack, mask, depth + 1);
      continue;
    }
    const auto rank = static_cast<std::int64_t>(rank_of(leaf.kind, leaf.order));
    const Mask better = improve_pack(scene_, leaf, rank, pack, mask);
    counter_.add_tests(leaf, mask, better);
    for_each(better, [&](std::size_t i) {
      pack.leaf[i] = id;
      pack.flag[i] = EnterFlag::kUnset;
    });
    found |= better;
  }
  return found;
}

bool CsgPack::enters(const CsgSide& side, std::size_t i) const {
  const RayPack& pack = side.pack;
  if (pack.flag[i] != EnterFlag::kUnset) return pack.flag[i] == EnterFlag::kEntering;
  const Leaf& leaf = scene_.leaves[pack.leaf[i]];
  Ray ray = ray_of(pack, i);
  if (leaf.placement != kNone) ray = transformed(ray, scene_.placements[leaf.placement].map.inverse);
  const ShapeHit hit{pack.t[i], pack.a[i], pack.b[i], static_cast<std::uint32_t>(pack.part[i])};
  return primitive_enters(scene_, leaf, ray, pack.lo[i], hit);
}

double CsgPack::beyond(const Csg& csg, std::size_t i, double t) const {
  const Ray ray = ray_of(*rays_, i);
  const Affine* inverse = csg.placement == kNone ? nullptr : &scene_.placements[csg.placement].map.inverse;
  return csg_steps::beyond(t, csg_steps::tolerance(csg, ray, inverse), csg_steps::rounding(ray));
}

}  // namespace rayshade
