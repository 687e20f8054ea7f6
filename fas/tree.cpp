// SPDX-License-Identifier: MIT
#include "fas/tree.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <new>
#include <numeric>

#include "fas/leaf_writer.h"
#include "fas/part.h"

namespace fas {
namespace {

/// Cells with more candidates than this are split before they become leaves.
constexpr std::uint32_t kLarge = 192;
/// Cells with so few candidates that do not cover them gain nothing from a split.
constexpr std::uint32_t kFew = 6;
/// Splits in a row that hardly thin out the candidates, after which a cell is left as it is.
constexpr int kMostStalls = 3;
/// Subtrees of so few primitives are opened at once.
constexpr std::uint32_t kSmallSubtree = 4;
/// How many entries are looked at to find the extent of what a face sees: enough for their boxes to be small
/// beside it.
constexpr std::size_t kExtentEntries = 1024;
/// All coordinates are in units of the root square, which has 2^24 of them on a side. A ray's own coordinate
/// is cut off to whole units and has errors far below one, so areas are grown by one.
constexpr double kUnits = 0x1p24, kPad = 1;

using Clock = std::chrono::steady_clock;

/// Tags of Node::state; nodes and leaves are aligned to 16 bytes.
constexpr std::uintptr_t kNone = 0, kBusy = 1, kLeafTag = 2, kChildrenTag = 4, kTags = 15;

struct Entry {
  std::uint32_t id;
  float z0;
};

}  // namespace

struct TreeScratch {
  Geometry geometry;
  std::vector<Entry> lists[4];
  std::vector<std::uint32_t> stack;
  std::vector<Area> areas;
  std::vector<std::uint32_t> order;
  AreaCache latest;
};

ThreadState::ThreadState(Pool& pool) : arena(pool), scratch(std::make_unique<TreeScratch>()) {}
ThreadState::~ThreadState() = default;

/// A cell of the plane. `list` is written before `state` leaves kNone for anybody else to see.
struct alignas(16) HyperTree::Node {
  std::atomic<std::uintptr_t> state{kNone};
  const std::uint32_t* list = nullptr;  ///< candidates: primitives and subtrees
  std::uint32_t count = 0;
  std::uint32_t below = 0;  ///< primitives in them
  std::uint8_t stalls = 0;
  bool final = false;
};

/// Areas of a face in units of its root square.
class HyperTree::Square {
 public:
  Square(const HyperTree& tree, const Root& root, int face, TreeScratch& scratch)
      : tree_(tree),
        plane_(*tree.planes_[static_cast<std::size_t>(face)]),
        root_(root),
        face_(static_cast<std::uint32_t>(6 * tree.number_) + static_cast<std::uint32_t>(face)),
        scratch_(scratch) {}

  /// Null: the face does not see the primitive. Valid until the next call.
  const Area* primitive(std::uint32_t id) {
    return scratch_.latest.find(face_, id, [&](Area& out) { return project(id, out); });
  }
  bool subtree(const Candidates::Child& child, Area& out) const {
    Footprint f;
    if (!plane_.project(child.box, f)) return false;
    place(f, out);
    out.id = child.entry;
    out.cuts = 0;
    out.covers = false;
    return true;
  }

