// SPDX-License-Identifier: MIT
// A whole scene as text in the Rayshade language: a normal form. Parsing it gives a scene with the same text,
// and the same picture to the byte.
//
// Order: settings, lights, surfaces, named objects in the order of their definition, world. All names are
// global and an object can only use names defined before it, so named objects may stand at top level wherever
// they were written. Names that occur twice are renamed; a text whose names are unique keeps them.
//
// Surfaces are bound already (language.md 5); the text must bind them the same way. Primitives and instances
// carry theirs. An aggregate cannot: it takes what the last `applysurf` of its scope set, which would also
// reach every later member that has no surface. So an aggregate gets an `applysurf` only where no such member
// follows, which is so in every parsed scope. Elsewhere, and always where it is named, the aggregate is named
// without a surface and used by an `object SURFACE NAME`, which binds alike.
#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "rayshade/scene/hash128.h"
#include "rayshade/scene/scene.h"
#include "rayshade/scene/scene_text.h"

namespace rayshade {
namespace {

bool is_aggregate(const Node& node) { return !is_primitive(node.kind) && node.kind != NodeKind::kInstance; }

/// Hands out each name once; asked again it appends a number.
class UniqueNames {
 public:
  std::string take(const std::string& wanted) {
    std::string base = is_language_name(wanted) ? wanted : "object";
    if (taken_.insert(base).second) return base;
    for (std::size_t& number = next_.try_emplace(base, 2).first->second;; ++number) {
      std::string candidate = base + '_' + std::to_string(number);
      if (taken_.insert(candidate).second) return candidate;
    }
  }

 private:
  std::unordered_set<std::string> taken_;
  std::unordered_map<std::string, std::size_t> next_;
};

class ObjectWriter {
 public:
  ObjectWriter(const Scene& scene, TextWriter& out, SurfaceNames& surfaces)
      : scene_(scene), out_(out), surfaces_(surfaces) {
    for (const NamedObject& object : scene.named_objects) names_.push_back(unique_.take(object.name));
  }

  void write_named_objects() {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const NodeId id = scene_.named_objects[i].node;
      write_detached_below(id);
      const Node& node = scene_.nodes[id];
      if (is_aggregate(node) && node.surface != kNone) {
        const std::string body = write_detached(id, names_[i] + "_body");
        start_definition(names_[i]);
        write_use(node, body);
      } else {
        start_definition(names_[i]);
        write_object(id, 0);
      }
      out_.end_line();
    }
  }

  void write_world() {
    // Definitions before the first `applysurf`, which would reach them.
    for (const NodeId id : scene_.world) write_detached_below(id);
    detach_members(scene_.world);
    Scope scope(scene_.world);
    while (scope.next < scope.members->size()) {
      const NodeId id = (*scope.members)[scope.next++];
      write_applysurf(scope, id, 0);
      write_object(id, 0);
      out_.end_line();
    }
  }

 private:
  /// A list of members being written, and the surface that `applysurf` has set in it.
  struct Scope {
    explicit Scope(const std::vector<NodeId>& list) : members(&list) {}
    const std::vector<NodeId>* members;
    std::size_t next = 0;
    std::uint32_t current = kNone;
    const Node* owner = nullptr;
  };

  void start_definition(const std::string& name) {
    out_.word("name");
    out_.word(name);
  }

  void write_use(const Node& node, const std::string& name) {
    out_.word("object");
    if (node.surface != kNone) out_.word(surfaces_.name(scene_.surfaces[node.surface]));
    out_.word(name);
  }

  /// Names an aggregate without its surface, transforms and textures included.
  std::string write_detached(NodeId id, const std::string& wanted) {
    std::string name = unique_.take(wanted);
    start_definition(name);
    write_object(id, 0);
    out_.end_line();
    return name;
  }

  /// Detaches the members of one scope that an `applysurf` cannot serve.
  void detach_members(const std::vector<NodeId>& members) {
    std::size_t bare = members.size();  // one past the last member without a surface
    while (bare > 0 && scene_.nodes[members[bare - 1]].surface != kNone) --bare;
    for (std::size_t i = 0; i < bare; ++i) {
      const Node& node = scene_.nodes[members[i]];
      if (!is_aggregate(node) || node.surface == kNone || detached_.contains(members[i])) continue;
      detached_[members[i]] = write_detached(members[i], "aggregate");
    }
  }

  /// Does so for all aggregates in the tree of `root`, the innermost first. Does not follow instances.
  void write_detached_below(NodeId root) {
    struct Visit {
      const std::vector<NodeId>* members;
      std::size_t next;
    };
    std::vector<Visit> visits;
    const auto enter = [&](NodeId id) {
      const Node& node = scene_.nodes[id];
      if (is_aggregate(node)) visits.push_back({&scene_.aggregates[node.payload].members, 0});
    };
    enter(root);
    while (!visits.empty()) {
      Visit& top = visits.back();
      if (top.next < top.members->size()) {
        enter((*top.members)[top.next++]);
        continue;
      }
      const std::vector<NodeId>& members = *top.members;
      visits.pop_back();
      detach_members(members);
    }
  }

