// SPDX-License-Identifier: MIT
// Objects, aggregates, names and the binding of surfaces (language.md 3.7 and 5). There is a stack of scopes,
// the top level being the first: each collects members and has a current surface, which its inner scopes do
// not inherit.
//
// Invariant: a node that is kNone was dropped, with a message; everything that takes a node takes kNone too.
#pragma once

#include "rayshade/lang/surfaces.h"

namespace rayshade::lang {

/// Levels of aggregates and instances; whoever walks the scene recurses over them.
inline constexpr int kMostLevels = 10000;

class Objects {
 public:
  Objects(Context& context, Surfaces& surfaces);

  /// A new primitive: its surface is the one that waits, else the current surface.
  NodeId primitive(NodeKind kind, std::size_t payload, const Span& keyword);
  /// A primitive that was dropped for being degenerate: kNone. Its surface is taken all the same.
  NodeId degenerate();
  /// `object [surface] X`.
  NodeId instance(Name name, const Span& keyword, const Span& name_span);
  void open(NodeKind kind, const Span& keyword);
  void open_grid(int x, int y, int z, const Span& span);
  /// `end`: the aggregate, bound to the current surface of the scope outside.
  NodeId close(const Span& span);

  NodeId placed(NodeId node, TransformList transforms);
  NodeId textured(NodeId node, std::vector<Texture> textures);
  /// A member of the innermost scope.
  void add(NodeId node);
  void name(Name name, const Span& name_span, NodeId node);

  void apply_surface();
  /// Of the innermost scope; kNone if none was applied.
  std::uint32_t current_surface() const { return scopes_.back().surface; }

  /// The innermost open aggregate: its keyword and where it stands; nothing at top level.
  struct Open {
    const char* keyword;
    Span span;
  };
  std::optional<Open> innermost() const;
  /// The innermost scope lost members to a mistake: say nothing about how few it has.
  void recover() { scopes_.back().incomplete = true; }
  /// The names that `object` could refer to.
  const auto& names() const { return names_; }

 private:
  struct Scope {
    NodeKind kind = NodeKind::kList;
    Span keyword;
    std::vector<NodeId> members;
    std::uint32_t surface = kNone;
    int grid[3] = {0, 0, 0};
    int levels = 0;           ///< of the deepest member
    bool incomplete = false;  ///< a member was lost to a mistake
  };
  struct Named {
    std::uint32_t index = kNone;  ///< into Scene::named_objects; kNone if the object was lost to a mistake
    int levels = 0;
  };

  NodeId make(NodeKind kind, std::size_t payload, std::uint32_t surface, const Span& keyword);
  bool too_deep(int levels, const Span& span);

  Context& context_;
  Surfaces& surfaces_;
  std::vector<Scope> scopes_;
  NameMap<Named> names_;
  int levels_ = 0;     ///< of the node made last
  bool lost_ = false;  ///< the node made last was lost to a mistake, not merely degenerate
  bool open_operand_told_ = false;
};

/// The keyword of a kind of object.
const char* keyword_of(NodeKind kind);

}  // namespace rayshade::lang
