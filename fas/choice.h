// SPDX-License-Identifier: MIT
// Tree or hierarchy: decided for each class of rays, by the clock, while they are traced. Only speed depends
// on it.
#pragma once

#include <time.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace fas {

/// Whether the rays of a class go through its tree or through the hierarchy alone. A tree is started where
/// what it may save the rays still to come is worth more than to make it for all primitives. Some groups of
/// rays go through the hierarchy even then, whole ones, since rays are traced together; some of either kind
/// are timed, and groups one after the other cost alike on average. The tree is left alone, for three times
/// as many rays as have come by then, when the rays still to come would cost more through it than through the
/// hierarchy. What has been made by then is paid for either way; what will be made is expected to grow with
/// the square root of the rays, as told from all but the first of those that have come: where a tile of the
/// picture begins, hundreds of nodes are made for a few thousand rays, and then none for many.
class Choice {
 public:
  enum class Way : std::uint8_t { kTree, kHierarchy };
  /// What to do with a group: `timed` if the choice is to be told how long it took.
  struct Turn {
    Way way;
    bool timed;
  };
  /// Smaller groups are not worth reading the clock, which takes a microsecond.
  static constexpr std::size_t kFewest = 64;
  /// Nanoseconds to make a tree, by its primitives. An order of magnitude: what is far away is never opened,
  /// what is near is handed on again and again; measured from 0.2 to 2.5 times as much.
  static constexpr double kMakePrimitive = 1000;

  /// What a tree may save of the time of a ray through the hierarchy: `share` of it, as far as the ray makes
  /// more exact tests than `needed`. 0: whatever it makes, and before anything is known.
  struct Saving {
    double share;
    double needed;
  };

  /// `rays`: how many of this class are expected. `making`: nanoseconds that making a tree may take, as far
  /// as it does not depend on how many rays come: primitives times kMakePrimitive, or 0 for trees that start
  /// with next to nothing.
  Choice(double rays, double making, Saving saving)
      : expected_(std::max(rays, 1.0)), making_(making), saving_(saving) {}

  /// For the next group, of so many rays.
  Turn next(std::size_t rays) {
    const std::uint64_t seen = add(seen_, rays);
    const bool enough = rays >= kFewest;
    if (!tree_mode_.load(std::memory_order_relaxed)) {
      if (seen < again_.load(std::memory_order_relaxed) || !worth_starting()) {
        return {Way::kHierarchy,
                enough && (!known() || turn_.fetch_add(1, std::memory_order_relaxed) % 16 == 0)};
      }
      tree_mode_.store(true, std::memory_order_relaxed);
    }
    if (!enough) return {Way::kTree, false};
    // Where hardly anything has been made yet, the making is most of what a ray takes, whichever clock is
    // read.
    if (all_tree_rays_.load(std::memory_order_relaxed) < kTrial) return {Way::kTree, false};
    const std::uint64_t compared = compared_.load(std::memory_order_relaxed);
    const std::uint32_t every = compared < kTrial ? 2 : compared < 4 * kTrial ? 8 : 32;
    const std::uint32_t turn = turn_.fetch_add(1, std::memory_order_relaxed) % every;
    return {turn == 1 ? Way::kHierarchy : Way::kTree, turn < 8};
  }

  /// After a group went through the tree: it took `making` nanoseconds to make nodes, and, if it was timed,
  /// `ns` in all.
  void through_tree(std::size_t rays, std::uint64_t making, std::optional<double> ns) {
    if (ns) {
      add(timed_rays_, rays);
      add(tree_ns_, static_cast<std::uint64_t>(std::max(*ns - static_cast<double>(making), 0.0)));
    }
    const std::uint64_t made = add(all_building_, making), n = add(all_tree_rays_, rays);
    std::uint64_t next = next_mark_.load(std::memory_order_relaxed);
    if (n < next || !next_mark_.compare_exchange_strong(next, 2 * n, std::memory_order_relaxed)) return;
    first_.set(latest_.rays(), latest_.building());
    latest_.set(n, made);
  }
  /// After a group that was timed went through the hierarchy, in so many nanoseconds, with so many exact
  /// tests.
  void through_hierarchy(std::size_t rays, double ns, std::uint64_t tests) {
    add(plain_tests_, tests);
    add(plain_ns_, static_cast<std::uint64_t>(ns));
    std::uint64_t known = add(plain_rays_, rays);
    // Other parts of the picture are not like this one.
    if (known > kRecent && plain_rays_.compare_exchange_strong(known, known / 2, std::memory_order_relaxed)) {
      halve(plain_tests_);
      halve(plain_ns_);
    }
    if (!tree_mode_.load(std::memory_order_relaxed)) return;
    const std::uint64_t compared = add(compared_, rays);
    add(hierarchy_ns_, static_cast<std::uint64_t>(ns));
    if (compared >= kTrial) judge(compared);
  }

