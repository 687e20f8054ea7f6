// SPDX-License-Identifier: MIT
// Tree or hierarchy: decided for each class of rays, by the clock, while they are traced. Only speed depends
// on it.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace fas {

/// Whether the rays of a class go through its tree or through the hierarchy alone. The tree is tried first;
/// of some groups of rays one half goes through the hierarchy, both timed: rays side by side cost alike. What
/// has been built so far is expected to grow with the square root of the rays, up to as many as are expected.
/// If the tree then costs more than the hierarchy, it is left alone for a while, longer from time to time.
class Choice {
 public:
  enum class Way : std::uint8_t { kTree, kHierarchy, kBoth };
  /// Smaller groups are not worth a comparison.
  static constexpr std::size_t kFewest = 32;

  /// `rays`: how many of this class are expected. Where they are not many more than the primitives, the tree
  /// is not tried before as many have come.
  Choice(double rays, double primitives) : expected_(std::max(rays, 1.0)) {
    if (rays >= kRaysPerPrimitive * primitives) return;
    tree_mode_ = false;
    again_ = static_cast<std::uint64_t>(std::min(kRaysPerPrimitive * primitives, 1e18));
  }

  /// For the next group, of so many rays.
  Way next(std::size_t rays) {
    const std::uint64_t seen = add(seen_, rays);
    if (!tree_mode_.load(std::memory_order_relaxed)) {
      if (seen < again_.load(std::memory_order_relaxed)) return Way::kHierarchy;
      tree_mode_.store(true, std::memory_order_relaxed);
    }
    if (rays < kFewest) return Way::kTree;
    const std::uint32_t every = compared_.load(std::memory_order_relaxed) < 4 * kTrial ? 8 : 32;
    return turn_.fetch_add(1, std::memory_order_relaxed) % every == 0 ? Way::kBoth : Way::kTree;
  }

  /// After rays went through the tree, `ns` of which it took to make nodes.
  void built(std::size_t rays, std::uint64_t ns) {
    add(all_tree_rays_, rays);
    add(building_, ns);
    const std::uint64_t n = add(tree_rays_, rays);
    if (n < kWindow) return;
    building_per_ray_.store(
        static_cast<double>(building_.load(std::memory_order_relaxed)) / static_cast<double>(n),
        std::memory_order_relaxed);
    tree_rays_.store(0, std::memory_order_relaxed);
    building_.store(0, std::memory_order_relaxed);
  }
  /// Whether the hierarchy comes first in the next comparison: whoever does finds the caches cold.
  bool hierarchy_first() const { return turn_.load(std::memory_order_relaxed) / 8 % 2 != 0; }
  /// After a comparison of so many rays on either side: nanoseconds, and those of them to make nodes. Groups
  /// that made many tell little of what the tree is like when it is there.
  void compared(std::size_t rays, double tree, double hierarchy, double building_now) {
    add(all_, rays);
    add(all_hierarchy_ns_, static_cast<std::uint64_t>(hierarchy));
    if (building_now < 0.1 * tree) {
      add(compared_, rays);
      add(tree_ns_, static_cast<std::uint64_t>(tree - building_now));
      add(hierarchy_ns_, static_cast<std::uint64_t>(hierarchy));
    }
    const auto share = [](const std::atomic<std::uint64_t>& a, const std::atomic<std::uint64_t>& b) {
      return static_cast<double>(a.load(std::memory_order_relaxed)) /
             static_cast<double>(std::max<std::uint64_t>(b.load(std::memory_order_relaxed), 1));
    };
    const double growth = std::sqrt(
        std::min(1.0, static_cast<double>(all_tree_rays_.load(std::memory_order_relaxed)) / expected_));
    const double latest = building_per_ray_.load(std::memory_order_relaxed);
    const double plain = share(all_hierarchy_ns_, all_),
                 made = growth * (latest >= 0 ? latest : share(building_, tree_rays_));
    const bool hopeless = made > 3 * plain;
    if (!hopeless && all_.load(std::memory_order_relaxed) < kTrial) return;
    const bool quiet = compared_.load(std::memory_order_relaxed) >= kTrial;
    const double ratio = quiet ? share(tree_ns_, hierarchy_ns_) : kGuess;
    if (!hopeless && ratio * plain + made <= (1.5 - 0.5 * growth) * plain) return;
    const std::uint64_t pause = pause_.load(std::memory_order_relaxed);
    again_.store(seen_.load(std::memory_order_relaxed) + pause, std::memory_order_relaxed);
    pause_.store(4 * pause, std::memory_order_relaxed);
    for (std::atomic<std::uint64_t>* sum : {&compared_, &tree_ns_, &hierarchy_ns_, &tree_rays_, &building_,
                                            &all_tree_rays_, &all_, &all_hierarchy_ns_})
      sum->store(0, std::memory_order_relaxed);
    building_per_ray_.store(-1, std::memory_order_relaxed);
    tree_mode_.store(false, std::memory_order_relaxed);
  }

