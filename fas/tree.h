// SPDX-License-Identifier: MIT
// The hyper-tree of a class of rays without extent in space: five-dimensional adaptive subdivision with the
// three dimensions of the origin left out (G. Simiakakis, A. M. Day, "Five-dimensional adaptive subdivision
// for ray tracing", CGF 13(2), 1994; J. Arvo, D. Kirk, "Fast ray tracing by ray classification", SIGGRAPH
// 1987). Cells are squares of the plane of a face (projection.h); a leaf holds the candidates whose areas
// meet its cell, nearest first, with areas quantised to 256ths of the cell.
//
// Everything is made when the first ray needs it, by whichever thread comes first, and never changes once it
// can be seen: a node goes from nothing to a leaf, or from a leaf to four children, by one atomic store.
// Nobody waits: a thread that finds a node in the making, or no memory left, is told to ask the hierarchy
// instead, which gives the same answer. Candidate lists start as one entry, the whole hierarchy, and are
// opened as cells get smaller than the boxes of subtrees, so that the top of a tree over a million primitives
// costs a cut and not a million.
//
// Splitting is decided by what a leaf has cost: work beyond the useful (tests that did not decide, blocks
// looked at) against the measured cost of a split, as in the ski-rental problem; see Tuner.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "fas/areas.h"
#include "fas/candidates.h"
#include "fas/kernels.h"
#include "fas/projection.h"
#include "fas/thread_state.h"
#include "fas/tuner.h"

namespace fas {

/// Immutable but for `work` and `splitting`; blocks follow.
struct Leaf {
  std::uint32_t count;
  std::uint8_t cuts;        ///< 1: blocks have half-planes
  std::uint8_t final;       ///< 1: splitting it cannot help
  std::uint16_t depth;      ///< of the cell
  float z0, z_scale;        ///< quantised depth = (z - z0) z_scale
  std::atomic<float> work;  ///< nanoseconds spent beyond the useful
  std::atomic<std::uint32_t> splitting;
  const std::uint8_t* blocks() const { return reinterpret_cast<const std::uint8_t*>(this + 1); }
};

/// A view for primitives within `bounds` whose exact tests are off by no more than 64 `condition` units of
/// rounding of the coordinates at hand. Point views: `point` is the apex; parallel ones: the direction, unit
/// length.
View make_view(View::Kind kind, const Point& point, const Bounds& bounds, double condition);

/// Whether a ray from `o` along `d`, of interest up to t = `hi`, passes the apex closely enough, starts near
/// enough and ends before it, for the view to hold it. (At the apex itself hulls are grown by more than
/// `aim`.)
inline bool aims_at(const View& view, const double* o, const double* d, double hi) {
  const double size = std::max({std::fabs(o[0]), std::fabs(o[1]), std::fabs(o[2])});
  if (!(size <= view.reach)) return false;
  if (view.kind == View::Kind::kParallel)
    return d[0] == view.direction[0] && d[1] == view.direction[1] && d[2] == view.direction[2];
  const double x = view.apex[0] - o[0], y = view.apex[1] - o[1], z = view.apex[2] - o[2];
  const double a = y * d[2] - z * d[1], b = z * d[0] - x * d[2], c = x * d[1] - y * d[0];
  const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  return a * a + b * b + c * c <= view.aim * view.aim * square &&
         hi * hi * square <= x * x + y * y + z * z + view.aim * (std::fabs(x) + std::fabs(y) + std::fabs(z));
}

enum class Split : std::uint8_t {
  kAdaptive,
  kAlways,  ///< as deep as cells go; for study
};

class HyperTree {
 public:
  /// What find() says of a ray.
  enum class Place : std::uint8_t {
    kNothing,  ///< no primitive can be in its way
    kLeaf,
    kElsewhere,  ///< ask the hierarchy
  };
  static constexpr int kBits = 24;     ///< of a coordinate within the root square
  static constexpr int kDeepest = 13;  ///< leaves keep 3 bits more than the 8 of their quantised areas

  HyperTree(const View& view, const Candidates& candidates, Pool& pool, Tuner& tuner, std::size_t number,
            Split split = Split::kAdaptive);
  ~HyperTree();
  HyperTree(const HyperTree&) = delete;
  HyperTree& operator=(const HyperTree&) = delete;

  std::size_t number() const { return number_; }
  const View& view() const { return view_; }
  /// Nothing is left of it; memory is the pool's. No thread may be tracing.
  void clear();

