// SPDX-License-Identifier: MIT
// What the compile step must know of a scene before it flattens it: which nodes are reachable from the world,
// how often each named object is used, how many primitives there are, and which aggregates are unbounded. One
// walk over the nodes, every node once, on a stack of its own: aggregates nest to any depth.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "rayshade/scene/scene.h"

namespace rayshade {

class SceneFacts {
 public:
  explicit SceneFacts(const Scene& scene);

  /// Primitives under a node (objects.md 6.6), saturating at 2^63.
  std::uint64_t primitives(NodeId node) const { return primitives_[node]; }
  std::uint64_t world_primitives() const { return world_primitives_; }
  /// Whether an aggregate tests this member with its unbounded ones (objects.md 6.2, 6.8): planes, and
  /// whatever contains a plane, except in what a difference takes away.
  bool unbounded(NodeId node) const { return unbounded_[node] != 0; }
  /// Instances of a named object that are reachable from the world, each counted once however often it is
  /// shared.
  std::uint32_t uses(std::uint32_t named_object) const { return uses_[named_object]; }
  /// Nodes that name this transform list, at most 255.
  std::uint8_t transform_uses(std::uint32_t transform) const { return transform_uses_[transform]; }
  /// Distinct primitives of a kind that are reachable.
  std::size_t reachable(NodeKind kind) const { return reachable_[static_cast<std::size_t>(kind)]; }
  std::uint64_t unused_objects() const;

 private:
  void visit(const Scene& scene, NodeId root);
  void finish(const Scene& scene, NodeId id);

  std::vector<std::uint64_t> primitives_;
  std::vector<std::uint8_t> unbounded_, seen_, transform_uses_;
  std::vector<std::uint32_t> uses_;
  std::array<std::size_t, kPrimitiveKinds> reachable_{};
  std::uint64_t world_primitives_ = 0;
};

}  // namespace rayshade