  void write_applysurf(Scope& scope, NodeId id, int depth) {
    const Node& node = scene_.nodes[id];
    if (!is_aggregate(node) || node.surface == kNone || detached_.contains(id)) return;
    if (scope.current != kNone && scene_.surfaces[scope.current] == scene_.surfaces[node.surface]) return;
    scope.current = node.surface;
    out_.word("applysurf");
    out_.word(surfaces_.name(scene_.surfaces[node.surface]));
    out_.end_line(depth);
  }

  void write_modifiers(const Node& node) {
    if (node.transform != kNone) write_transforms(out_, scene_.transforms[node.transform]);
    if (node.textures == kNone) return;
    for (const Texture& texture : scene_.texture_lists[node.textures])
      write_texture(out_, texture, surfaces_);
  }

  void write_opening(const Node& node) {
    const int* grid = scene_.aggregates[node.payload].grid;
    switch (node.kind) {
      case NodeKind::kGrid:
        out_.word("grid");
        for (int axis = 0; axis < 3; ++axis) out_.integer(grid[axis]);
        break;
      case NodeKind::kUnion:
        out_.word("union");
        break;
      case NodeKind::kIntersect:
        out_.word("intersect");
        break;
      case NodeKind::kDifference:
        out_.word("difference");
        break;
      default:
        out_.word("list");
        break;
    }
  }

  /// Writes one object with its members, transforms and textures, without a line end; an aggregate without
  /// its surface. The walk has its own stack: aggregates may nest to any depth.
  void write_object(NodeId root, int depth) {
    std::vector<Scope> scopes;
    const auto enter = [&](NodeId id) {
      const Node& node = scene_.nodes[id];
      if (const auto name = detached_.find(id); name != detached_.end()) {
        write_use(node, name->second);
      } else if (is_aggregate(node)) {
        write_opening(node);
        scopes.emplace_back(scene_.aggregates[node.payload].members);
        scopes.back().owner = &node;
      } else {
        if (is_primitive(node.kind)) {
          write_primitive(out_, scene_, node, surfaces_);
        } else {
          write_use(node, names_[node.payload]);
        }
        write_modifiers(node);
      }
    };
    enter(root);
    while (!scopes.empty()) {
      Scope& scope = scopes.back();
      const int inner = depth + static_cast<int>(std::min<std::size_t>(scopes.size(), 1000));
      if (scope.next < scope.members->size()) {
        const NodeId id = (*scope.members)[scope.next++];
        out_.end_line(inner);
        write_applysurf(scope, id, inner);
        enter(id);
        continue;
      }
      const Node* owner = scope.owner;
      scopes.pop_back();
      out_.end_line(inner - 1);
      out_.word("end");
      write_modifiers(*owner);
    }
  }

  const Scene& scene_;
  TextWriter& out_;
  SurfaceNames& surfaces_;
  UniqueNames unique_;
  std::vector<std::string> names_;                    // of Scene::named_objects
  std::unordered_map<NodeId, std::string> detached_;  // aggregates that are used by a name of their own
};

}  // namespace

namespace {

/// The settings, lights and surfaces, which stand before the objects that use them.
std::string head_text(const Scene& scene, const SurfaceNames& surfaces, NumberForm form) {
  TextWriter head(form);
  write_settings(head, scene.settings);
  for (const Light& light : scene.lights) {
    write_light(head, light);
    head.end_line();
  }
  surfaces.write_definitions(head);
  return head.text();
}

void write_objects(const Scene& scene, TextWriter& out, SurfaceNames& surfaces) {
  ObjectWriter writer(scene, out, surfaces);
  writer.write_named_objects();
  writer.write_world();
}

}  // namespace

std::string canonical_text(const Scene& scene) {
  SurfaceNames surfaces;
  TextWriter objects;
  write_objects(scene, objects, surfaces);
  return head_text(scene, surfaces, NumberForm::kDecimal) + objects.text();
}

// The same writers as the text's, numbers being left as bits. The objects go by in pieces, each leaving its
// hash: a scene of millions of objects is never held as text.
std::string scene_hash(const Scene& scene) {
  constexpr std::size_t kPiece = 1 << 16;
  SurfaceNames surfaces;
  std::string digests;
  TextWriter objects(NumberForm::kBits, kPiece,
                     [&](const std::string& piece) { digests += hash128(piece).text(); });
  write_objects(scene, objects, surfaces);
  return hash128(head_text(scene, surfaces, NumberForm::kBits) + digests + hash128(objects.text()).text())
      .text();
}

}  // namespace rayshade
