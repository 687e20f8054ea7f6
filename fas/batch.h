// SPDX-License-Identifier: MIT
// Many rays of one class at once: sorted by leaf, and within a leaf tested candidate by candidate, each
// against all its rays together. A leaf's candidates are then loaded once, and the caller may test a
// primitive against many rays with vector code. The answers are those of single rays, since the same tests
// decide.
#pragma once

#include <array>
#include <bit>
#include <cstring>
#include <vector>

#include "fas/tree.h"

namespace fas {

/// Queries of a span, by leaf. Reused from span to span.
class LeafGroups {
 public:
  static constexpr std::uint32_t kEnd = 0xffffffffu;
  struct Group {
    HyperTree* tree;
    const Leaf* leaf;
    HyperTree::Query any;              ///< one of its queries, for the tuner
    std::uint32_t first, last, count;  ///< a chain through next()
    std::uint32_t slot;                ///< in the table; kEnd: not there
  };

  void clear() {
    for (const Group& group : groups_) {
      if (group.slot != kEnd) table_[group.slot] = 0;
    }
    groups_.clear();
    latest_ = nullptr;
  }
  /// `place` numbers the query, below `most`.
  void add(HyperTree& tree, const Leaf* leaf, const HyperTree::Query& query, std::uint32_t place,
           std::uint32_t most) {
    if (next_.size() < most) next_.resize(most);
    next_[place] = kEnd;
    std::uint32_t index = 0;
    if (leaf == latest_) {
      index = latest_group_;
    } else {
      auto hash =
          static_cast<std::size_t>((reinterpret_cast<std::uintptr_t>(leaf) >> 4) * 0x9e3779b97f4a7c15u >> 52);
      for (;; hash = (hash + 1) % table_.size()) {
        if (table_[hash] == 0) {
          if (groups_.size() >= kMostGroups) return add_overflow(tree, leaf, query, place);
          groups_.push_back({&tree, leaf, query, place, place, 0, static_cast<std::uint32_t>(hash)});
          table_[hash] = static_cast<std::uint16_t>(groups_.size());
          break;
        }
        if (groups_[table_[hash] - 1u].leaf == leaf) break;
      }
      index = table_[hash] - 1u;
      latest_ = leaf;
      latest_group_ = index;
    }
    Group& group = groups_[index];
    if (group.count++ > 0) {
      next_[group.last] = place;
      group.last = place;
    }
  }
  const std::vector<Group>& groups() const { return groups_; }
  std::uint32_t next(std::uint32_t place) const { return next_[place]; }

