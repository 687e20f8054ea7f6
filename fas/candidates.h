// SPDX-License-Identifier: MIT
// Candidate sets as the trees see them: primitives, and parts of a hierarchy that can be opened.
#pragma once

#include <cstdint>

#include "fas/fas.h"

namespace fas {

/// The primitives of one structure, and the hierarchy over them as something that is opened step by step.
/// Thread-safe for any number of readers; must outlive every tree that is grown from it.
class Candidates {
 public:
  /// An entry of a candidate set is a primitive, or a subtree of the hierarchy (with this bit).
  static constexpr std::uint32_t kSubtree = 0x80000000u;
  /// The whole hierarchy.
  static constexpr std::uint32_t kWhole = 0xffffffffu;
  static constexpr int kMostChildren = 16;

  struct Child {
    std::uint32_t entry = 0;
    std::uint32_t below = 1;  ///< primitives in it
    Bounds box;               ///< of subtrees; primitives are asked for their geometry
  };

  virtual ~Candidates() = default;
  virtual std::uint32_t count() const = 0;
  virtual Bounds bounds() const = 0;
  /// Fills `out`; its vector is reused.
  virtual void geometry(std::uint32_t primitive, Geometry& out) const = 0;
  /// The parts of a subtree (or of kWhole); returns how many.
  virtual int open(std::uint32_t subtree, Child (&out)[kMostChildren]) const = 0;
};

}  // namespace fas
