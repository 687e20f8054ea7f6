// SPDX-License-Identifier: MIT
// The bounded leaves of a group as the hyper-trees see them: convex hulls and subtrees of the group's
// hierarchy.
#pragma once

#include "fas/hierarchy_candidates.h"
#include "rayshade/geometry/compiled_scene.h"

namespace rayshade {

class TreeCandidates final : public fas::HierarchyCandidates {
 public:
  /// `group` must have a hierarchy. Candidates are leaf numbers less the group's first bounded leaf.
  TreeCandidates(const CompiledScene& scene, std::uint32_t group);

  void geometry(std::uint32_t primitive, fas::Geometry& out) const override;

 private:
  const CompiledScene& scene_;
  LeafId first_;
};

}  // namespace rayshade
