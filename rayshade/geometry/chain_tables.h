// SPDX-License-Identifier: MIT
// The chains of transforms and of path nodes that leaves share: equal chains get one number, so that a mesh
// of a million triangles under one transform and one surface has one placement and one path node.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "rayshade/geometry/compiled_scene.h"
#include "rayshade/geometry/scene_facts.h"

namespace rayshade {

class PlacementTable {
 public:
  PlacementTable(const Scene& scene, const SceneFacts& facts, CompiledScene& out);
  /// The placement of what stands under the transforms of `node` within `outer`. Throws CompileError where a
  /// constant transform cannot be inverted.
  std::uint32_t under(std::uint32_t outer, const Node& node);

 private:
  struct Link {
    std::uint32_t outer, transform;
  };
  /// The node's own list as a map; once per list.
  const AffinePair& level(const Node& node);

  const Scene& scene_;
  const SceneFacts& facts_;
  CompiledScene& out_;
  std::vector<Link> links_;  ///< parallel to the placements
  std::vector<std::uint8_t> level_known_;
  std::unordered_map<std::uint64_t, std::uint32_t> known_;  ///< of transform lists that several nodes name
};

class PathTable {
 public:
  PathTable(const Scene& scene, const SceneFacts& facts, CompiledScene& out);
  /// A node for `node` within `outer`.
  std::uint32_t under(std::uint32_t outer, const Node& node);

 private:
  struct Hash {
    std::size_t operator()(const PathNode& n) const;
  };
  struct Equal {
    bool operator()(const PathNode& a, const PathNode& b) const;
  };
  std::uint32_t add(const PathNode& node);

  const Scene& scene_;
  const SceneFacts& facts_;
  CompiledScene& out_;
  std::uint32_t latest_ = kNone;
  std::unordered_map<PathNode, std::uint32_t, Hash, Equal> known_;
};

}  // namespace rayshade
