// SPDX-License-Identifier: MIT
// The candidates of a cell, quantised into the blocks of its leaf (fas/tree.h says how they lie there).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "fas/part.h"
#include "fas/tree.h"

namespace fas {

struct LeafForm {
  bool cuts = false;   ///< with half-planes
  bool final = false;  ///< will not be split
  int depth = 0;       ///< of the cell
};

/// What a leaf of so many candidates takes.
std::size_t leaf_bytes(std::uint32_t candidates, bool cuts);

/// Makes a leaf in `memory`, of leaf_bytes() and aligned to 16, of the areas that are its cell's, in this
/// order: nearest first.
void write_leaf(std::byte* memory, std::span<const Area> areas, std::span<const std::uint32_t> order,
                const Part& part, const LeafForm& form);

}  // namespace fas
