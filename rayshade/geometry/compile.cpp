// SPDX-License-Identifier: MIT
// Flattening: the scene's nodes become groups of leaves. Members are visited in the order in which the
// original tests them, and numbered as they come (objects.md 6.2). Lists, grids and objects used once are
// walked with a stack of our own, so they may nest to any depth; CSG operands and shared groups recurse, and
// their nesting is limited, because tracing recurses likewise.
#include <algorithm>
#include <span>
#include <unordered_map>

#include "rayshade/geometry/chain_tables.h"
#include "rayshade/geometry/compiled_scene.h"
#include "rayshade/geometry/rank.h"
#include "rayshade/geometry/scene_facts.h"
#include "rayshade/geometry/shape_pools.h"

namespace rayshade {
namespace {

/// CSG objects and shared groups within each other: what a thread's stack can surely hold while tracing.
constexpr int kMostRecursion = 400;
/// CSG with more operands than this is combined as a balanced tree instead of from the left: the same solid,
/// and not as many levels as operands.
constexpr std::size_t kLongestFold = 64;
/// A named object is looked at this many levels deep for what really stands there.
constexpr int kWrappings = 8;
/// All copies of a scene have at most so many primitives: many objects may be used several times.
constexpr std::uint64_t kCopiesOfAll = 65'536;
/// CSG of so few primitives is one leaf without a hierarchy, whose box matters little.
constexpr std::uint64_t kFewOperands = 16;
/// Terms of a map this small beside others are from rounding: turns by 90 degrees have them.
constexpr double kNoTurn = 1e-12;

/// Whether boxes along the axes are so again after the map. Turned or sheared ones fit the better the larger
/// they are, so objects that are, stay instances.
bool keeps_boxes(const Affine& map) {
  for (const Vec3& row : map.rows) {
    const double most = kNoTurn * max_abs(row);
    if ((std::fabs(row.x) > most) + (std::fabs(row.y) > most) + (std::fabs(row.z) > most) > 1) return false;
  }
  return true;
}

static_assert(static_cast<int>(LeafKind::kHeightField) == static_cast<int>(NodeKind::kHeightField));

}  // namespace

class Compiler {
 public:
  Compiler(const Scene& scene, Provider& provider, const CompileOptions& options, CompiledScene& out)
      : scene_(scene),
        out_(out),
        facts_(scene),
        pools_(scene, facts_, provider, options.flip_normals, out),
        placements_(scene, facts_, out),
        paths_(scene, facts_, out),
        unused_files_(options.unused_files),
        most_copies_(options.most_copies),
        small_(scene.named_objects.size(), Small::kUnknown) {}

  void run();

 private:
  /// What the nodes around a node have decided so far.
  enum class Inherited : std::uint8_t { kNothing, kOpaqueSurface, kTransparentSurface };
  enum class Small : std::uint8_t { kUnknown, kNo, kYes };
  struct Context {
    std::uint32_t path = kNone, placement = kNone;
    Inherited surface = Inherited::kNothing;
  };
  /// A group in the making.
  struct Build {
    std::vector<Leaf> leaves;
    std::uint64_t order = 0;
    bool transparent_outside = false;  ///< the surface of leaves that have none within the group
    bool depends_on_outside = false;   ///< there are such leaves
    bool solid = false;                ///< of the latest leaf
    int instances = 0, recursion = 0;  ///< levels below
  };
  struct GroupFacts {
    std::uint8_t opacity = 0;
    bool depends_on_outside = false;
    int instances = 0, recursion = 0;
  };
  /// Members of one aggregate in the order of tests: the unbounded ones as written, then the others
  /// backwards.
  struct Frame {
    std::span<const NodeId> members;
    Context context;
    std::size_t next = 0;
    bool unbounded = true;
  };

  void flatten(Build& build, std::span<const NodeId> members, const Context& context, int depth);
  bool next_member(Frame& frame, NodeId& member) const;
  Context enter(const Node& node, const Context& outer);
  void add_leaf(Build& build, Leaf leaf, std::uint64_t orders, const Location& where);
  void add_primitive(Build& build, const Node& node, const Context& outer);
  void add_csg(Build& build, const Node& node, const Context& inner, int depth);
  void add_instance(Build& build, const Node& node, const Context& inner, int depth);
  std::uint32_t combine(NodeKind operation, std::span<const std::uint32_t> operands, const Node& node,
                        const Context& inner);
  Leaf csg_leaf(NodeKind operation, std::uint32_t left, std::uint32_t right, const Context& inner);
  std::uint32_t shared_group(std::uint32_t object, bool transparent_outside, const Location& where,
                             int depth);
  bool copied(std::uint32_t object, const Context& inner);
  bool small(std::uint32_t object);
  const Node& innermost(NodeId id) const;
  std::uint32_t finish_group(Build&& build);
  void store_group(std::uint32_t index, Build&& build);
  bool solid_primitive(const Node& node) const;
  void check_recursion(int depth, const Location& where) const {
    if (depth > kMostRecursion) throw CompileError("objects are nested too deeply", where);
  }

