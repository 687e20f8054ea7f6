// SPDX-License-Identifier: MIT
// Questions about a whole scene: places for messages, primitive counts, the light of a scene without one.
#include "rayshade/scene/scene.h"

#include <algorithm>
#include <unordered_map>

namespace rayshade {

std::string Scene::describe(const Location& where) const {
  std::string out = where.file < file_names.size() ? file_names[where.file] : std::string("-");
  if (out == "-" || out.empty()) out = "stdin";
  if (where.line == 0) return out;
  out += ':' + std::to_string(where.line);
  if (where.column != 0) out += ':' + std::to_string(where.column);
  return out;
}

std::uint64_t Scene::primitive_count(NodeId node) const {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 63;
  // Named objects may be used again and again and nest to any depth: counts are kept, and the walk has its
  // own stack.
  struct Visit {
    NodeId node;
    std::size_t next = 0;
    std::uint64_t sum = 0;
  };
  std::unordered_map<NodeId, std::uint64_t> counted;
  std::vector<Visit> visits;
  std::uint64_t result = 0;  // of the node visited last
  const auto enter = [&](NodeId id) {
    if (id >= nodes.size()) {
      result = 0;
      return false;
    }
    const Node& n = nodes[id];
    if (is_primitive(n.kind)) {
      result = 1;
      return false;
    }
    const auto known =
        n.kind == NodeKind::kInstance ? counted.find(named_objects[n.payload].node) : counted.end();
    if (known != counted.end()) {
      result = known->second;
      return false;
    }
    visits.push_back({id});
    return true;
  };
  enter(node);
  while (!visits.empty()) {
    Visit& top = visits.back();
    const Node& n = nodes[top.node];
    const bool instance = n.kind == NodeKind::kInstance;
    const std::size_t members = instance ? 1 : aggregates[n.payload].members.size();
    if (top.next > 0) top.sum = result >= kMost - top.sum ? kMost : top.sum + result;
    if (top.next < members) {
      const std::size_t i = top.next++;
      const NodeId member = instance ? named_objects[n.payload].node : aggregates[n.payload].members[i];
      result = 0;
      // Where the member is no leaf its count arrives in `result` before this visit goes on.
      enter(member);
      continue;
    }
    result = top.sum;
    if (instance) counted[named_objects[n.payload].node] = result;
    visits.pop_back();
  }
  return result;
}

Light default_light() {
  Light light;
  light.kind = LightKind::kDirectional;
  light.position = {1, -1, 1};
  return light;
}

}  // namespace rayshade
