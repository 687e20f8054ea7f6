// SPDX-License-Identifier: MIT
// What one thread owns: its arena, and what it remembers of every tree.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "fas/pool.h"
#include "fas/statistics.h"

namespace fas {

/// Of a HyperTree: the latest leaf, the square that it stands for, and who occluded a ray there last.
struct TreeCache {
  const struct Leaf* leaf = nullptr;
  std::uint32_t u = 0, v = 0;
  int shift = 0, face = -1;
  std::uint32_t occluder = 0xffffffffu;  ///< of `leaf`
  TreeCounts counts;
};

/// Of a BeamTree: the latest leaf and the cell that it stands for.
struct BeamCache {
  const struct BeamLeaf* leaf = nullptr;
  int face = -1;
  std::array<std::uint32_t, 5> at{};
  std::array<std::uint8_t, 5> shift{};
  TreeCounts counts;
};

/// A tree's cache is found by its number; trees of the two kinds are numbered apart.
struct ThreadState {
  explicit ThreadState(Pool& pool);
  ~ThreadState();
  TreeCache& cache(std::size_t tree) {
    if (tree >= caches.size()) caches.resize(tree + 1);
    return caches[tree];
  }
  BeamCache& beam_cache(std::size_t tree) {
    if (tree >= beam_caches.size()) beam_caches.resize(tree + 1);
    return beam_caches[tree];
  }
  /// Queries of this thread that trees have answered.
  std::uint64_t rays() const {
    std::uint64_t sum = 0;
    for (const TreeCache& cache : caches) sum += cache.counts.rays;
    for (const BeamCache& cache : beam_caches) sum += cache.counts.rays;
    return sum;
  }
  Arena arena;
  std::vector<TreeCache> caches;
  std::vector<BeamCache> beam_caches;
  std::unique_ptr<struct TreeScratch> scratch;  ///< of whoever makes nodes
};

}  // namespace fas