  /// A ray as the tree sees it.
  struct Query {
    int face = 0;
    double u = 0, v = 0;
    double depth = 0;  ///< where the ray starts (rays toward the apex), or 0
  };
  /// The place of the direction `d` from the apex (eye rays).
  Query from_apex(const double* d) const;
  /// The place of a ray that starts at `o` and goes toward the apex, or along the direction of a parallel
  /// view.
  Query toward(const double* o) const;

  /// Finds, and where need be makes, the leaf of a query. `qu`, `qv`: where in its cell.
  Place find(const Query& query, ThreadState& state, TreeCache& cache, const Leaf*& leaf, std::uint8_t& qu,
             std::uint8_t& qv);
  /// After a query: adds the work that was not useful, splits the leaf when it has paid for it.
  void charge(const Query& query, ThreadState& state, TreeCache& cache, const Leaf& leaf, int wasted_tests,
              int extra_blocks) {
    if (leaf.final != 0 || (wasted_tests | extra_blocks) == 0) return;
    const double wasted = wasted_tests * kTestCost + extra_blocks * kBlockCost;
    auto& work = const_cast<Leaf&>(leaf).work;  // the leaf's only mutable part
    const float sum = work.load(std::memory_order_relaxed) + static_cast<float>(wasted);
    work.store(sum, std::memory_order_relaxed);
    if (sum > split_at(leaf)) split_leaf(query, state, cache, leaf);
  }

  /// Smallest quantised depth from which on candidates lie behind depth `z`.
  std::uint8_t quantised(const Leaf& leaf, double z) const {
    const double q = (z + z * 0x1p-44 + 2 * view_.slack - leaf.z0) * leaf.z_scale;
    return q < 255 ? (q > 0 ? static_cast<std::uint8_t>(q) : 0) : 255;
  }
  /// Whether every candidate of the leaf is behind depth `z`.
  bool behind(const Leaf& leaf, double z) const { return z + z * 0x1p-44 + 2 * view_.slack < leaf.z0; }

  /// Calls `visit(face, u, v, size, leaf)` for every cell that has a leaf now. No thread may be tracing.
  template <class Visit>
  void each_leaf(const Visit& visit) const;

 private:
  struct Node;
  struct Root {
    std::atomic<std::uint32_t> state{0};  ///< 0 nothing, 1 in the making, 2 there, 3 given up
    double u0 = 0, v0 = 0, scale = 0, cell = 0;
    Node* node = nullptr;
  };
  struct Cell {
    std::uint32_t u, v;  ///< corner, in units of the root square
    int depth;
  };
  class Square;

  float split_at(const Leaf& leaf) const {
    const double full = static_cast<double>(pool_.used()) / kAmple;
    return static_cast<float>(kPatience * (1 + full * full) * tuner_.per_candidate() * (8 + leaf.count));
  }
  bool make_root(int face, ThreadState& state, TreeCounts& counts);
  Place descend(Root& root, int face, std::uint32_t u, std::uint32_t v, ThreadState& state, TreeCache& cache,
                const Leaf*& leaf);
  std::uintptr_t make_node(Node& node, Root& root, int face, const Cell& cell, ThreadState& state,
                           TreeCounts& counts, bool must_split);
  std::uintptr_t make_children(Node& node, Root& root, int face, const Cell& cell, ThreadState& state,
                               TreeCounts& counts);
  std::uintptr_t make_leaf(Node& node, Root& root, int face, const Cell& cell, ThreadState& state,
                           TreeCounts& counts);
  void split_leaf(const Query& query, ThreadState& state, TreeCache& cache, const Leaf& leaf);
  void visit_leaves(const Root& root, const Node& node, const Cell& cell, int face,
                    void (*visit)(void*, int, double, double, double, const Leaf&), void* context) const;

  /// A leaf is split when its wasted work exceeds this many times the cost of a split. Splitting too early is
  /// the costly error (memory), too late costs little.
  static constexpr double kPatience = 3;
  /// Bytes of all trees from which on splits must be worth more and more: what caches do not hold costs time
  /// of its own, which no split is charged with.
  static constexpr double kAmple = 8 << 20;
  /// Nanoseconds of an exact test: of a sphere or triangle; those of other shapes cost more, and are then
  /// split late, which costs little.
  static constexpr double kTestCost = 10;
  /// Nanoseconds to look at a block.
  static constexpr double kBlockCost = 6;

