// SPDX-License-Identifier: MIT
// Objects as written: primitives, aggregates and instances, in an arena of small nodes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rayshade/scene/location.h"

namespace rayshade {

enum class NodeKind : std::uint8_t {
  kPlane,
  kSphere,
  kBox,
  kDisc,
  kCylinder,
  kCone,
  kTorus,
  kTriangle,
  kSmoothTriangle,
  kUvTriangle,
  kPolygon,
  kBlob,
  kHeightField,
  kList,
  kGrid,
  kUnion,
  kIntersect,
  kDifference,
  kInstance,
};
inline constexpr int kPrimitiveKinds = static_cast<int>(NodeKind::kHeightField) + 1;

constexpr bool is_primitive(NodeKind kind) { return kind <= NodeKind::kHeightField; }
constexpr bool is_csg(NodeKind kind) {
  return kind == NodeKind::kUnion || kind == NodeKind::kIntersect || kind == NodeKind::kDifference;
}
/// "closed" in the sense of objects.md 3: no advice when it is an operand of CSG.
constexpr bool is_closed(NodeKind kind) {
  return kind == NodeKind::kSphere || kind == NodeKind::kBox || kind == NodeKind::kTorus ||
         kind == NodeKind::kBlob || kind >= NodeKind::kList;
}

using NodeId = std::uint32_t;
inline constexpr std::uint32_t kNone = 0xffffffffu;

/// One object. `payload` indexes the pool of its kind: Scene::spheres ..., Scene::aggregates for aggregates
/// and CSG, Scene::named_objects for an instance. `surface` (already bound by the rules of language.md 5),
/// `transform` and `textures` index Scene::surfaces, transforms and texture_lists, or are kNone.
struct Node {
  NodeKind kind = NodeKind::kList;
  std::uint32_t payload = kNone;
  std::uint32_t surface = kNone;
  std::uint32_t transform = kNone;
  std::uint32_t textures = kNone;
  Location location;
};

/// Members of a list, grid or CSG object in the order written. CSG: two or more members, folded from the
/// left.
struct Aggregate {
  std::vector<NodeId> members;
  int grid[3] = {0, 0, 0};
};

/// A `name` statement; `object X` refers to the entry that was newest when it was read.
struct NamedObject {
  std::string name;
  NodeId node = kNone;
};

}  // namespace rayshade