 private:
  bool project(std::uint32_t id, Area& out) const {
    Geometry& geometry = scratch_.geometry;
    tree_.candidates_.geometry(id, geometry);
    Footprint f;
    if (!plane_.project(geometry, f)) return false;
    place(f, out);
    out.id = id;
    out.cuts = static_cast<std::uint8_t>(f.cuts);
    out.covers = f.covers;
    for (int k = 0; k < f.cuts; ++k) {
      const double a = f.cut[k][0], b = f.cut[k][1], c = f.cut[k][2];
      out.cut[k][0] = a / root_.scale;
      out.cut[k][1] = b / root_.scale;
      const double rounding = 0x1p-48 * (std::fabs(a * root_.u0) + std::fabs(b * root_.v0) + std::fabs(c));
      const double pad = kPad * (std::fabs(a) + std::fabs(b)) / root_.scale;
      out.cut[k][2] = a * root_.u0 + b * root_.v0 + c + rounding + pad;
      out.inside[k] = f.covers ? f.inside[k] + 2 * (rounding + pad) : 0;
    }
    return true;
  }
  void place(const Footprint& f, Area& out) const {
    out.x0 = (f.u0 - root_.u0) * root_.scale - kPad, out.x1 = (f.u1 - root_.u0) * root_.scale + kPad;
    out.y0 = (f.v0 - root_.v0) * root_.scale - kPad, out.y1 = (f.v1 - root_.v0) * root_.scale + kPad;
    out.z0 = f.z0, out.z1 = f.z1;
  }
  const HyperTree& tree_;
  const Plane& plane_;
  const Root& root_;
  std::uint32_t face_;
  TreeScratch& scratch_;
};

View make_view(View::Kind kind, const Point& point, const Bounds& bounds, double condition) {
  constexpr double kUnit = std::numeric_limits<double>::epsilon();
  View view;
  view.kind = kind;
  double size = 0x1p-400;
  for (int i = 0; i < 3; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    size = std::max({size, std::fabs(bounds.lo[axis]), std::fabs(bounds.hi[axis])});
    if (kind == View::Kind::kPoint) size = std::max(size, std::fabs(point[axis]));
  }
  (kind == View::Kind::kPoint ? view.apex : view.direction) = point;
  // Origins may be 16 times as far away as anything else; 64 units for the exact test and as many for its ray
  // being moved, doubled, and the aim.
  view.reach = 16 * size;
  view.slack = 1024 * kUnit * condition * view.reach;
  view.aim = view.slack / 4;
  return view;
}

HyperTree::HyperTree(const View& view, const Candidates& candidates, Pool& pool, Tuner& tuner,
                     std::size_t number, Split split)
    : view_(view), candidates_(candidates), pool_(pool), tuner_(tuner), number_(number), split_(split) {
  for (int face = 0; face < view.faces(); ++face)
    planes_[static_cast<std::size_t>(face)] = std::make_unique<Plane>(view, face);
}

HyperTree::~HyperTree() = default;

void HyperTree::clear() {
  for (Root& root : roots_) {
    root.state.store(0, std::memory_order_relaxed);
    root.node = nullptr;
  }
}

/// The extent of what the face sees, and a node for it.
bool HyperTree::make_root(int face, ThreadState& state, TreeCounts& counts) {
  Root& root = roots_[static_cast<std::size_t>(face)];
  if (pool_.exhausted()) return false;
  std::uint32_t expected = 0;
  if (!root.state.compare_exchange_strong(expected, 1, std::memory_order_acquire)) return false;
  const Clock::time_point start = Clock::now();
  const Plane& plane = *planes_[static_cast<std::size_t>(face)];
  TreeScratch& scratch = *state.scratch;
  double u0 = std::numeric_limits<double>::infinity(), v0 = u0, u1 = -u0, v1 = -u0;
  const auto see = [&](const Footprint& f) {
    u0 = std::min(u0, f.u0), u1 = std::max(u1, f.u1);
    v0 = std::min(v0, f.v0), v1 = std::max(v1, f.v1);
  };
  // Breadth first, so that what is left closed at the end is as small as can be.
  std::vector<std::uint32_t>& queue = scratch.stack;
  queue.assign(1, Candidates::kWhole);
  Candidates::Child children[Candidates::kMostChildren];
  const bool all = candidates_.count() <= kExtentEntries;
  for (std::size_t next = 0; next < queue.size(); ++next) {
    const int count = candidates_.open(queue[next], children);
    for (int i = 0; i < count; ++i) {
      Footprint f;
      const bool closed = (children[i].entry & Candidates::kSubtree) != 0;
      if (closed && (all || queue.size() < kExtentEntries)) {
        if (plane.project(children[i].box, f)) queue.push_back(children[i].entry);
        continue;
      }
      if (closed) {
        if (plane.project(children[i].box, f)) see(f);
      } else {
        candidates_.geometry(children[i].entry, scratch.geometry);
        if (plane.project(scratch.geometry, f)) see(f);
      }
    }
  }
  if (!(u0 <= u1)) {
    root.u0 = root.v0 = 1e300;
    root.scale = 1;
    root.state.store(2, std::memory_order_release);
    return true;
  }
  if (view_.kind == View::Kind::kPoint) {
    u0 = std::max(u0, -1 - 0x1p-40), v0 = std::max(v0, -1 - 0x1p-40);
    u1 = std::min(u1, 1 + 0x1p-40), v1 = std::min(v1, 1 + 0x1p-40);
  }
  // Units must be coarse beside the rounding of coordinates.
  const double largest = std::max({std::fabs(u0), std::fabs(u1), std::fabs(v0), std::fabs(v1)});
  const double size = std::max({u1 - u0, v1 - v0, largest * 0x1p-20, 1e-300}) * (1 + 0x1p-18);
  root.u0 = u0 - size * 0x1p-20;
  root.v0 = v0 - size * 0x1p-20;
  root.scale = kUnits / size;
  std::byte* memory =
      std::isfinite(root.scale) ? state.arena.take(sizeof(Node) + sizeof(std::uint32_t)) : nullptr;
  if (!memory) {
    root.state.store(pool_.exhausted() ? 0 : 3, std::memory_order_release);
    return false;
  }
  auto* list = new (memory + sizeof(Node)) std::uint32_t(Candidates::kWhole);
  root.node = new (memory) Node;
  root.node->list = list;
  root.node->count = 1;
  root.node->below = candidates_.count();
  counts.nodes += 1;
  counts.bytes += sizeof(Node) + sizeof(std::uint32_t);
  counts.nanoseconds += static_cast<std::uint64_t>((Clock::now() - start).count());
  root.state.store(2, std::memory_order_release);
  return true;
}

HyperTree::Place HyperTree::descend(Root& root, int face, std::uint32_t u, std::uint32_t v,
                                    ThreadState& state, TreeCache& cache, const Leaf*& leaf) {
  if (!root.node) return Place::kNothing;
  Node* node = root.node;
  int shift = kBits;
  for (;;) {
    std::uintptr_t now = node->state.load(std::memory_order_acquire);
    if (now == kNone) {
      if (pool_.exhausted()) return Place::kElsewhere;
      if (!node->state.compare_exchange_strong(now, kBusy, std::memory_order_acquire))
        return Place::kElsewhere;
      const Clock::time_point start = Clock::now();
      const std::uint32_t mask = shift == kBits ? 0 : ~((1u << shift) - 1);
      now = make_node(*node, root, face, {u & mask, v & mask, kBits - shift}, state, cache.counts, false);
      cache.counts.nanoseconds += static_cast<std::uint64_t>((Clock::now() - start).count());
      node->state.store(now, std::memory_order_release);
      if (now == kNone) return Place::kElsewhere;
    }
    if (now == kBusy) return Place::kElsewhere;
    if ((now & kTags) == kLeafTag) {
      leaf = reinterpret_cast<const Leaf*>(now & ~kTags);
      if (cache.leaf != leaf) cache.occluder = 0xffffffffu;
      cache.leaf = leaf;
      cache.face = face;
      cache.u = u;
      cache.v = v;
      cache.shift = shift;
      return Place::kLeaf;
    }
    --shift;
    node = reinterpret_cast<Node*>(now & ~kTags) + ((u >> shift & 1) + 2 * (v >> shift & 1));
  }
}

std::uintptr_t HyperTree::make_node(Node& node, Root& root, int face, const Cell& cell, ThreadState& state,
                                    TreeCounts& counts, bool must_split) {
  if (cell.depth < kDeepest && !node.final && (must_split || node.below > kLarge))
    return make_children(node, root, face, cell, state, counts);
  return make_leaf(node, root, face, cell, state, counts);
}

/// Hands the candidates of a node to its four children.
std::uintptr_t HyperTree::make_children(Node& node, Root& root, int face, const Cell& cell,
                                        ThreadState& state, TreeCounts& counts) {
  const Clock::time_point start = Clock::now();
  TreeScratch& scratch = *state.scratch;
  Square square(*this, root, face, scratch);
  const double size = std::ldexp(0.5, kBits - cell.depth);
  Part parts[4];
  Truncation truncation[4];
  std::uint32_t below[4] = {}, covering[4] = {};
  for (int i = 0; i < 4; ++i) {
    parts[i] = {cell.u + (i & 1) * size, cell.v + (i >> 1) * size, size};
    scratch.lists[i].clear();
  }
  std::size_t looked_at = 0;
  const auto hand_out = [&](const Area& area, std::uint32_t primitives) {
    for (int i = 0; i < 4; ++i) {
      if (!parts[i].meets(area)) continue;
      truncation[i].see(parts[i], area);
      scratch.lists[i].push_back({area.id, static_cast<float>(area.z0)});
      below[i] += primitives;
      covering[i] += parts[i].within(area);
    }
  };
  const Part whole{static_cast<double>(cell.u), static_cast<double>(cell.v), 2 * size};
  std::vector<std::uint32_t>& stack = scratch.stack;
  stack.assign(node.list, node.list + node.count);
  Candidates::Child children[Candidates::kMostChildren];
  Area area;
  while (!stack.empty()) {
    const std::uint32_t entry = stack.back();
    stack.pop_back();
    if ((entry & Candidates::kSubtree) == 0) {
      ++looked_at;
      if (const Area* seen = square.primitive(entry)) hand_out(*seen, 1);
      continue;
    }
    // A subtree is handed on whole where it is small beside the children's cells.
    const int count = candidates_.open(entry, children);
    for (int i = 0; i < count; ++i) {
      if ((children[i].entry & Candidates::kSubtree) == 0) {
        stack.push_back(children[i].entry);
        continue;
      }
      ++looked_at;
      if (!square.subtree(children[i], area) || !whole.meets(area)) continue;
      const bool small = std::max(area.x1 - area.x0, area.y1 - area.y0) < 0.5 * size;
      if (small && children[i].below > kSmallSubtree)
        hand_out(area, children[i].below);
      else
        stack.push_back(children[i].entry);
    }
  }
  std::size_t bytes = 4 * sizeof(Node);
  for (const std::vector<Entry>& list : scratch.lists) bytes += sizeof(std::uint32_t) * list.size();
  std::byte* memory = state.arena.take(bytes);
  if (!memory) return kNone;
  auto* next = reinterpret_cast<std::uint32_t*>(memory + 4 * sizeof(Node));
  for (int i = 0; i < 4; ++i) {
    Node* child = new (memory + i * sizeof(Node)) Node;
    child->list = next;
    for (const Entry& entry : scratch.lists[i]) {
      if (truncation[i].drops(static_cast<double>(entry.z0) * (1 - 0x1p-20))) {
        ++counts.truncated;
        continue;
      }
      *next++ = entry.id;
      ++child->count;
    }
    child->below = below[i];
    const std::uint32_t n = child->count, thin = n - std::min(n, covering[i]);
    const bool hardly = thin < n / 2 && n > node.count - node.count / 5;
    child->stalls = static_cast<std::uint8_t>(hardly ? node.stalls + 1 : 0);
    child->final = below[i] == n && (thin <= kFew || thin < n / 4 || child->stalls >= kMostStalls);
  }
  counts.nodes += 4;
  counts.bytes += bytes;
  if (looked_at > 0) {
    tuner_.measured_candidate(static_cast<double>((Clock::now() - start).count()) /
                              static_cast<double>(looked_at));
  }
  return reinterpret_cast<std::uintptr_t>(memory) | kChildrenTag;
}

/// Opens what is closed, and quantises; or splits after all where that gives too many.
std::uintptr_t HyperTree::make_leaf(Node& node, Root& root, int face, const Cell& cell, ThreadState& state,
                                    TreeCounts& counts) {
  TreeScratch& scratch = *state.scratch;
  Square square(*this, root, face, scratch);
  const Part part{static_cast<double>(cell.u), static_cast<double>(cell.v),
                  std::ldexp(1.0, kBits - cell.depth)};
  std::vector<std::uint32_t>& stack = scratch.stack;
  std::vector<Area>& areas = scratch.areas;
  areas.clear();
  stack.assign(node.list, node.list + node.count);
  Candidates::Child children[Candidates::kMostChildren];
  Area area;
  Truncation truncation;
  std::uint32_t covering = 0;
  while (!stack.empty()) {
    const std::uint32_t entry = stack.back();
    stack.pop_back();
    if ((entry & Candidates::kSubtree) == 0) {
      const Area* seen = square.primitive(entry);
      if (!seen || !part.meets(*seen)) continue;
      truncation.see(part, *seen);
      covering += part.within(*seen);
      areas.push_back(*seen);
      continue;
    }
    const int count = candidates_.open(entry, children);
    for (int i = 0; i < count; ++i) {
      const bool closed = (children[i].entry & Candidates::kSubtree) != 0;
      if (!closed || (square.subtree(children[i], area) && part.meets(area)))
        stack.push_back(children[i].entry);
    }
  }
  const std::size_t found = areas.size();
  std::erase_if(areas, [&](const Area& a) { return truncation.drops(a.z0); });
  counts.truncated += found - areas.size();
  const auto n = static_cast<std::uint32_t>(areas.size());
  const std::uint32_t thin = n - std::min(n, covering);
  const bool final = node.final || cell.depth >= kDeepest || thin <= kFew || thin < n / 4;
  if (!final && (n > kLarge || split_ == Split::kAlways)) {
    // Keep what was found: the list only holds primitives of this cell now.
    std::byte* memory = state.arena.take(sizeof(std::uint32_t) * n);
    if (!memory) return kNone;
    auto* list = reinterpret_cast<std::uint32_t*>(memory);
    for (std::uint32_t i = 0; i < n; ++i) list[i] = areas[i].id;
    node.list = list;
    node.count = node.below = n;
    counts.bytes += sizeof(std::uint32_t) * n;
    return make_children(node, root, face, cell, state, counts);
  }

  std::vector<std::uint32_t>& order = scratch.order;
  order.resize(n);
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return areas[a].z0 < areas[b].z0 || (areas[a].z0 == areas[b].z0 && areas[a].id < areas[b].id);
  });
  std::uint32_t with_cuts = 0;
  for (const Area& a : areas) with_cuts += a.cuts > 0;
  const bool cuts = 2 * with_cuts >= n && n >= 3;
  const std::size_t bytes = leaf_bytes(n, cuts);
  std::byte* memory = state.arena.take(bytes);
  if (!memory) return kNone;
  write_leaf(memory, areas, order, part, {cuts, final, cell.depth});
  // From now on the node's own list is that of the leaf, should it be split.
  ++counts.leaves;
  counts.candidates += n;
  counts.bytes += bytes;
  return reinterpret_cast<std::uintptr_t>(memory) | kLeafTag;
}

