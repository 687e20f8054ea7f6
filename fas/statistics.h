// SPDX-License-Identifier: MIT
// What was done for one class of rays. Counted per thread, added up by whoever asks.
#pragma once

#include <cstdint>

namespace fas {

struct TreeCounts {
  std::uint64_t rays = 0;         ///< queries that the tree answered
  std::uint64_t elsewhere = 0;    ///< queries left to the hierarchy: no memory, or a node in the making
  std::uint64_t outside = 0;      ///< of `rays`: those that nothing is in the way of, known without a leaf
  std::uint64_t cached_leaf = 0;  ///< of `rays`: those in the same leaf as the thread's last
  std::uint64_t cached_hit = 0;   ///< occlusion queries answered by the thread's last occluder of the leaf
  std::uint64_t blocks = 0;       ///< blocks of candidates looked at
  std::uint64_t tests = 0;        ///< exact tests
  std::uint64_t hits = 0;
  std::uint64_t nodes = 0;       ///< made
  std::uint64_t leaves = 0;      ///< made, those split later included
  std::uint64_t candidates = 0;  ///< in leaves made
  std::uint64_t splits = 0;      ///< of leaves that were in use
  std::uint64_t truncated = 0;   ///< candidates left out behind something that covers a cell
  std::uint64_t bytes = 0;
  std::uint64_t nanoseconds = 0;  ///< building

  void add(const TreeCounts& o) {
    rays += o.rays;
    elsewhere += o.elsewhere;
    outside += o.outside;
    cached_leaf += o.cached_leaf;
    cached_hit += o.cached_hit;
    blocks += o.blocks;
    tests += o.tests;
    hits += o.hits;
    nodes += o.nodes;
    leaves += o.leaves;
    candidates += o.candidates;
    splits += o.splits;
    truncated += o.truncated;
    bytes += o.bytes;
    nanoseconds += o.nanoseconds;
  }
};

}  // namespace fas