 private:
  static constexpr std::size_t kMostGroups = 2048;
  void add_overflow(HyperTree& tree, const Leaf* leaf, const HyperTree::Query& query, std::uint32_t place) {
    groups_.push_back({&tree, leaf, query, place, place, 1, kEnd});
    latest_ = nullptr;
  }
  std::vector<Group> groups_;
  std::vector<std::uint32_t> next_;
  std::array<std::uint16_t, 4096> table_{};
  const Leaf* latest_ = nullptr;
  std::uint32_t latest_group_ = 0;
};

/// Up to 64 rays within one leaf, as its candidates see them.
struct GroupProbe {
  static constexpr int kMost = 64;
  alignas(64) std::uint8_t u[kMost], v[kMost], z[kMost];
  int count = 0;
};

/// Nearest hits of a group of rays from the apex. `test(primitive, mask)` tests a primitive against the rays
/// of the mask and returns those for which it became the nearest hit; `depth(i)`: the depth up to which ray i
/// is of interest now.
template <class Test, class Depth>
void nearest_in_group(HyperTree& tree, ThreadState& state, const Leaf& leaf, const HyperTree::Query& any,
                      GroupProbe& rays, const Test& test, const Depth& depth) {
  TreeCache& cache = state.cache(tree.number());
  const Kernels& simd = kernels();
  const bool cuts = leaf.cuts != 0;
  std::uint8_t farthest = 0;
  for (int i = 0; i < rays.count; ++i) {
    rays.z[i] = tree.quantised(leaf, depth(i));
    farthest = std::max(farthest, rays.z[i]);
  }
  std::uint64_t hit = 0;
  int tests = 0, hits = 0, looked_at = 0;
  const std::uint8_t* block = leaf.blocks();
  for (std::uint32_t left = leaf.count; left > 0;) {
    const std::size_t n = std::min<std::uint32_t>(left, Block::kMost), s = Block::stride(n),
                      bytes = Block::bytes(n, cuts);
    if (block[4 * s] > farthest) break;
    const auto* ids = reinterpret_cast<const std::uint32_t*>(block + bytes - Block::kIdBytes * s);
    for (std::size_t i = 0; i < n; ++i) {
      if (block[4 * s + i] > farthest) break;
      ++looked_at;
      const std::uint64_t mask = simd.match_rays(block, s, i, cuts, rays.u, rays.v, rays.z, rays.count);
      if (mask == 0) continue;
      tests += std::popcount(mask);
      const std::uint64_t better = test(ids[i], mask);
      if (better == 0) continue;
      hit |= better;
      for (std::uint64_t todo = better; todo != 0; todo &= todo - 1) {
        const int k = std::countr_zero(todo);
        rays.z[k] = tree.quantised(leaf, depth(k));
      }
      farthest = 0;
      for (int k = 0; k < rays.count; ++k) farthest = std::max(farthest, rays.z[k]);
    }
    block += bytes;
    left -= static_cast<std::uint32_t>(n);
  }
  hits = std::popcount(hit);
  cache.counts.rays += static_cast<std::uint64_t>(rays.count);
  cache.counts.blocks += static_cast<std::uint64_t>(looked_at);
  cache.counts.tests += static_cast<std::uint64_t>(tests);
  cache.counts.hits += static_cast<std::uint64_t>(hits);
  tree.charge(any, state, cache, leaf, std::max(0, tests - hits), looked_at);
}

/// Which rays of a group toward the apex (or along a parallel view) are stopped. `depths[i]`: where ray i
/// starts. `test(primitive, mask)` tests a primitive against the rays of the mask and returns those that need
/// no further tests; that may be none, to whom everything between start and apex is shown.
template <class Test>
std::uint64_t occluded_in_group(HyperTree& tree, ThreadState& state, const Leaf& leaf,
                                const HyperTree::Query& any, GroupProbe& rays, const double* depths,
                                const Test& test) {
  TreeCache& cache = state.cache(tree.number());
  const Kernels& simd = kernels();
  const bool cuts = leaf.cuts != 0;
  std::uint64_t open = rays.count == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << rays.count) - 1;
  const std::uint64_t all = open;
  std::uint8_t farthest = 0;
  for (int i = 0; i < rays.count; ++i) {
    rays.z[i] = tree.quantised(leaf, depths[i]);
    farthest = std::max(farthest, rays.z[i]);
    if (tree.behind(leaf, depths[i])) open &= ~(std::uint64_t{1} << i);
  }
  const std::uint64_t reachable = open;
  int tests = 0, looked_at = 0;
  const std::uint8_t* block = leaf.blocks();
  for (std::uint32_t left = leaf.count; left > 0 && open != 0;) {
    const std::size_t n = std::min<std::uint32_t>(left, Block::kMost), s = Block::stride(n),
                      bytes = Block::bytes(n, cuts);
    if (block[4 * s] > farthest) break;
    const auto* ids = reinterpret_cast<const std::uint32_t*>(block + bytes - Block::kIdBytes * s);
    for (std::size_t i = 0; i < n && open != 0; ++i) {
      if (block[4 * s + i] > farthest) break;
      ++looked_at;
      const std::uint64_t mask =
          open & simd.match_rays(block, s, i, cuts, rays.u, rays.v, rays.z, rays.count);
      if (mask == 0) continue;
      tests += std::popcount(mask);
      open &= ~test(ids[i], mask);
    }
    block += bytes;
    left -= static_cast<std::uint32_t>(n);
  }
  const std::uint64_t stopped = reachable & ~open;
  const int hits = std::popcount(stopped);
  cache.counts.rays += static_cast<std::uint64_t>(std::popcount(all));
  cache.counts.blocks += static_cast<std::uint64_t>(looked_at);
  cache.counts.tests += static_cast<std::uint64_t>(tests);
  cache.counts.hits += static_cast<std::uint64_t>(hits);
  tree.charge(any, state, cache, leaf, tests - hits, looked_at);
  return stopped;
}

/// Nearest hits of a group of rays toward the apex (or along a parallel view), which begin at `depths`.
/// Candidates stand by their depth from the apex, so that nothing is known to lie behind a hit: all that a
/// ray may meet are tested, in any order. `test` as for nearest_in_group().
template <class Test>
void nearest_toward_in_group(HyperTree& tree, ThreadState& state, const Leaf& leaf,
                             const HyperTree::Query& any, GroupProbe& rays, const double* depths,
                             const Test& test) {
  std::uint64_t hit = 0;
  occluded_in_group(tree, state, leaf, any, rays, depths, [&](std::uint32_t primitive, std::uint64_t mask) {
    hit |= test(primitive, mask);
    return std::uint64_t{0};
  });
  state.cache(tree.number()).counts.hits += static_cast<std::uint64_t>(std::popcount(hit));
}

}  // namespace fas