 private:
  static std::uint64_t add(std::atomic<std::uint64_t>& sum, std::uint64_t n) {
    return sum.fetch_add(n, std::memory_order_relaxed) + n;
  }
  static void halve(std::atomic<std::uint64_t>& sum) {
    sum.fetch_sub(sum.load(std::memory_order_relaxed) / 2, std::memory_order_relaxed);
  }
  static double share(const std::atomic<std::uint64_t>& a, const std::atomic<std::uint64_t>& b) {
    return static_cast<double>(a.load(std::memory_order_relaxed)) /
           static_cast<double>(std::max<std::uint64_t>(b.load(std::memory_order_relaxed), 1));
  }
  void judge(std::uint64_t compared) {
    const double tree = share(tree_ns_, timed_rays_), plain = std::max(share(hierarchy_ns_, compared_), 1e-3);
    // Where rays meet little, they say little of others: of these the tree may spare the more.
    const double lost = (tree - plain) * static_cast<double>(all_tree_rays_.load(std::memory_order_relaxed));
    if (plain < plain_per_ray() / 2 && lost < kRisk * expected_ * plain_per_ray()) return;
    // Few comparisons are of few places, and of caches that are still cold. In the end a tree must be worth
    // its memory.
    const double doubt = compared < 4 * kTrial ? 1.15 : compared < 16 * kTrial ? 1.02 : .97;
    if (tree / plain + making_per_ray() / plain_per_ray() > doubt) leave();
  }
  /// Whether enough rays have gone through the hierarchy to tell what the others will be like.
  bool known() const { return plain_rays_.load(std::memory_order_relaxed) > kKnown; }
  /// Nanoseconds of a ray through the hierarchy, of late.
  double plain_per_ray() const {
    return plain_rays_.load(std::memory_order_relaxed) > 0 ? std::max(share(plain_ns_, plain_rays_), 1.0)
                                                           : kTypical;
  }
  /// Rays still to come: where more came than were expected, as many again.
  double to_come() const {
    const auto seen = static_cast<double>(seen_.load(std::memory_order_relaxed));
    return seen < expected_ ? expected_ - seen : seen;
  }
  /// Nanoseconds that a ray through the tree may save.
  double hope() const {
    if (saving_.needed <= 0) return saving_.share * plain_per_ray();
    if (!known()) return 0;
    const double tests = share(plain_tests_, plain_rays_);
    return tests > saving_.needed ? saving_.share * plain_per_ray() * (1 - saving_.needed / tests) : 0;
  }
  bool worth_starting() const {
    const double saved = hope();
    return saved > 0 && to_come() * saved >= making_;
  }
  /// Nanoseconds a ray that making nodes will take, on average over the rays still to come; 0 as long as
  /// nothing is known. With c sqrt(n) for all nodes of n rays, c is told by what has been made since about
  /// the second last time that the rays had doubled: of the first ones every group comes to new places.
  double making_per_ray() const {
    const auto n = static_cast<double>(all_tree_rays_.load(std::memory_order_relaxed));
    const auto before = static_cast<double>(first_.rays());
    if (before <= 0 || n <= before || n < kEarly * expected_) return 0;
    // What was expected to be made at first tells nothing of what will be made.
    const auto until = [&](std::uint64_t made) { return std::max(static_cast<double>(made), making_); };
    const double c = (until(all_building_.load(std::memory_order_relaxed)) - until(first_.building())) /
                     (std::sqrt(n) - std::sqrt(before));
    return c / (std::sqrt(n) + std::sqrt(n + to_come()));
  }
  void leave() {
    const std::uint64_t seen = seen_.load(std::memory_order_relaxed);
    again_.store(seen + std::max<std::uint64_t>(kPause, 3 * seen), std::memory_order_relaxed);
    for (std::atomic<std::uint64_t>* sum :
         {&compared_, &timed_rays_, &tree_ns_, &hierarchy_ns_, &all_building_, &all_tree_rays_})
      sum->store(0, std::memory_order_relaxed);
    next_mark_.store(kFirstMark, std::memory_order_relaxed);
    first_.set(0, 0);
    latest_.set(0, 0);
    tree_mode_.store(false, std::memory_order_relaxed);
  }

