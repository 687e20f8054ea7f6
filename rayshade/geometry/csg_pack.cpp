// SPDX-License-Identifier: MIT
#include "rayshade/geometry/csg_pack.h"

#include <algorithm>

#include "rayshade/geometry/csg_steps.h"
#include "rayshade/geometry/rank.h"

namespace rayshade {
namespace {

using Mask = RayPack::Mask;

/// Operands of more leaves than this are better looked through by their hierarchies, ray by ray.
constexpr std::uint32_t kMostLeaves = 16;

Mask bit(std::size_t ray) { return Mask{1} << ray; }
bool has(Mask mask, std::size_t ray) { return (mask >> ray & 1) != 0; }

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
      }
      all &= tested_in_packs(scene, leaf);
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
  for_each_ray(level.hit, [&](std::size_t i) {
    const RayPack& from = level.sides[has(level.second, i)].pack;
    const double t = from.t[i];
    if (!(t >= pack.lo[i])) return;
    if (!(t < pack.t[i] || (t == pack.t[i] && rank < pack.rank[i]))) return;
    pack.t[i] = t;
    pack.rank[i] = rank;
    pack.a[i] = from.a[i];
    pack.b[i] = from.b[i];
    pack.part[i] = from.part[i];
    pack.leaf[i] = from.leaf[i];
    pack.flag[i] = has(level.entering, i) ? EnterFlag::kEntering : EnterFlag::kLeaving;
    better |= bit(i);
  });
  counter_.add_tests(leaf, mask, better);
  return better;
}

Mask CsgPack::occlude(const Leaf& leaf, const RayPack& pack, Mask mask) {
  const CsgLevel& level = run(scene_.csgs[leaf.shape], pack, mask, 0);
  Mask stopped = 0;
  for_each_ray(level.hit, [&](std::size_t i) {
    const double t = level.sides[has(level.second, i)].pack.t[i];
    if (t >= pack.lo[i] && t <= pack.t[i]) stopped |= bit(i);  // closed at the far limit
  });
  counter_.add_tests(leaf, mask, stopped);
  return stopped;
}

/// The latest hits of one ray, for csg_steps::next_step().
struct CsgPack::State {
  const CsgPack& csg;
  const CsgLevel& level;
  std::size_t ray;
  bool found(std::size_t side) const { return has(level.sides[side].found, ray); }
  double t(std::size_t side) const { return level.sides[side].pack.t[ray]; }
  bool enters(std::size_t side) const { return csg.enters(level.sides[side].pack, ray); }
};

/// Finds the level's results for rays of `mask` between lo and t of `pack`.
const CsgLevel& CsgPack::run(const Csg& csg, const RayPack& pack, Mask mask, std::size_t depth) {
  using What = csg_steps::Next::What;
  CsgLevel& at = level(depth);
  const Group* const operands[2] = {&scene_.groups[csg.left], &scene_.groups[csg.right]};
  at.hit = at.second = at.entering = 0;
  for (CsgSide& side : at.sides) {
    std::copy_n(pack.lo, pack.count, side.pack.lo);
    side.found = 0;
  }
  search(at.sides[0], *operands[0], mask, depth);
  const Mask with_first = csg.operation == NodeKind::kUnion ? mask : at.sides[0].found;
  search(at.sides[1], *operands[1], with_first, depth);

  Mask active = at.sides[0].found | at.sides[1].found;
  for (int step = 0; active != 0 && step < csg_steps::kMost; ++step) {
    Mask searching[2] = {0, 0};
    for_each_ray(active, [&](std::size_t i) {
      const csg_steps::Next next = csg_steps::next_step(csg.operation, State{*this, at, i}, pack.t[i]);
      if (next.what == What::kSearch) {
        searching[next.second] |= bit(i);
        at.sides[next.second].pack.lo[i] = beyond(csg, i, at.sides[!next.second].pack.t[i]);
        return;
      }
      active &= ~bit(i);
      if (next.what == What::kMiss) return;
      at.hit |= bit(i);
      if (next.second) at.second |= bit(i);
      if (next.entering) at.entering |= bit(i);
    });
    for (std::size_t side = 0; side < 2; ++side)
      search(at.sides[side], *operands[side], searching[side], depth);
  }
  return at;
}

/// The nearest hit with an operand at lo or beyond, as improve_by_group() finds it.
void CsgPack::search(CsgSide& side, const Group& group, Mask mask, std::size_t depth) {
  if (mask == 0) return;
  RayPack& pack = side.pack;
  for_each_ray(mask, [&](std::size_t i) {
    pack.t[i] = kFar;
    pack.rank[i] = RayPack::kNoRank;
  });
  const LeafId bounded = group.first + group.unbounded;
  Mask found = test_leaves(group.first, bounded, pack, mask, depth);
  if (group.unbounded < group.count) {
    Mask met = mask;
    if (!group.few_simple) {
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
    const Mask better = improve_pack(scene_, id, pack, mask);
    counter_.add_tests(leaf, mask, better);
    found |= better;
  }
  return found;
}

bool CsgPack::enters(const RayPack& pack, std::size_t i) const {
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
