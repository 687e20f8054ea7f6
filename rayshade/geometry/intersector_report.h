// SPDX-License-Identifier: MIT
// What an intersector did for every class of rays: for statistics. Threads count for themselves, in their
// scratches; a report adds them up.
#pragma once

#include <cstdint>
#include <vector>

#include "fas/statistics.h"

namespace rayshade {

/// Queries that went through the world's hierarchy from its root.
struct HierarchyCounts {
  std::uint64_t rays = 0;
  std::uint64_t tests = 0;  ///< exact tests of primitives
  std::uint64_t bounds_tests = 0;
  void add(const HierarchyCounts& o) {
    rays += o.rays;
    tests += o.tests;
    bounds_tests += o.bounds_tests;
  }
};

struct ClassReport {
  enum class Rays : std::uint8_t {
    kEye,
    kReflected,
    kTransmitted,
    kLight,  ///< shadow rays toward one light
    kOther,  ///< shadow rays on their way through transparent surfaces toward lights without a flat tree
  };
  enum class Tree : std::uint8_t {
    kNoTree,
    kFlat,  ///< over directions only, fas::HyperTree
    kDeep,  ///< over origins and directions, fas::BeamTree
  };
  Rays rays = Rays::kEye;
  Tree tree = Tree::kNoTree;
  std::uint32_t light = 0;       ///< kLight: its number
  fas::TreeCounts in_tree;       ///< `rays`: queries that the tree answered
  HierarchyCounts in_hierarchy;  ///< all others of the class

  std::uint64_t queries() const { return in_tree.rays + in_hierarchy.rays; }
  /// Queries that the tree could not place or had no memory for, and those that it was not asked about
  /// because the hierarchy was found to be faster.
  std::uint64_t left_by_place() const { return in_tree.elsewhere; }
  std::uint64_t left_by_choice() const { return in_hierarchy.rays - in_tree.elsewhere; }
  /// Counts only: the rest says for which class.
  void add(const ClassReport& o) {
    in_tree.add(o.in_tree);
    in_hierarchy.add(o.in_hierarchy);
  }
};

struct IntersectorReport {
  enum class Method : std::uint8_t { kUnknown, kBruteForce, kPacks, kHierarchy, kTrees };
  Method method = Method::kUnknown;
  std::vector<ClassReport> classes;  ///< kTrees only
  // Of the trees' memory, in bytes, the largest of all frames:
  std::uint64_t pool_used = 0;  ///< in chunks that trees use
  std::uint64_t pool_held = 0;  ///< of the system, in use or kept for later
  std::uint64_t pool_budget = 0;
  bool pool_exhausted = false;  ///< trees had to stop growing
};

}  // namespace rayshade