  /// How many rays had gone through the tree at some time, and what nodes had taken to be made by then.
  class Mark {
   public:
    std::uint64_t rays() const { return rays_.load(std::memory_order_relaxed); }
    std::uint64_t building() const { return building_.load(std::memory_order_relaxed); }
    void set(std::uint64_t rays, std::uint64_t building) {
      rays_.store(rays, std::memory_order_relaxed);
      building_.store(building, std::memory_order_relaxed);
    }

   private:
    std::atomic<std::uint64_t> rays_{0}, building_{0};
  };

  /// See known(): the first few rays are of one place.
  static constexpr std::uint64_t kKnown = 1 << 14;
  /// Rays through the hierarchy of which, and of half as many before, an average is taken.
  static constexpr std::uint64_t kRecent = 1 << 16;
  /// Rays through a tree before it is timed, and then beside it through the hierarchy before the first
  /// judgement.
  static constexpr std::uint64_t kTrial = 2048;
  /// Rays through the tree when what nodes have taken to be made is first noted.
  static constexpr std::uint64_t kFirstMark = 4096;
  /// Share of what all expected rays would take through the hierarchy that may be lost on rays that are not
  /// like most.
  static constexpr double kRisk = 1.0 / 64;
  /// Share of the expected rays before which what it takes to make nodes is not judged.
  static constexpr double kEarly = 1.0 / 32;
  /// The shortest time, in rays, that a tree is left alone.
  static constexpr std::uint64_t kPause = 1 << 16;
  /// Nanoseconds of a ray through the hierarchy, as long as nothing better is known.
  static constexpr double kTypical = 120;
  double expected_, making_;
  Saving saving_;
  std::atomic<bool> tree_mode_{false};
  std::atomic<std::uint32_t> turn_{0};
  Mark first_, latest_;  ///< two times at which the rays had about doubled since the one before
  std::atomic<std::uint64_t> next_mark_{kFirstMark};
  std::atomic<std::uint64_t> compared_{0}, timed_rays_{0}, tree_ns_{0}, hierarchy_ns_{0}, all_building_{0},
      all_tree_rays_{0};
  std::atomic<std::uint64_t> plain_rays_{0}, plain_ns_{0}, plain_tests_{0};  ///< those of late
  std::atomic<std::uint64_t> seen_{0}, again_{0};
};

/// Nanoseconds of processor time that this thread has taken: what others do meanwhile does not count.
inline double thread_nanoseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e9 + static_cast<double>(now.tv_nsec);
}

/// Asks for a group of rays, numbered `which`, in the way that `choice` says. `tree(which)` answers them
/// through the tree and returns the nanoseconds that it took to make nodes, `hierarchy(which)` through the
/// hierarchy and returns the exact tests that it took; `later(which)` may do so later, together with others.
template <class Tree, class Plain, class Later>
void ask_by_choice(Choice& choice, std::span<const std::uint32_t> which, const Tree& tree,
                   const Plain& hierarchy, const Later& later) {
  const Choice::Turn turn = choice.next(which.size());
  const double start = turn.timed ? thread_nanoseconds() : 0;
  const auto taken = [&] { return thread_nanoseconds() - start; };
  if (turn.way == Choice::Way::kTree) {
    const std::uint64_t making = tree(which);
    choice.through_tree(which.size(), making, turn.timed ? std::optional(taken()) : std::nullopt);
  } else if (turn.timed) {
    const std::uint64_t tests = hierarchy(which);
    choice.through_hierarchy(which.size(), taken(), tests);
  } else {
    later(which);
  }
}

}  // namespace fas
