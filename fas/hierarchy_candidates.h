// SPDX-License-Identifier: MIT
// A hierarchy as candidate sets of the hyper-trees: cuts through it, opened step by step.
#pragma once

#include <vector>

#include "fas/candidates.h"
#include "fas/hierarchy.h"

namespace fas {

/// All but the geometry of the primitives, which are numbered by their places in the hierarchy.
class HierarchyCandidates : public Candidates {
 public:
  /// `hierarchy` is over `count` primitives, at least one, and must outlive this.
  HierarchyCandidates(const Hierarchy& hierarchy, std::uint32_t count);

  std::uint32_t count() const override { return count_; }
  Bounds bounds() const override { return hierarchy_.bounds(); }
  int open(std::uint32_t subtree, Child (&out)[kMostChildren]) const override;

 private:
  const Hierarchy& hierarchy_;
  std::uint32_t count_;
  std::vector<std::uint32_t> below_;  ///< primitives below each node
};

}  // namespace fas
