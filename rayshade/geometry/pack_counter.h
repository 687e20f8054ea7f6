// SPDX-License-Identifier: MIT
// Counts what is tested for the rays of a pack, for every ray and by kind of leaf.
#pragma once

#include <array>
#include <bit>

#include "fas/bit_counts.h"
#include "rayshade/geometry/ray_pack.h"
#include "rayshade/geometry/trace_context.h"

namespace rayshade {

class PackCounter {
 public:
  explicit PackCounter(TraceContext& context) : context_(context) {}

  /// For a new pack of rays.
  void reset(const RayPack& pack) {
    rays_ = static_cast<std::size_t>(pack.count);
    all_ = pack.all();
    tests_.clear();
    bounds_tests_.clear();
  }
  /// A test of a box or of a block of candidates for every ray of the mask.
  void add_bounds(RayPack::Mask mask) { add_one(bounds_tests_, mask); }
  /// A test of a leaf; of CSG, the operands count themselves.
  void add_tests(const Leaf& leaf, RayPack::Mask tested, RayPack::Mask hit) {
    if (leaf.kind != LeafKind::kCsg) add_one(tests_, tested);
    TraceCounts& counts = context_.scratch.counts;
    const auto kind = static_cast<std::size_t>(leaf.kind);
    counts.tests[kind] += static_cast<std::uint64_t>(std::popcount(tested));
    counts.hits[kind] += static_cast<std::uint64_t>(std::popcount(hit));
  }
  /// Where others count tests of boxes.
  fas::BitCounts& bounds() { return bounds_tests_.of_some; }
  /// What one ray was tested with on its own, beside the pack.
  void add_to_ray(std::size_t ray, std::uint32_t tests, std::uint32_t bounds_tests) {
    tests_.of_ray[ray] += tests;
    bounds_tests_.of_ray[ray] += bounds_tests;
  }
  /// What every ray was tested with.
  struct Sums {
    std::array<std::uint32_t, RayPack::kMost> tests, bounds_tests;
  };
  /// Once, when all of them are counted.
  Sums finish() {
    context_.bounds_tests +=
        static_cast<std::uint32_t>(bounds_tests_.of_all * rays_ + bounds_tests_.of_some.total());
    return {tests_.sums(), bounds_tests_.sums()};
  }

 private:
  struct Counts {
    std::uint32_t of_all = 0;  ///< most tests are of all rays
    fas::BitCounts of_some;
    std::array<std::uint32_t, RayPack::kMost> of_ray{};

    void clear() {
      of_all = 0;
      of_some.clear();
      of_ray = {};
    }
    std::array<std::uint32_t, RayPack::kMost> sums() const {
      std::array<std::uint32_t, RayPack::kMost> out = of_ray;
      of_some.add_to(out);
      for (std::uint32_t& n : out) n += of_all;
      return out;
    }
  };

  void add_one(Counts& counts, RayPack::Mask mask) const {
    if (mask == all_)
      ++counts.of_all;
    else
      counts.of_some.add(mask);
  }

  TraceContext& context_;
  std::size_t rays_ = 0;
  RayPack::Mask all_ = 0;
  Counts tests_, bounds_tests_;
};

}  // namespace rayshade
