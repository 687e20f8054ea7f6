// SPDX-License-Identifier: MIT
// The bounded leaves of a group as the hyper-trees see them: convex hulls and subtrees of the group's
// hierarchy.
#pragma once

#include <vector>

#include "fas/geometry.h"
#include "rayshade/geometry/compiled_scene.h"

namespace rayshade {

class TreeCandidates final : public fas::Candidates {
 public:
  /// `group` must have a hierarchy. Candidates are leaf numbers less the group's first bounded leaf.
  TreeCandidates(const CompiledScene& scene, std::uint32_t group);

  std::uint32_t count() const override;
  fas::Bounds bounds() const override;
  void geometry(std::uint32_t primitive, fas::Geometry& out) const override;
  int open(std::uint32_t subtree, Child (&out)[kMostChildren]) const override;

 private:
  const CompiledScene& scene_;
  const Group& group_;
  LeafId first_;
  std::vector<std::uint32_t> below_;  ///< leaves below each node of the hierarchy
};

}  // namespace rayshade
