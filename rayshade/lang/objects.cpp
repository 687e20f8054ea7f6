// SPDX-License-Identifier: MIT
// See objects.h.
#include "rayshade/lang/objects.h"

#include <fmt/format.h>

#include <algorithm>

#include "rayshade/lang/suggest.h"

namespace rayshade::lang {

const char* keyword_of(NodeKind kind) {
  switch (kind) {
    case NodeKind::kPlane:
      return "plane";
    case NodeKind::kSphere:
      return "sphere";
    case NodeKind::kBox:
      return "box";
    case NodeKind::kDisc:
      return "disc";
    case NodeKind::kCylinder:
      return "cylinder";
    case NodeKind::kCone:
      return "cone";
    case NodeKind::kTorus:
      return "torus";
    case NodeKind::kTriangle:
    case NodeKind::kSmoothTriangle:
      return "triangle";
    case NodeKind::kUvTriangle:
      return "triangleuv";
    case NodeKind::kPolygon:
      return "poly";
    case NodeKind::kBlob:
      return "blob";
    case NodeKind::kHeightField:
      return "heightfield";
    case NodeKind::kList:
      return "list";
    case NodeKind::kGrid:
      return "grid";
    case NodeKind::kUnion:
      return "union";
    case NodeKind::kIntersect:
      return "intersect";
    case NodeKind::kDifference:
      return "difference";
    case NodeKind::kInstance:
      break;
  }
  return "object";
}

Objects::Objects(Context& context, Surfaces& surfaces) : context_(context), surfaces_(surfaces), scopes_(1) {}

NodeId Objects::make(NodeKind kind, std::size_t payload, std::uint32_t surface, const Span& keyword) {
  Node node;
  node.kind = kind;
  node.payload = static_cast<std::uint32_t>(payload);
  node.surface = surface;
  node.location = context_.sources.locate(keyword);
  context_.scene.nodes.push_back(node);
  lost_ = false;
  return static_cast<NodeId>(context_.scene.nodes.size() - 1);
}

bool Objects::too_deep(int levels, const Span& span) {
  if (levels <= kMostLevels) return false;
  context_.messages.error(span, fmt::format("objects are nested more than {} levels deep", kMostLevels));
  context_.messages.stop();
  return true;
}

NodeId Objects::primitive(NodeKind kind, std::size_t payload, const Span& keyword) {
  levels_ = 0;
  return make(kind, payload, surfaces_.waiting() ? surfaces_.index() : current_surface(), keyword);
}

NodeId Objects::degenerate() {
  if (surfaces_.waiting()) surfaces_.index();
  lost_ = false;
  return kNone;
}

NodeId Objects::instance(Name name, const Span& keyword, const Span& name_span) {
  const std::uint32_t surface = surfaces_.waiting() ? surfaces_.index() : current_surface();
  const auto found = names_.find(name.view());
  if (found == names_.end()) {
    Suggestion suggestion(name.view());
    for (const auto& [known, entry] : names_) suggestion.offer(known);
    context_.messages.error(name_span, fmt::format("there is no object named '{}'", name.view()),
                            suggestion.text());
  }
  lost_ = found == names_.end() || found->second.index == kNone;
  if (lost_) return kNone;
  levels_ = found->second.levels + 1;
  if (too_deep(levels_, keyword)) return kNone;
  return make(NodeKind::kInstance, found->second.index, surface, keyword);
}

void Objects::open(NodeKind kind, const Span& keyword) {
  too_deep(static_cast<int>(scopes_.size()), keyword);
  Scope& scope = scopes_.emplace_back();
  scope.kind = kind;
  scope.keyword = keyword;
}

void Objects::open_grid(int x, int y, int z, const Span& span) {
  open(NodeKind::kGrid, span);
  if (x < 1 || y < 1 || z < 1) {
    context_.messages.warning(span, fmt::format("invalid grid {} {} {}: counts below 1 become 1", x, y, z));
  }
  int* counts = scopes_.back().grid;
  counts[0] = std::max(x, 1);
  counts[1] = std::max(y, 1);
  counts[2] = std::max(z, 1);
}

NodeId Objects::close(const Span& span) {
  Scope scope = std::move(scopes_.back());
  scopes_.pop_back();
  const char* keyword = keyword_of(scope.kind);
  lost_ = scope.incomplete;
  if (scope.members.empty()) {
    if (!scope.incomplete)
      context_.messages.warning(span, fmt::format("this '{}' has no members and is dropped", keyword));
    return kNone;
  }
  if (is_csg(scope.kind) && scope.members.size() == 1) {
    if (!scope.incomplete) {
      context_.messages.warning(
          span, fmt::format("'{}' needs at least two objects; its only one is taken as it is", keyword));
    }
    scope.kind = NodeKind::kList;
  }
  if (is_csg(scope.kind) && !open_operand_told_) {
    const auto open_operand = std::find_if(scope.members.begin(), scope.members.end(), [&](NodeId id) {
      return !is_closed(context_.scene.nodes[id].kind);
    });
    if (open_operand != scope.members.end()) {
      context_.messages.advice(span, fmt::format("'{}' of an object that is not closed ({})", keyword,
                                                 keyword_of(context_.scene.nodes[*open_operand].kind)));
      open_operand_told_ = true;
    }
  }
  levels_ = scope.levels + 1;
  if (too_deep(levels_, scope.keyword)) return kNone;
  Aggregate aggregate;
  aggregate.members = std::move(scope.members);
  std::copy(std::begin(scope.grid), std::end(scope.grid), aggregate.grid);
  context_.scene.aggregates.push_back(std::move(aggregate));
  return make(scope.kind, context_.scene.aggregates.size() - 1, current_surface(), scope.keyword);
}

NodeId Objects::placed(NodeId node, TransformList transforms) {
  if (node == kNone || transforms.empty()) return node;
  context_.scene.nodes[node].transform = static_cast<std::uint32_t>(context_.scene.transforms.size());
  context_.scene.transforms.push_back(std::move(transforms));
  return node;
}

NodeId Objects::textured(NodeId node, std::vector<Texture> textures) {
  if (node == kNone || textures.empty()) return node;
  context_.scene.nodes[node].textures = static_cast<std::uint32_t>(context_.scene.texture_lists.size());
  context_.scene.texture_lists.push_back(std::move(textures));
  return node;
}

void Objects::add(NodeId node) {
  Scope& scope = scopes_.back();
  if (node == kNone) {
    scope.incomplete = scope.incomplete || lost_;
    return;
  }
  scope.levels = std::max(scope.levels, levels_);
  (scopes_.size() == 1 ? context_.scene.world : scope.members).push_back(node);
}

void Objects::name(Name name, const Span&, NodeId node) {
  if (node == kNone) {
    // A degenerate object leaves its name undefined (language.md 3.7); after a mistake one message is enough.
    if (lost_ && !names_.contains(name.view())) names_.emplace(name.view(), Named{});
    return;
  }
  Scene& scene = context_.scene;
  scene.named_objects.push_back({std::string(name.view()), node});
  names_.insert_or_assign(std::string(name.view()),
                          Named{static_cast<std::uint32_t>(scene.named_objects.size() - 1), levels_});
  if (!context_.options.verbose && !scene.settings.verbose) return;
  const std::uint64_t count = scene.primitive_count(node);
  context_.notes.push_back(fmt::format("{} \"{}\":\n\t{} primitive{}\n", keyword_of(scene.nodes[node].kind),
                                       name.view(), count, count == 1 ? " " : "s"));
}

void Objects::apply_surface() { scopes_.back().surface = surfaces_.index(); }

std::optional<Objects::Open> Objects::innermost() const {
  if (scopes_.size() == 1) return std::nullopt;
  return Open{keyword_of(scopes_.back().kind), scopes_.back().keyword};
}

}  // namespace rayshade::lang