void HyperTree::split_leaf(const Query& query, ThreadState& state, TreeCache& cache, const Leaf& leaf) {
  auto& mutable_leaf = const_cast<Leaf&>(leaf);
  if (pool_.exhausted() || mutable_leaf.splitting.exchange(1, std::memory_order_acq_rel) != 0) return;
  Root& root = roots_[static_cast<std::size_t>(query.face)];
  Node* node = root.node;
  const auto u = static_cast<std::uint32_t>((query.u - root.u0) * root.scale);
  const auto v = static_cast<std::uint32_t>((query.v - root.v0) * root.scale);
  int shift = kBits;
  for (;;) {
    const std::uintptr_t now = node->state.load(std::memory_order_acquire);
    if ((now & kTags) != kChildrenTag) {
      if ((now & kTags) != kLeafTag || reinterpret_cast<const Leaf*>(now & ~kTags) != &leaf) return;
      break;
    }
    --shift;
    node = reinterpret_cast<Node*>(now & ~kTags) + ((u >> shift & 1) + 2 * (v >> shift & 1));
  }
  const Clock::time_point start = Clock::now();
  const std::uint32_t mask = shift == kBits ? 0 : ~((1u << shift) - 1);
  const std::uintptr_t children =
      make_children(*node, root, query.face, {u & mask, v & mask, kBits - shift}, state, cache.counts);
  cache.counts.nanoseconds += static_cast<std::uint64_t>((Clock::now() - start).count());
  if (children == kNone) return;
  ++cache.counts.splits;
  node->state.store(children, std::memory_order_release);
  cache.face = -1;
}

void HyperTree::visit_leaves(const Root& root, const Node& node, const Cell& cell, int face,
                             void (*visit)(void*, int, double, double, double, const Leaf&),
                             void* context) const {
  const std::uintptr_t now = node.state.load(std::memory_order_acquire);
  if ((now & kTags) == kLeafTag) {
    const double size = std::ldexp(1.0, kBits - cell.depth) / root.scale;
    visit(context, face, root.u0 + cell.u / root.scale, root.v0 + cell.v / root.scale, size,
          *reinterpret_cast<const Leaf*>(now & ~kTags));
  } else if ((now & kTags) == kChildrenTag) {
    const auto* children = reinterpret_cast<const Node*>(now & ~kTags);
    const std::uint32_t half = 1u << (kBits - cell.depth - 1);
    for (std::uint32_t i = 0; i < 4; ++i) {
      visit_leaves(root, children[i], {cell.u + (i & 1) * half, cell.v + (i >> 1) * half, cell.depth + 1},
                   face, visit, context);
    }
  }
}

}  // namespace fas
