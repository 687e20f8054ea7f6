// SPDX-License-Identifier: MIT
#include "rayshade/render/object_numbers.h"

#include <algorithm>
#include <numeric>

namespace rayshade {

std::vector<std::uint32_t> object_numbers(const CompiledScene& scene) {
  std::vector<std::uint32_t> numbers(scene.leaves.size());
  std::vector<LeafId> in_order;
  for (const Group& group : scene.groups) {
    in_order.resize(group.count);
    std::iota(in_order.begin(), in_order.end(), group.first);
    // Orders within a group are distinct.
    std::sort(in_order.begin(), in_order.end(),
              [&](LeafId a, LeafId b) { return scene.leaves[a].order < scene.leaves[b].order; });
    for (std::uint32_t i = 0; i < group.count; ++i) numbers[in_order[i]] = group.first + i + 1;
  }
  return numbers;
}

}  // namespace rayshade
