// SPDX-License-Identifier: MIT
// Constructive solid geometry for many rays at once: the steps of csg.cpp, where every search of an operand
// is one of all the rays that need it, by vector tests. Gives what those steps give ray by ray, to the bit.
#pragma once

#include <memory>
#include <vector>

#include "rayshade/geometry/pack_counter.h"

namespace rayshade {

/// Sets Csg::in_packs: of those whose operands stand still, have vector tests, and are few enough to be
/// tested one and all.
void choose_csg_for_packs(CompiledScene& scene);

/// The latest hits with an operand. The limit `lo` of a ray is that with which they were found.
struct CsgSide {
  RayPack pack;
  RayPack::Mask found;
};

/// One object within the others.
struct CsgLevel {
  CsgSide sides[2];
  std::size_t load = 0;  ///< number of that whose rays its packs have
  // The result:
  RayPack::Mask hit;
  RayPack::Mask second;  ///< it is the hit of sides[1]
  RayPack::Mask entering;
};

/// What a thread keeps for the packs to come.
struct CsgRoom {
  std::vector<std::unique_ptr<CsgLevel>> levels;
  std::size_t loads = 0;
};

class CsgPack {
 public:
  CsgPack(const CompiledScene& scene, TraceScratch& scratch, PackCounter& counter)
      : scene_(scene), scratch_(scratch), counter_(counter) {}

  /// For new rays, all of unit direction as far as the renderer knows (Ray::unit).
  void load(RayPack& rays) {
    rays_ = &rays;
    load_ = 0;
  }
  /// Tests a CSG leaf (of the world, Csg::in_packs) against rays of those loaded, as improve_pack()
  /// does.
  RayPack::Mask improve(const Leaf& leaf, RayPack& pack, RayPack::Mask mask) {
    return improve(leaf, pack, mask, 0);
  }
  /// Which rays of `mask` it stops between lo and t.
  RayPack::Mask occlude(const Leaf& leaf, const RayPack& pack, RayPack::Mask mask);

 private:
  struct State;

  RayPack::Mask improve(const Leaf& leaf, RayPack& pack, RayPack::Mask mask, std::size_t depth);
  CsgLevel& level(std::size_t depth);
  const CsgLevel& run(const Csg& csg, const RayPack& pack, RayPack::Mask mask, std::size_t depth);
  void search(CsgSide& side, const Group& group, RayPack::Mask mask, std::size_t depth);
  RayPack::Mask test_leaves(LeafId first, LeafId last, RayPack& pack, RayPack::Mask mask, std::size_t depth);
  bool enters(const RayPack& hits, std::size_t ray) const;
  double beyond(const Csg& csg, std::size_t ray, double t) const;

  const CompiledScene& scene_;
  TraceScratch& scratch_;
  PackCounter& counter_;
  RayPack* rays_ = nullptr;
  std::size_t load_ = 0;  ///< its number in the room; 0: not there yet
};

}  // namespace rayshade
