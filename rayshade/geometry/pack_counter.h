// SPDX-License-Identifier: MIT
// Counts what is tested for the rays of a pack, for every ray and by kind of leaf.
#pragma once

#include <array>
#include <bit>

#include "rayshade/geometry/ray_pack.h"
#include "rayshade/geometry/trace_context.h"

namespace rayshade {

class PackCounter {
 public:
  explicit PackCounter(TraceContext& context) : context_(context) {}

  /// For a new pack of so many rays.
  void reset(int rays) {
    rays_ = static_cast<std::size_t>(rays);
    tests_.fill(0);
    bounds_tests_.fill(0);
  }
  /// A test of a box or of a block of candidates for every ray of the mask.
  void add_bounds(RayPack::Mask mask) {
    add_one(bounds_tests_, mask);
    context_.bounds_tests += static_cast<std::uint32_t>(std::popcount(mask));
  }
  /// A test of a leaf; of CSG, the operands count themselves.
  void add_tests(const Leaf& leaf, RayPack::Mask tested, RayPack::Mask hit) {
    if (leaf.kind != LeafKind::kCsg) add_one(tests_, tested);
    TraceCounts& counts = context_.scratch.counts;
    const auto kind = static_cast<std::size_t>(leaf.kind);
    counts.tests[kind] += static_cast<std::uint64_t>(std::popcount(tested));
    counts.hits[kind] += static_cast<std::uint64_t>(std::popcount(hit));
  }
  /// What one ray was tested with on its own, beside the pack.
  void add_to_ray(std::size_t ray, std::uint32_t tests, std::uint32_t bounds_tests) {
    tests_[ray] += tests;
    bounds_tests_[ray] += bounds_tests;
  }
  std::uint32_t tests(std::size_t ray) const { return tests_[ray]; }
  std::uint32_t bounds_tests(std::size_t ray) const { return bounds_tests_[ray]; }

 private:
  using Counts = std::array<std::uint32_t, RayPack::kMost>;

  void add_one(Counts& counts, RayPack::Mask mask) const {
    for (std::size_t i = 0; i < rays_; ++i) counts[i] += static_cast<std::uint32_t>(mask >> i & 1);
  }

  TraceContext& context_;
  std::size_t rays_ = 0;
  Counts tests_{}, bounds_tests_{};
};

}  // namespace rayshade
