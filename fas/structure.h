// SPDX-License-Identifier: MIT
// What is behind Structure and Tracer.
#pragma once

#include <memory>
#include <vector>

#include "fas/batch.h"
#include "fas/beam_tree.h"
#include "fas/choice.h"
#include "fas/fas.h"
#include "fas/hierarchy_candidates.h"

namespace fas {

struct Structure::Parts {
  /// A class has one tree at most: none where there is no hierarchy.
  struct Class {
    enum class Kind : std::uint8_t { kFromPoint, kToward, kFromBox, kTowardBox, kAny };
    Kind kind = Kind::kAny;
    View view;       ///< flat ones
    Bounds origins;  ///< others
    std::unique_ptr<HyperTree> flat;
    std::unique_ptr<BeamTree> beams;
    std::unique_ptr<Choice> choice;
    bool is_flat() const { return kind == Kind::kFromPoint || kind == Kind::kToward; }
  };
  /// The bounded primitives, by their places in the hierarchy.
  class Bounded;

  const Primitives& primitives;
  Options options;
  std::vector<std::uint32_t> order;  ///< which primitive is at a place of the hierarchy
  std::vector<std::uint32_t> unbounded;
  std::unique_ptr<Hierarchy> hierarchy;  ///< null: nothing is bounded
  std::unique_ptr<HierarchyCandidates> candidates;
  Pool pool;
  Tuner tuner;
  std::vector<Class> classes;

  Parts(const Primitives& p, const Options& o);
  RayClass add(Class rays);
  void plant(Class& rays, std::uint32_t number);
};

}  // namespace fas
