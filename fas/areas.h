// SPDX-License-Identifier: MIT
// What the faces of flat hyper-trees see of primitives. Every level of a tree asks for it again, and
// projecting a primitive costs more than all else that is done with it there; but what is asked for again is
// asked for soon, by cells near each other. So every thread remembers the latest, and trees hold none:
// their memory is that of the cells that rays go through, not of the scene.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>

namespace fas {

/// A candidate's area in the units of a root square.
struct Area {
  double x0, x1, y0, y1;
  double z0, z1;  ///< depths
  std::uint32_t id = 0;
  std::uint8_t cuts = 0;
  bool covers = false;
  double cut[3][3];  ///< a x + b y + c >= 0 everywhere in the area
  double inside[3];  ///< of covers: see Footprint
};

/// Of one thread.
class AreaCache {
 public:
  /// The area of a primitive on a face, as `project(area)` finds it, which returns false where the face does
  /// not see the primitive; then null. `face` is a number of its own for every face of every tree. Valid
  /// until the next call.
  template <class Project>
  const Area* find(std::uint32_t face, std::uint32_t primitive, const Project& project) {
    if (!slots_) slots_ = std::make_unique<Slots>();
    // Neighbours by number are neighbours in space, and asked for together.
    Slot& slot = (*slots_)[(primitive + face * kStep) % kSlots];
    const std::uint64_t key = std::uint64_t{face} << 32 | primitive;
    if (slot.key != key) {
      slot.key = kNobody;  // in case that project() throws
      slot.seen = project(slot.area);
      slot.key = key;
    }
    return slot.seen ? &slot.area : nullptr;
  }

 private:
  static constexpr std::size_t kSlots = 4096;
  static constexpr std::uint32_t kStep = 691;  ///< faces of one scene seldom drive each other out
  static constexpr std::uint64_t kNobody = std::numeric_limits<std::uint64_t>::max();
  struct Slot {
    std::uint64_t key = kNobody;
    bool seen;
    Area area;
  };
  using Slots = std::array<Slot, kSlots>;
  std::unique_ptr<Slots> slots_;  ///< none before a node is made
};

}  // namespace fas
