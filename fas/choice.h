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

/// Whether the rays of a class go through its tree or through the hierarchy alone. A tree is started where
/// what it may save of the rays still to come is worth more than to make it for all primitives. Of some
/// groups of rays one half then goes through the hierarchy, both timed: rays side by side cost alike. The
/// tree is left alone, for as many rays as have come by then, when the rays still to come would
/// cost more through it than through the hierarchy. What has been made by then is paid for either way; what
/// will be made is expected to grow with the square root of the rays.
class Choice {
 public:
  enum class Way : std::uint8_t { kTree, kHierarchy, kBoth };
  /// Smaller groups are not worth reading the clock.
  static constexpr std::size_t kFewest = 32;
  /// Nanoseconds to make a tree, by its primitives. An order of magnitude: what is far away is never opened,
  /// what is near is handed on again and again; measured from 0.2 to 2.5 times as much.
  static constexpr double kMakePrimitive = 1000;

  /// `rays`: how many of this class are expected. `making`: nanoseconds that making a tree may take, as far
  /// as it does not depend on how many rays come: primitives times kMakePrimitive, or 0 for trees that start
  /// with next to nothing.
  Choice(double rays, double making) : expected_(std::max(rays, 1.0)), making_(making) {}

  /// For the next group, of so many rays.
  Way next(std::size_t rays) {
    const std::uint64_t seen = add(seen_, rays);
    if (!tree_mode_.load(std::memory_order_relaxed)) {
      if (seen < again_.load(std::memory_order_relaxed) || !worth_starting()) return Way::kHierarchy;
      tree_mode_.store(true, std::memory_order_relaxed);
    }
    if (rays < kFewest) return Way::kTree;
    const std::uint64_t compared = compared_.load(std::memory_order_relaxed);
    const std::uint32_t every = compared < kTrial ? 2 : compared < 4 * kTrial ? 8 : 32;
    return turn_.fetch_add(1, std::memory_order_relaxed) % every == 0 ? Way::kBoth : Way::kTree;
  }

  /// After rays went through the tree, `ns` of which it took to make nodes.
  void built(std::size_t rays, std::uint64_t ns) {
    add(all_tree_rays_, rays);
    // What was expected to be made at first tells nothing of what will be made.
    const double beyond = static_cast<double>(add(all_building_, ns)) - making_;
    add(building_, beyond > 0 ? std::min(ns, static_cast<std::uint64_t>(beyond)) : 0);
    const std::uint64_t n = add(tree_rays_, rays);
    if (n < kWindow) return;
    building_per_ray_.store(
        static_cast<double>(building_.load(std::memory_order_relaxed)) / static_cast<double>(n),
        std::memory_order_relaxed);
    tree_rays_.store(0, std::memory_order_relaxed);
    building_.store(0, std::memory_order_relaxed);
  }
  /// After a group of at least kFewest rays went through the hierarchy, in so many nanoseconds.
  void plain(std::size_t rays, double ns) {
    add(plain_rays_, rays);
    add(plain_ns_, static_cast<std::uint64_t>(ns));
  }
  /// Whether the hierarchy comes first in the next comparison: whoever does finds the caches cold.
  bool hierarchy_first() const { return turn_.load(std::memory_order_relaxed) / 2 % 2 != 0; }
  /// After a comparison of so many rays on either side: nanoseconds, and those of them to make nodes.
  void compared(std::size_t rays, double tree, double hierarchy, double building_now) {
    plain(rays, hierarchy);
    const std::uint64_t compared = add(compared_, rays);
    add(tree_ns_, static_cast<std::uint64_t>(std::max(tree - building_now, 0.0)));
    add(hierarchy_ns_, static_cast<std::uint64_t>(hierarchy));
    const auto through_tree = static_cast<double>(all_tree_rays_.load(std::memory_order_relaxed));
    // In the beginning every group comes to new places, and what they take to be made tells too much.
    const bool early = through_tree < kEarly * expected_;
    const double making = early ? 0 : making_per_ray();
    if (making < 0 || compared < kTrial) return;
    // Few comparisons are of few places, and of caches that are still cold.
    const double doubt = compared < 4 * kTrial ? 1.1 : 1.02;
    if (share(tree_ns_, hierarchy_ns_) + making / plain_per_ray() > doubt) leave();
  }