  View view_;
  const Candidates& candidates_;
  Pool& pool_;
  Tuner& tuner_;
  std::size_t number_;
  Split split_;
  std::array<std::unique_ptr<Plane>, 6> planes_;
  std::array<Root, 6> roots_;
};

template <class Visit>
void HyperTree::each_leaf(const Visit& visit) const {
  const auto call = [](void* context, int face, double u, double v, double size, const Leaf& leaf) {
    (*static_cast<const Visit*>(context))(face, u, v, size, leaf);
  };
  for (int face = 0; face < view_.faces(); ++face) {
    const Root& root = roots_[static_cast<std::size_t>(face)];
    // A face that sees nothing has no node.
    if (root.state.load(std::memory_order_acquire) != 2 || !root.node) continue;
    visit_leaves(root, *root.node, {0, 0, 0}, face, call, const_cast<Visit*>(&visit));
  }
}

inline HyperTree::Query HyperTree::from_apex(const double* d) const {
  Query query;
  query.face = face_of(d);
  planes_[static_cast<std::size_t>(query.face)]->of_direction(d, query.u, query.v);
  return query;
}

inline HyperTree::Query HyperTree::toward(const double* o) const {
  Query query;
  if (view_.kind == View::Kind::kPoint) {
    const double d[3] = {o[0] - view_.apex[0], o[1] - view_.apex[1], o[2] - view_.apex[2]};
    query.face = face_of(d);
    planes_[static_cast<std::size_t>(query.face)]->of_direction(d, query.u, query.v);
    const double z = d[query.face >> 1];
    query.depth = z < 0 ? -z : z;
  } else {
    const Point p = planes_[0]->local({o[0], o[1], o[2]});
    query.u = p[0], query.v = p[1], query.depth = p[2];
  }
  return query;
}

inline HyperTree::Place HyperTree::find(const Query& query, ThreadState& state, TreeCache& cache,
                                        const Leaf*& leaf, std::uint8_t& qu, std::uint8_t& qv) {
  Root& root = roots_[static_cast<std::size_t>(query.face)];
  const std::uint32_t ready = root.state.load(std::memory_order_acquire);
  if (ready != 2) {
    if (ready == 3 || !make_root(query.face, state, cache.counts)) return Place::kElsewhere;
  }
  // Beyond the root square there is nothing at all. (Comparisons are false for NaN, which goes elsewhere, as
  // does infinity: the quotients of denormal numbers overflow.)
  const double x = (query.u - root.u0) * root.scale, y = (query.v - root.v0) * root.scale;
  if (!(x >= 0 && y >= 0 && x < 0x1p24 && y < 0x1p24))
    return (x - x) + (y - y) == 0 ? Place::kNothing : Place::kElsewhere;
  const auto u = static_cast<std::uint32_t>(x), v = static_cast<std::uint32_t>(y);
  if (cache.face == query.face && (((u ^ cache.u) | (v ^ cache.v)) >> cache.shift) == 0) {
    leaf = cache.leaf;
    ++cache.counts.cached_leaf;
  } else if (const Place place = descend(root, query.face, u, v, state, cache, leaf); place != Place::kLeaf) {
    return place;
  }
  const int low = cache.shift - 8;
  qu = static_cast<std::uint8_t>(u >> low);
  qv = static_cast<std::uint8_t>(v >> low);
  return Place::kLeaf;
}

/// The nearest hit of a ray that starts at the apex. `depth_of` turns the limit on t into a depth; `limit()`
/// gives the far limit t of what is still of interest; `test(primitive)` runs the exact test and answers
/// whether it became the nearest hit. Returns kElsewhere where the hierarchy must be asked; otherwise
/// everything that could be hit before the limit has been tested.
template <class Limit, class Test>
HyperTree::Place nearest_from_apex(HyperTree& tree, ThreadState& state, const double* direction,
                                   const Limit& limit, const Test& test) {
  TreeCache& cache = state.cache(tree.number());
  const HyperTree::Query query = tree.from_apex(direction);
  const double axis = direction[query.face >> 1], speed = axis < 0 ? -axis : axis;
  const Leaf* leaf = nullptr;
  Probe probe;
  const HyperTree::Place place = tree.find(query, state, cache, leaf, probe.u, probe.v);
  if (place != HyperTree::Place::kLeaf) {
    ++(place == HyperTree::Place::kNothing ? cache.counts.outside : cache.counts.elsewhere);
    cache.counts.rays += place == HyperTree::Place::kNothing;
    return place;
  }
  ++cache.counts.rays;
  const Kernels& simd = kernels();
  const std::uint8_t* block = leaf->blocks();
  int tests = 0, blocks = 0;
  bool hit = false;
  probe.z = tree.quantised(*leaf, limit() * speed);
  for (std::uint32_t left = leaf->count; left > 0;) {
    const int n = static_cast<int>(left < Block::kMost ? left : Block::kMost);
    const std::size_t s = Block::stride(static_cast<std::size_t>(n));
    if (block[4 * s] > probe.z) break;
    ++blocks;
    const auto* ids = reinterpret_cast<const std::uint32_t*>(
        block + Block::bytes(static_cast<std::size_t>(n), leaf->cuts != 0) - Block::kIdBytes * s);
    for (std::uint64_t mask = simd.match(block, n, leaf->cuts != 0, probe); mask != 0; mask &= mask - 1) {
      const int i = std::countr_zero(mask);
      if (block[4 * s + static_cast<std::size_t>(i)] > probe.z) break;
      ++tests;
      if (test(ids[i])) {
        hit = true;
        probe.z = tree.quantised(*leaf, limit() * speed);
      }
    }
    block += Block::bytes(static_cast<std::size_t>(n), leaf->cuts != 0);
    left -= static_cast<std::uint32_t>(n);
  }
  cache.counts.blocks += static_cast<std::uint64_t>(blocks);
  cache.counts.tests += static_cast<std::uint64_t>(tests);
  cache.counts.hits += hit;
  tree.charge(query, state, cache, *leaf, tests - hit, blocks - 1);
  return place;
}

/// Whether anything lies between the start of a ray and the apex toward which it goes (or, parallel views,
/// along it). `test(primitive)`: whether it occludes.
template <class Test>
HyperTree::Place occluded_toward(HyperTree& tree, ThreadState& state, const double* origin, const Test& test,
                                 bool& occluded) {
  TreeCache& cache = state.cache(tree.number());
  const HyperTree::Query query = tree.toward(origin);
  const Leaf* leaf = nullptr;
  Probe probe;
  occluded = false;
  const Leaf* before = cache.leaf;
  const HyperTree::Place place = tree.find(query, state, cache, leaf, probe.u, probe.v);
  if (place != HyperTree::Place::kLeaf) {
    ++(place == HyperTree::Place::kNothing ? cache.counts.outside : cache.counts.elsewhere);
    cache.counts.rays += place == HyperTree::Place::kNothing;
    return place;
  }
  ++cache.counts.rays;
  if (tree.behind(*leaf, query.depth)) return place;
  if (leaf != before) cache.occluder = 0xffffffffu;
  if (cache.occluder != 0xffffffffu && test(cache.occluder)) {
    ++cache.counts.tests;
    ++cache.counts.hits;
    ++cache.counts.cached_hit;
    occluded = true;
    return place;
  }
  const Kernels& simd = kernels();
  const std::uint8_t* block = leaf->blocks();
  int tests = cache.occluder != 0xffffffffu ? 1 : 0, blocks = 0;
  probe.z = tree.quantised(*leaf, query.depth);
  for (std::uint32_t left = leaf->count; left > 0 && !occluded;) {
    const int n = static_cast<int>(left < Block::kMost ? left : Block::kMost);
    const std::size_t s = Block::stride(static_cast<std::size_t>(n));
    if (block[4 * s] > probe.z) break;
    ++blocks;
    const auto* ids = reinterpret_cast<const std::uint32_t*>(
        block + Block::bytes(static_cast<std::size_t>(n), leaf->cuts != 0) - Block::kIdBytes * s);
    for (std::uint64_t mask = simd.match(block, n, leaf->cuts != 0, probe); mask != 0; mask &= mask - 1) {
      const std::uint32_t id = ids[std::countr_zero(mask)];
      if (id == cache.occluder) continue;
      ++tests;
      if (test(id)) {
        occluded = true;
        cache.occluder = id;
        break;
      }
    }
    block += Block::bytes(static_cast<std::size_t>(n), leaf->cuts != 0);
    left -= static_cast<std::uint32_t>(n);
  }
  cache.counts.blocks += static_cast<std::uint64_t>(blocks);
  cache.counts.tests += static_cast<std::uint64_t>(tests);
  cache.counts.hits += occluded;
  tree.charge(query, state, cache, *leaf, tests - occluded, blocks - 1);
  return place;
}

}  // namespace fas
