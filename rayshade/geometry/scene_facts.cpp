// SPDX-License-Identifier: MIT
#include "rayshade/geometry/scene_facts.h"

#include <algorithm>
#include <span>

namespace rayshade {
namespace {

constexpr std::uint64_t kMost = std::uint64_t{1} << 63;

/// What a node consists of: its members, or the named object of an instance.
std::span<const NodeId> parts(const Scene& scene, const Node& node) {
  if (is_primitive(node.kind)) return {};
  if (node.kind == NodeKind::kInstance) return {&scene.named_objects[node.payload].node, 1};
  return scene.aggregates[node.payload].members;
}

}  // namespace

SceneFacts::SceneFacts(const Scene& scene)
    : primitives_(scene.nodes.size()),
      unbounded_(scene.nodes.size()),
      seen_(scene.nodes.size()),
      transform_uses_(scene.transforms.size()),
      uses_(scene.named_objects.size()) {
  for (const NodeId id : scene.world) {
    visit(scene, id);
    world_primitives_ = std::min(kMost, world_primitives_ + primitives_[id]);
  }
}

std::uint64_t SceneFacts::unused_objects() const {
  return static_cast<std::uint64_t>(std::count(uses_.begin(), uses_.end(), 0u));
}

void SceneFacts::visit(const Scene& scene, NodeId root) {
  struct Visit {
    NodeId node;
    std::size_t next;
  };
  std::vector<Visit> stack;
  const auto enter = [&](NodeId id) {
    if (seen_[id]) return;
    seen_[id] = 1;
    const Node& node = scene.nodes[id];
    if (node.transform != kNone && transform_uses_[node.transform] < 255) ++transform_uses_[node.transform];
    if (node.kind == NodeKind::kInstance) ++uses_[node.payload];
    if (is_primitive(node.kind)) {
      ++reachable_[static_cast<std::size_t>(node.kind)];
      finish(scene, id);
    } else {
      stack.push_back({id, 0});
    }
  };
  enter(root);
  while (!stack.empty()) {
    Visit& top = stack.back();
    const std::span<const NodeId> members = parts(scene, scene.nodes[top.node]);
    if (top.next < members.size()) {
      enter(members[top.next++]);  // may move the stack: `top` is not used after this
    } else {
      const NodeId done = top.node;
      stack.pop_back();
      finish(scene, done);
    }
  }
}

/// All parts of the node are finished.
void SceneFacts::finish(const Scene& scene, NodeId id) {
  const Node& node = scene.nodes[id];
  if (is_primitive(node.kind)) {
    primitives_[id] = 1;
    unbounded_[id] = node.kind == NodeKind::kPlane;
    return;
  }
  const std::span<const NodeId> members = parts(scene, node);
  for (std::size_t i = 0; i < members.size(); ++i) {
    primitives_[id] = std::min(kMost, primitives_[id] + primitives_[members[i]]);
    if (unbounded_[members[i]] && (i == 0 || node.kind != NodeKind::kDifference)) unbounded_[id] = 1;
  }
}

}  // namespace rayshade
