// SPDX-License-Identifier: MIT
// What a RayTree keeps of rays, hits and lights while they are evaluated. Internal to its source files.
#pragma once

#include "rayshade/shading/ray_tree.h"

namespace rayshade {

/// Lights of one run of shadow queries; bounds what is pending for scenes with thousands of area cells.
inline constexpr std::size_t kQueriesPerRun = 4096;

inline bool is_black(const Color& c) { return c.r == 0 && c.g == 0 && c.b == 0; }

enum RaySlot : std::uint8_t { kTransmittedSlot = 0, kReflectedSlot = 1 };

/// A ray of the tree, from its birth until its colour has gone to its parent. Nodes are reused without being
/// cleared: each group of members is written before it is read.
struct RayTree::Node {
  // At birth:
  Ray ray;
  double lo;
  Color contribution;
  std::uint64_t path;
  std::uint32_t parent;
  std::uint32_t root;  ///< index of the eye sample
  std::uint32_t depth;
  RayKind kind;
  RaySlot slot;
  std::uint8_t children;  ///< bit per slot
  std::uint8_t waiting;
  // The media stack is a chain of the ancestors that pushed an entry; they outlive their descendants.
  std::uint32_t medium;  ///< node whose entry is on top; kNone: the stack is empty

  // If it entered a medium, the entry pushed by this ray:
  std::uint32_t medium_below;
  double medium_index, medium_extinction;

  // Known after its own hit was shaded:
  double distance;
  Vec3 end;
  Color color;
  // Per child that was spawned; child_color and child_distance when it is finished:
  Color factor[2];
  Color child_color[2];
  double child_distance;
  double child_extinction;
};

/// A hit being shaded.
struct RayTree::Shade {
  std::uint32_t node = 0;
  const Surface* surface = nullptr;  ///< the scene's own, or `textured`
  WorldHit world;
  Surface textured;
  Vec3 mirror;   ///< R
  double k = 0;  ///< -I.N
  RayStarts starts;
};

/// One light at one hit, waiting for its shadow.
struct RayTree::PendingLight {
  std::uint32_t shade;
  std::uint32_t light;
  double cosine;
  double highlight;  ///< R.L; to be combined: to its exponent
  Color color;       ///< before shadows; after them when answered
  bool blocked;
  bool skipped;     ///< has no effect; kept only for the observer
  bool highlights;  ///< there is a highlight, if the light arrives
};

/// Tells for whom the queries of a span are, as long as it lives.
template <class SampleOf>
class RayTree::Owners final : public QueryOwners {
 public:
  Owners(RayTree& tree, const SampleOf& sample_of) : tree_(tree), sample_of_(sample_of) {
    tree_.scratch_.owners = this;
  }
  ~Owners() override { tree_.scratch_.owners = nullptr; }
  Owners(const Owners&) = delete;
  Owners& operator=(const Owners&) = delete;
  RayOwner owner(std::size_t query) const override {
    const EyeSample& sample = tree_.samples_[sample_of_(query)];
    return {sample.x, sample.y, sample.sample};
  }

 private:
  RayTree& tree_;
  const SampleOf& sample_of_;
};

/// A shadow ray on its way through transparent surfaces (shading.md 5.3).
struct RayTree::Walk {
  std::uint32_t pending = 0;
  std::uint32_t query = 0;
  double near = 0;
  bool in_medium = false;
  double extinction = 1;
  int steps = 0;
  double least = 0;          ///< light of which all channels are below this is none
  bool opaque = false;       ///< something certainly opaque is in the way
  bool through_all = false;  ///< asks for all leaves, not just transparent ones
};

}  // namespace rayshade
