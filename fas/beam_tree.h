// SPDX-License-Identifier: MIT
// The hyper-tree of a class of rays with extent in space, in the full five dimensions: where rays start
// (three, within a box) and where they go (a face of the direction cube, and two within it), one root for
// each face (G. Simiakakis, A. M. Day, "Five-dimensional adaptive subdivision for ray tracing", CGF 13(2),
// 1994).
//
// Candidate sets are cuts of the hierarchy: up to kLanes of its subtrees and primitives, those that the beam
// of a cell meets. A ray starts its traversal from the cut of its cell in place of the root of the hierarchy,
// and the root cell's cut is the root: a tree that has not been split *is* the hierarchy. A cell is halved in
// the dimension that thins out its cut most, when the work of its rays has paid for that; the halves' cuts
// are then opened as far as there is room. A dimension without extent is never halved. Publishing, and what a
// thread does that finds a cell in the making, are as in HyperTree.
//
// Where the rays of a class are too unlike for any of this to pay, Choice finds out and leaves them to the
// hierarchy.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "fas/beam.h"
#include "fas/thread_state.h"
#include "fas/tree.h"

namespace fas {

/// Immutable but for `work` and `splitting`.
struct alignas(16) BeamLeaf {
  Cut cut;
  std::uint8_t lanes = 0;
  bool final = false;       ///< splitting it cannot help
  std::uint8_t stalls = 0;  ///< halvings in a row that hardly thinned out the cut
  std::uint8_t depth = 0;
  std::atomic<float> work{0};  ///< nanoseconds spent beyond the useful
  std::atomic<std::uint32_t> splitting{0};
};

class BeamTree {
 public:
  static constexpr std::size_t kDimensions = 5;
  static constexpr int kBits = 20;  ///< of a coordinate
  static constexpr int kLanes = 16;

  /// For rays that start within `origins` (or enter it, see enter()). `condition` as in make_probe(). All
  /// arguments must outlive the tree. `number`: of its BeamCache.
  BeamTree(const Hierarchy& hierarchy, const Bounds& origins, double condition, Pool& pool, Tuner& tuner,
           std::size_t number, Split split);

  std::size_t number() const { return number_; }

  /// A ray as the tree sees it: the face, and the coordinates of its start and direction.
  struct Query {
    int face = 0;
    std::array<std::uint32_t, kDimensions> at{};
  };
  /// For a ray that starts at `origin`. False: not for this tree (it starts elsewhere, or is no ray).
  bool place(const double* origin, const double* direction, Query& out) const;
  /// For a ray that starts anywhere: it is moved to where it enters the box of origins. False also where it
  /// does not.
  bool enter(const double* origin, const double* direction, Query& out) const;

  /// The leaf of a query: its cut is where the traversal starts.
  const BeamLeaf& find(const Query& query, BeamCache& cache) const;
  /// After a query: adds the work that was not useful, splits the leaf when it has paid for it.
  void charge(const Query& query, ThreadState& state, BeamCache& cache, const BeamLeaf& leaf,
              std::uint32_t box_tests, std::uint32_t tests, bool hit);

 private:
  struct Node;
  struct Pair;
  struct Cell {
    std::array<std::uint32_t, kDimensions> at{};   ///< corner
    std::array<std::uint8_t, kDimensions> bits{};  ///< halvings so far
  };
  struct Lanes;

  Beam beam_of(int face, const Cell& cell) const;
  std::uintptr_t split(const BeamLeaf& leaf, int face, const Cell& cell, ThreadState& state,
                       TreeCounts& counts);
  BeamLeaf* make_leaf(const Lanes& lanes, ThreadState& state, TreeCounts& counts) const;

  const Hierarchy& hierarchy_;
  Pool& pool_;
  Tuner& tuner_;
  std::size_t number_;
  Split split_;
  double slack_ = 0, reach_ = 0;
  Bounds origins_;  ///< grown by the slack
  std::array<double, 3> scale_{}, unit_{};
  std::array<BeamLeaf, 6> whole_;
  std::array<std::atomic<std::uintptr_t>, 6> roots_;
};

}  // namespace fas
