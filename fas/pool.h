// SPDX-License-Identifier: MIT
// Memory of the hyper-trees: a budget, chunks that are kept across frames, and per-thread arenas that cut
// them up. Nothing is given back one by one: what readers may still look at stays where it is until reset(),
// which the owner calls when no thread traces (rule 14).
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

namespace fas {

class Pool {
 public:
  static constexpr std::size_t kChunk = std::size_t{256} << 10;

  /// `budget` in bytes: no more than this is held at any time.
  explicit Pool(std::size_t budget) : budget_(budget) {}
  ~Pool();
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  /// A chunk of at least `bytes` (kChunk, or a multiple), or null where the budget does not allow it.
  std::byte* take(std::size_t bytes);
  /// Everything taken is free again; pages stay with the process until others are needed in their place. No
  /// thread may be using any of it.
  void reset();
  /// Grows with every reset(): arenas that hold chunks of an earlier generation start anew.
  std::uint64_t generation() const { return generation_.load(std::memory_order_acquire); }
  /// Whether something was refused since the last reset().
  bool exhausted() const { return exhausted_.load(std::memory_order_relaxed); }
  /// Bytes in chunks that are in use.
  std::size_t used() const { return used_.load(std::memory_order_relaxed); }
  std::size_t budget() const { return budget_; }
  /// Bytes that the process has of the system for this pool, in use or kept for later.
  std::size_t held() const;

 private:
  struct Chunk {
    std::byte* start;
    std::size_t size;
  };
  /// Gives back chunks that are not in use, until another `size` bytes are within the budget.
  void make_room(std::size_t size);

  std::size_t budget_;
  mutable std::mutex mutex_;
  std::vector<Chunk> all_, free_;
  std::size_t held_ = 0;
  std::atomic<std::size_t> used_{0};
  std::atomic<std::uint64_t> generation_{0};
  std::atomic<bool> exhausted_{false};
};

/// One thread's share of a pool.
class Arena {
 public:
  explicit Arena(Pool& pool) : pool_(&pool) {}
  /// Aligned to 16 bytes, uninitialised, followed by at least 64 readable bytes; null when the budget is
  /// spent.
  std::byte* take(std::size_t bytes);
  /// Gives back the latest allocation, or its end, if nothing came after it.
  void shrink(std::byte* start, std::size_t old_bytes, std::size_t new_bytes);

 private:
  static constexpr std::size_t kReadable = 64;
  static std::size_t rounded(std::size_t bytes) { return (bytes + 15) & ~std::size_t{15}; }
  Pool* pool_;
  std::uint64_t generation_ = 0;
  std::byte *next_ = nullptr, *end_ = nullptr;
};

}  // namespace fas
