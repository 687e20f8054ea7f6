// SPDX-License-Identifier: MIT
#include "rayshade/geometry/chain_tables.h"

namespace rayshade {

PlacementTable::PlacementTable(const Scene& scene, const SceneFacts& facts, CompiledScene& out)
    : scene_(scene), facts_(facts), out_(out), level_known_(scene.transforms.size()) {
  out.level_transforms.resize(scene.transforms.size());
}

const AffinePair& PlacementTable::level(const Node& node) {
  AffinePair& pair = out_.level_transforms[node.transform];
  if (level_known_[node.transform]) return pair;
  level_known_[node.transform] = 1;
  const TransformList& list = scene_.transforms[node.transform];
  if (list.animated()) return pair;
  pair.forward = list.at({});
  const auto inverted = inverse(pair.forward);
  if (!inverted || !is_finite(pair.forward.translation) || !is_finite(inverted->translation)) {
    throw CompileError("the transforms of this object have no inverse", node.location);
  }
  pair.inverse = *inverted;
  return pair;
}

std::uint32_t PlacementTable::under(std::uint32_t outer, const Node& node) {
  if (node.transform == kNone || scene_.transforms[node.transform].empty()) return outer;
  const bool may_recur = facts_.transform_uses(node.transform) > 1;
  const std::uint64_t key = std::uint64_t{outer} << 32 | node.transform;
  if (may_recur) {
    const auto found = known_.find(key);
    if (found != known_.end()) return found->second;
  }
  const AffinePair& own = level(node);
  Placement placement;
  const bool outer_animated = outer != kNone && out_.placements[outer].animated();
  if (scene_.transforms[node.transform].animated() || outer_animated) {
    out_.has_motion = true;
    placement.lists.push_back(&scene_.transforms[node.transform]);
    for (std::uint32_t link = outer; link != kNone; link = links_[link].outer) {
      placement.lists.push_back(&scene_.transforms[links_[link].transform]);
    }
  } else if (outer == kNone) {
    placement.map = own;
  } else {
    // The product of the inverses, not the inverse of the product: its accuracy does not hang on a
    // determinant.
    const AffinePair& rest = out_.placements[outer].map;
    placement.map = {then(own.forward, rest.forward), then(rest.inverse, own.inverse)};
    const Affine& f = placement.map.forward;
    const Affine& i = placement.map.inverse;
    for (const Affine* map : {&f, &i}) {
      if (!is_finite(map->rows[0]) || !is_finite(map->rows[1]) || !is_finite(map->rows[2]) ||
          !is_finite(map->translation)) {
        throw CompileError("the transforms around this object overflow", node.location);
      }
    }
  }
  const auto index = static_cast<std::uint32_t>(out_.placements.size());
  out_.placements.push_back(std::move(placement));
  links_.push_back({outer, node.transform});
  if (may_recur) known_.emplace(key, index);
  return index;
}

std::size_t PathTable::Hash::operator()(const PathNode& n) const {
  std::uint64_t h = 0;
  for (const std::uint32_t part : {n.parent, n.surface, n.textures, n.transform}) {
    h = (h ^ part) * 0x9E3779B97F4A7C15u;
    h ^= h >> 29;
  }
  return static_cast<std::size_t>(h);
}

bool PathTable::Equal::operator()(const PathNode& a, const PathNode& b) const {
  return a.parent == b.parent && a.surface == b.surface && a.textures == b.textures &&
         a.transform == b.transform;
}

PathTable::PathTable(const Scene& scene, const SceneFacts& facts, CompiledScene& out)
    : scene_(scene), facts_(facts), out_(out) {}

std::uint32_t PathTable::under(std::uint32_t outer, const Node& node) {
  PathNode wanted{outer, node.surface, node.textures, node.transform};
  if (wanted.textures != kNone && scene_.texture_lists[wanted.textures].empty()) wanted.textures = kNone;
  if (wanted.transform != kNone && scene_.transforms[wanted.transform].empty()) wanted.transform = kNone;
  if (latest_ != kNone && Equal{}(out_.path_nodes[latest_], wanted)) return latest_;
  const bool may_recur = wanted.transform == kNone || facts_.transform_uses(wanted.transform) > 1;
  if (!may_recur) return latest_ = add(wanted);
  const auto [entry, fresh] = known_.try_emplace(wanted, 0);
  if (fresh) entry->second = add(wanted);
  return latest_ = entry->second;
}

std::uint32_t PathTable::add(const PathNode& node) {
  const bool textured =
      node.textures != kNone || (node.parent != kNone && out_.path_textured[node.parent] != 0);
  if (textured) out_.has_textures = true;
  out_.path_nodes.push_back(node);
  out_.path_textured.push_back(textured);
  out_.path_surfaces.push_back(node.surface != kNone  ? node.surface
                               : node.parent != kNone ? out_.path_surfaces[node.parent]
                                                      : kNone);
  return static_cast<std::uint32_t>(out_.path_nodes.size() - 1);
}

}  // namespace rayshade