 private:
  static std::uint64_t add(std::atomic<std::uint64_t>& sum, std::uint64_t n) {
    return sum.fetch_add(n, std::memory_order_relaxed) + n;
  }
  static constexpr double kRaysPerPrimitive = 6;
  /// Rays compared before the first judgement.
  static constexpr std::uint64_t kTrial = 1024;
  /// Rays through the tree over which the cost of building is averaged: what has been paid is paid.
  static constexpr std::uint64_t kWindow = 8192;
  /// Time through a tree by that through the hierarchy, as long as nothing better is known.
  static constexpr double kGuess = 0.7;
  double expected_;
  std::atomic<bool> tree_mode_{true};
  std::atomic<double> building_per_ray_{-1};  ///< of the latest window
  std::atomic<std::uint32_t> turn_{0};
  std::atomic<std::uint64_t> compared_{0}, tree_ns_{0}, hierarchy_ns_{0}, tree_rays_{0}, building_{0},
      all_tree_rays_{0}, all_{0}, all_hierarchy_ns_{0};
  std::atomic<std::uint64_t> seen_{0}, again_{0}, pause_{std::uint64_t{1} << 16};
};

/// Asks for a group of rays, numbered `which`, in the way that `choice` says. `tree(some)` answers some of
/// them through the tree and returns the nanoseconds that it took to make nodes, `hierarchy(some)` through
/// the hierarchy. `halves` is room for numbers.
template <class Tree, class Plain>
void ask_by_choice(Choice& choice, std::span<const std::uint32_t> which,
                   std::vector<std::uint32_t> (&halves)[2], const Tree& tree, const Plain& hierarchy) {
  switch (choice.next(which.size())) {
    case Choice::Way::kHierarchy:
      hierarchy(which);
      return;
    case Choice::Way::kTree:
      choice.built(which.size(), tree(which));
      return;
    case Choice::Way::kBoth:
      break;
  }
  for (std::vector<std::uint32_t>& places : halves) places.clear();
  for (std::size_t i = 0; i < which.size(); ++i) halves[i % 2].push_back(which[i]);
  using Clock = std::chrono::steady_clock;
  std::uint64_t building = 0;
  double tree_ns = 0, hierarchy_ns = 0;
  const bool hierarchy_first = choice.hierarchy_first();
  for (const bool through_tree : {!hierarchy_first, hierarchy_first}) {
    const Clock::time_point start = Clock::now();
    if (through_tree)
      building = tree(std::span<const std::uint32_t>(halves[0]));
    else
      hierarchy(std::span<const std::uint32_t>(halves[1]));
    (through_tree ? tree_ns : hierarchy_ns) =
        std::chrono::duration<double, std::nano>(Clock::now() - start).count();
  }
  choice.built(halves[0].size(), building);
  choice.compared(halves[1].size(), tree_ns, hierarchy_ns, static_cast<double>(building));
}

}  // namespace fas