  const Scene& scene_;
  CompiledScene& out_;
  SceneFacts facts_;
  ShapePools pools_;
  PlacementTable placements_;
  PathTable paths_;
  bool unused_files_;
  std::uint64_t most_copies_, copies_left_ = kCopiesOfAll;
  std::vector<Small> small_;  ///< named objects that are to be copied
  std::vector<GroupFacts> group_facts_;
  std::unordered_map<std::uint64_t, std::uint32_t>
      shared_;  ///< 2 * named object + transparent_outside: group
};

void Compiler::run() {
  out_.groups.emplace_back();
  group_facts_.emplace_back();
  Build world;
  world.leaves.reserve(
      static_cast<std::size_t>(std::min<std::uint64_t>(facts_.world_primitives(), scene_.nodes.size())));
  flatten(world, scene_.world, {}, 0);
  store_group(0, std::move(world));
  if (unused_files_) pools_.check_files();
  out_.counts.primitives = facts_.world_primitives();
  out_.counts.leaves = out_.leaves.size();
  out_.counts.unused_objects = facts_.unused_objects();
}

bool Compiler::next_member(Frame& frame, NodeId& member) const {
  const std::size_t count = frame.members.size();
  if (frame.unbounded) {
    while (frame.next < count) {
      member = frame.members[frame.next++];
      if (facts_.unbounded(member)) return true;
    }
    frame.unbounded = false;
    frame.next = 0;
  }
  while (frame.next < count) {
    member = frame.members[count - ++frame.next];
    if (!facts_.unbounded(member)) return true;
  }
  return false;
}

void Compiler::flatten(Build& build, std::span<const NodeId> members, const Context& context, int depth) {
  std::vector<Frame> frames{{members, context}};
  NodeId id = 0;
  while (!frames.empty()) {
    if (!next_member(frames.back(), id)) {
      frames.pop_back();
      continue;
    }
    const Node& node = scene_.nodes[id];
    if (is_primitive(node.kind)) {
      add_primitive(build, node, frames.back().context);
      continue;
    }
    if (facts_.primitives(id) == 0) continue;
    const Context inner = enter(node, frames.back().context);
    if (node.kind == NodeKind::kInstance) {
      const NodeId& body = scene_.named_objects[node.payload].node;
      if (copied(node.payload, inner)) {
        frames.push_back({{&body, 1}, inner});
      } else {
        add_instance(build, node, inner, depth);
      }
      continue;
    }
    const std::vector<NodeId>& inside = scene_.aggregates[node.payload].members;
    if (is_csg(node.kind) && inside.size() > 1) {
      add_csg(build, node, inner, depth);
    } else {
      frames.push_back({inside, inner});
    }
  }
}

/// Where the members of a node stand. Nodes that say nothing leave no trace.
Compiler::Context Compiler::enter(const Node& node, const Context& outer) {
  Context inner = outer;
  inner.placement = placements_.under(outer.placement, node);
  if (node.surface != kNone || node.textures != kNone || node.transform != kNone) {
    inner.path = paths_.under(outer.path, node);
  }
  if (node.surface != kNone) {
    inner.surface = scene_.surfaces[node.surface].transparency < kEpsilon ? Inherited::kOpaqueSurface
                                                                          : Inherited::kTransparentSurface;
  }
  return inner;
}

void Compiler::add_leaf(Build& build, Leaf leaf, std::uint64_t orders, const Location& where) {
  if (orders >= kOrderLimit || build.order >= kOrderLimit - orders) {
    throw CompileError("too many objects by repeated use of named objects", where);
  }
  leaf.order = build.order;
  build.order += orders;
  if (leaf.opacity & kTransparent) out_.has_transparent = true;
  build.leaves.push_back(leaf);
}

void Compiler::add_primitive(Build& build, const Node& node, const Context& outer) {
  Context inner = enter(node, outer);
  if (inner.path == outer.path) inner.path = paths_.under(outer.path, node);
  bool transparent = inner.surface == Inherited::kTransparentSurface;
  if (inner.surface == Inherited::kNothing) {
    build.depends_on_outside = true;
    transparent = build.transparent_outside;
  }
  Leaf leaf;
  leaf.kind = static_cast<LeafKind>(node.kind);
  leaf.opacity = transparent ? kTransparent : kOpaque;
  leaf.animated = inner.placement != kNone && out_.placements[inner.placement].animated();
  leaf.shape = pools_.index_of(node);
  leaf.placement = inner.placement;
  leaf.path = inner.path;
  build.solid = solid_primitive(node);
  add_leaf(build, leaf, 1, node.location);
}

/// Closed and oriented: a ray that leaves it has been inside.
bool Compiler::solid_primitive(const Node& node) const {
  switch (node.kind) {
    case NodeKind::kSphere:
    case NodeKind::kBox:
    case NodeKind::kBlob:
      return true;
    case NodeKind::kTorus:
      return scene_.tori[node.payload].tube <= scene_.tori[node.payload].swept;
    default:
      return false;
  }
}

void Compiler::add_csg(Build& build, const Node& node, const Context& inner, int depth) {
  check_recursion(depth, node.location);
  out_.has_csg = true;
  std::vector<std::uint32_t> operands;
  for (const NodeId& member : scene_.aggregates[node.payload].members) {
    Build operand;
    operand.transparent_outside = build.transparent_outside;
    flatten(operand, {&member, 1}, inner, depth + 1);
    build.depends_on_outside |= operand.depends_on_outside;
    operands.push_back(finish_group(std::move(operand)));
  }
  // The whole is one leaf; what it is folded from are groups of one leaf each.
  const std::uint32_t whole = combine(node.kind, operands, node, inner);
  // `combine` made a group of its own for the last step, too: its only leaf becomes ours.
  const Leaf leaf = out_.leaves[out_.groups[whole].first];
  build.solid = out_.groups[whole].solid;
  build.instances = std::max(build.instances, group_facts_[whole].instances);
  build.recursion = std::max(build.recursion, group_facts_[whole].recursion);
  out_.leaves.pop_back();
  out_.groups.pop_back();
  out_.bottom_up.pop_back();
  group_facts_.pop_back();
  add_leaf(build, leaf, 1, node.location);
}

/// Folds the operands; a group with one CSG leaf, the newest of all.
std::uint32_t Compiler::combine(NodeKind operation, std::span<const std::uint32_t> operands, const Node& node,
                                const Context& inner) {
  const auto pair = [&](NodeKind op, std::uint32_t left, std::uint32_t right) {
    Build build;
    add_leaf(build, csg_leaf(op, left, right, inner), 1, node.location);
    const GroupFacts &a = group_facts_[left], &b = group_facts_[right];
    build.solid = out_.groups[left].solid && out_.groups[right].solid;
    build.instances = std::max(a.instances, b.instances);
    build.recursion = 1 + std::max(a.recursion, b.recursion);
    check_recursion(build.recursion, node.location);
    return finish_group(std::move(build));
  };
  if (operands.size() == 1) return operands[0];
  if (operands.size() > kLongestFold) {
    if (operation == NodeKind::kDifference) {
      const std::uint32_t rest = combine(NodeKind::kUnion, operands.subspan(1), node, inner);
      return pair(operation, operands[0], rest);
    }
    const std::size_t half = operands.size() / 2;
    const std::uint32_t left = combine(operation, operands.first(half), node, inner);
    const std::uint32_t right = combine(operation, operands.subspan(half), node, inner);
    return pair(operation, left, right);
  }
  std::uint32_t folded = operands[0];
  for (const std::uint32_t operand : operands.subspan(1)) folded = pair(operation, folded, operand);
  return folded;
}

Leaf Compiler::csg_leaf(NodeKind operation, std::uint32_t left, std::uint32_t right, const Context& inner) {
  Csg csg;
  csg.operation = operation;
  csg.left = left;
  csg.right = right;
  csg.placement = inner.placement;
  Leaf leaf;
  leaf.kind = LeafKind::kCsg;
  leaf.opacity = static_cast<std::uint8_t>(group_facts_[left].opacity | group_facts_[right].opacity);
  leaf.shape = static_cast<std::uint32_t>(out_.csgs.size());
  leaf.path = inner.path;
  out_.csgs.push_back(csg);
  return leaf;
}

/// Whether all copies of an object have few enough primitives; decided once, since it takes them from those
/// of the whole scene.
bool Compiler::small(std::uint32_t object) {
  Small& known = small_[object];
  if (known == Small::kUnknown) {
    const std::uint64_t most = std::min(most_copies_, copies_left_), uses = facts_.uses(object);
    const std::uint64_t primitives = facts_.primitives(scene_.named_objects[object].node);
    known = primitives <= most / uses ? Small::kYes : Small::kNo;
    if (known == Small::kYes) copies_left_ -= primitives * uses;
  }
  return known == Small::kYes;
}

/// Whether a named object itself stands at this place, not an instance of it.
bool Compiler::copied(std::uint32_t object, const Context& inner) {
  const NodeId body = scene_.named_objects[object].node;
  // One primitive: sharing it would save nothing.
  if (facts_.uses(object) <= 1 || is_primitive(innermost(body).kind)) return true;
  if (!small(object)) return false;
  if (inner.placement == kNone) return true;
  const Placement& placement = out_.placements[inner.placement];
  return !placement.animated() && (keeps_boxes(placement.map.forward) ||
                                   (facts_.primitives(body) <= kFewOperands && is_csg(innermost(body).kind)));
}

/// What stands in a node, where that is one thing, perhaps wrapped a few times.
const Node& Compiler::innermost(NodeId id) const {
  for (int level = 0; level < kWrappings; ++level) {
    const Node& node = scene_.nodes[id];
    if (is_primitive(node.kind)) return node;
    if (node.kind == NodeKind::kInstance) {
      id = scene_.named_objects[node.payload].node;
    } else if (scene_.aggregates[node.payload].members.size() == 1) {
      id = scene_.aggregates[node.payload].members[0];
    } else {
      return node;
    }
  }
  return scene_.nodes[id];
}

void Compiler::add_instance(Build& build, const Node& node, const Context& inner, int depth) {
  check_recursion(depth, node.location);
  const bool transparent_outside = inner.surface == Inherited::kTransparentSurface ||
                                   (inner.surface == Inherited::kNothing && build.transparent_outside);
  const std::uint32_t group = shared_group(node.payload, transparent_outside, node.location, depth + 1);
  const GroupFacts& facts = group_facts_[group];
  if (inner.surface == Inherited::kNothing) build.depends_on_outside |= facts.depends_on_outside;
  build.instances = std::max(build.instances, facts.instances + 1);
  build.recursion = std::max(build.recursion, facts.recursion + 1);
  check_recursion(build.recursion, node.location);
  if (build.instances > InstancePath::kCapacity) {
    throw CompileError("objects that are used several times are nested more than 32 deep", node.location);
  }
  Leaf leaf;
  leaf.kind = LeafKind::kInstance;
  leaf.opacity = facts.opacity;
  leaf.animated = inner.placement != kNone && out_.placements[inner.placement].animated();
  leaf.shape = static_cast<std::uint32_t>(out_.instances.size());
  leaf.placement = inner.placement;
  leaf.path = inner.path;
  out_.instances.push_back({group});
  build.solid = out_.groups[group].solid;
  add_leaf(build, leaf, std::max<std::uint64_t>(1, out_.groups[group].order_span), node.location);
}

/// Compiled once, or twice if the opacity of some leaf depends on the surface around the instance.
std::uint32_t Compiler::shared_group(std::uint32_t object, bool transparent_outside, const Location& where,
                                     int depth) {
  const std::uint64_t key = std::uint64_t{object} * 2 + (transparent_outside ? 1 : 0);
  for (const std::uint64_t variant : {key, key ^ 1}) {
    const auto found = shared_.find(variant);
    if (found == shared_.end()) continue;
    if (variant == key || !group_facts_[found->second].depends_on_outside) return found->second;
  }
  check_recursion(depth, where);
  Build build;
  build.transparent_outside = transparent_outside;
  flatten(build, {&scene_.named_objects[object].node, 1}, {}, depth);
  const std::uint32_t group = finish_group(std::move(build));
  shared_.emplace(key, group);
  ++out_.counts.shared_groups;
  return group;
}

std::uint32_t Compiler::finish_group(Build&& build) {
  const auto index = static_cast<std::uint32_t>(out_.groups.size());
  out_.groups.emplace_back();
  group_facts_.emplace_back();
  store_group(index, std::move(build));
  return index;
}

void Compiler::store_group(std::uint32_t index, Build&& build) {
  if (out_.leaves.size() + build.leaves.size() >= kNone) throw CompileError("too many objects", {});
  Group& group = out_.groups[index];
  GroupFacts& facts = group_facts_[index];
  group.first = static_cast<std::uint32_t>(out_.leaves.size());
  group.count = static_cast<std::uint32_t>(build.leaves.size());
  group.order_span = build.order;
  group.solid = build.leaves.size() == 1 && build.solid;
  for (const Leaf& leaf : build.leaves)
    facts.opacity = static_cast<std::uint8_t>(facts.opacity | leaf.opacity);
  facts.depends_on_outside = build.depends_on_outside;
  facts.instances = build.instances;
  facts.recursion = build.recursion;
  if (out_.leaves.empty()) {
    out_.leaves = std::move(build.leaves);
  } else {
    out_.leaves.insert(out_.leaves.end(), build.leaves.begin(), build.leaves.end());
  }
  out_.bottom_up.push_back(index);
}

std::unique_ptr<CompiledScene> compile_scene(const Scene& scene, Provider& provider,
                                             const CompileOptions& options) {
  auto out = std::make_unique<CompiledScene>();
  out->scene = &scene;
  Compiler(scene, provider, options, *out).run();
  out->shutter = options.shutter;
  out->frame = options.frame;
  out->threads = options.threads;
  out->rebuild(options.hierarchies);
  return out;
}

}  // namespace rayshade