 private:
  static std::uint64_t add(std::atomic<std::uint64_t>& sum, std::uint64_t n) {
    return sum.fetch_add(n, std::memory_order_relaxed) + n;
  }
  static double share(const std::atomic<std::uint64_t>& a, const std::atomic<std::uint64_t>& b) {
    return static_cast<double>(a.load(std::memory_order_relaxed)) /
           static_cast<double>(std::max<std::uint64_t>(b.load(std::memory_order_relaxed), 1));
  }
  /// Nanoseconds of a ray through the hierarchy.
  double plain_per_ray() const {
    return plain_rays_.load(std::memory_order_relaxed) > 0 ? std::max(share(plain_ns_, plain_rays_), 1.0)
                                                           : kTypical;
  }
  /// Rays still to come: where more came than were expected, as many again.
  double to_come() const {
    const auto seen = static_cast<double>(seen_.load(std::memory_order_relaxed));
    return seen < expected_ ? expected_ - seen : seen;
  }
  bool worth_starting() const { return to_come() * (1 - kGuess) * plain_per_ray() >= making_; }
  /// Nanoseconds a ray that making nodes will take, on average over the rays still to come; negative:
  /// unknown. With a cost of all nodes of c sqrt(n) at n rays, the latest ray takes c / (2 sqrt(n)).
  double making_per_ray() const {
    const double latest = building_per_ray_.load(std::memory_order_relaxed);
    const auto rays =
        static_cast<double>(std::max<std::uint64_t>(all_tree_rays_.load(std::memory_order_relaxed), 1));
    return latest * 2 / (1 + std::sqrt((rays + to_come()) / rays));
  }
  void leave() {
    const std::uint64_t seen = seen_.load(std::memory_order_relaxed);
    again_.store(seen + std::max<std::uint64_t>(kPause, seen), std::memory_order_relaxed);
    for (std::atomic<std::uint64_t>* sum :
         {&compared_, &tree_ns_, &hierarchy_ns_, &tree_rays_, &building_, &all_building_, &all_tree_rays_})
      sum->store(0, std::memory_order_relaxed);
    building_per_ray_.store(-1, std::memory_order_relaxed);
    tree_mode_.store(false, std::memory_order_relaxed);
  }

  /// Rays compared before the first judgement.
  static constexpr std::uint64_t kTrial = 1024;
  /// Rays through the tree over which the cost of building is averaged.
  static constexpr std::uint64_t kWindow = 4096;
  /// Share of the expected rays before which what it takes to make nodes is not judged.
  static constexpr double kEarly = 1.0 / 32;
  /// The shortest time, in rays, that a tree is left alone.
  static constexpr std::uint64_t kPause = 1 << 16;
  /// Time through a tree by that through the hierarchy, as long as nothing better is known.
  static constexpr double kGuess = 0.9;
  /// Nanoseconds of a ray through the hierarchy, as long as nothing better is known.
  static constexpr double kTypical = 80;
  double expected_, making_;
  std::atomic<bool> tree_mode_{false};
  std::atomic<double> building_per_ray_{-1};  ///< of the latest window
  std::atomic<std::uint32_t> turn_{0};
  std::atomic<std::uint64_t> compared_{0}, tree_ns_{0}, hierarchy_ns_{0}, tree_rays_{0}, building_{0},
      all_building_{0}, all_tree_rays_{0};
  std::atomic<std::uint64_t> plain_rays_{0}, plain_ns_{0}, seen_{0}, again_{0};
};

/// Asks for a group of rays, numbered `which`, in the way that `choice` says. `tree(some)` answers some of
/// them through the tree and returns the nanoseconds that it took to make nodes, `hierarchy(some)` through
/// the hierarchy. `halves` is room for numbers.
template <class Tree, class Plain>
void ask_by_choice(Choice& choice, std::span<const std::uint32_t> which,
                   std::vector<std::uint32_t> (&halves)[2], const Tree& tree, const Plain& hierarchy) {
  using Clock = std::chrono::steady_clock;
  switch (choice.next(which.size())) {
    case Choice::Way::kHierarchy:
      if (which.size() < Choice::kFewest) {
        hierarchy(which);
      } else {
        const Clock::time_point start = Clock::now();
        hierarchy(which);
        choice.plain(which.size(), std::chrono::duration<double, std::nano>(Clock::now() - start).count());
      }
      return;
    case Choice::Way::kTree:
      choice.built(which.size(), tree(which));
      return;
    case Choice::Way::kBoth:
      break;
  }
  for (std::vector<std::uint32_t>& places : halves) places.clear();
  for (std::size_t i = 0; i < which.size(); ++i) halves[i % 2].push_back(which[i]);
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
