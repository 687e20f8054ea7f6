// SPDX-License-Identifier: MIT
// Memory of the trees: the budget holds whatever is asked for and however often it is reset, what was handed
// out stays apart, aligned and readable beyond its end.
#include "fas/pool.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <random>
#include <thread>

namespace fas {
namespace {

constexpr std::size_t kChunk = Pool::kChunk;

TEST(Pool, KeepsTheBudget) {
  Pool pool(3 * kChunk + 100);
  EXPECT_EQ(pool.budget(), 3 * kChunk + 100);
  EXPECT_NE(pool.take(1), nullptr);
  EXPECT_EQ(pool.used(), kChunk);
  EXPECT_NE(pool.take(kChunk + 1), nullptr);
  EXPECT_EQ(pool.used(), 3 * kChunk);
  EXPECT_FALSE(pool.exhausted());
  EXPECT_EQ(pool.take(1), nullptr);
  EXPECT_TRUE(pool.exhausted());
  EXPECT_EQ(pool.used(), 3 * kChunk);
}

TEST(Pool, WithoutABudgetGivesNothing) {
  Pool pool(0);
  Arena arena(pool);
  EXPECT_EQ(arena.take(1), nullptr);
  EXPECT_TRUE(pool.exhausted());
  EXPECT_EQ(pool.used(), 0u);
  pool.reset();
  EXPECT_FALSE(pool.exhausted());
  EXPECT_EQ(arena.take(1), nullptr);
}

TEST(Pool, ResetMakesEverythingFreeAgain) {
  Pool pool(4 * kChunk);
  std::byte* first = pool.take(1);
  for (int i = 0; i < 3; ++i) EXPECT_NE(pool.take(kChunk), nullptr);
  EXPECT_EQ(pool.take(1), nullptr);
  const std::uint64_t generation = pool.generation();
  pool.reset();
  EXPECT_GT(pool.generation(), generation);
  EXPECT_FALSE(pool.exhausted());
  EXPECT_EQ(pool.used(), 0u);
  bool again = false;
  for (int i = 0; i < 4; ++i) {
    std::byte* chunk = pool.take(kChunk);
    ASSERT_NE(chunk, nullptr);
    again = again || chunk == first;
  }
  EXPECT_TRUE(again) << "pages are kept";
}

/// What lies idle after a reset counts, too: a frame that asks for other sizes may not add to it.
TEST(Pool, KeepsTheBudgetAcrossFramesOfOtherSizes) {
  constexpr std::size_t kBudget = 8 * kChunk;
  Pool pool(kBudget);
  for (std::size_t chunks = 1; chunks <= 8; ++chunks) {
    std::size_t taken = 0;
    while (pool.take(chunks * kChunk) != nullptr) taken += chunks * kChunk;
    EXPECT_EQ(taken, 8 / chunks * chunks * kChunk) << "in pieces of " << chunks;
    EXPECT_LE(pool.held(), kBudget);
    EXPECT_LE(pool.used(), pool.held());
    pool.reset();
  }
}

/// A small request does not use up a large chunk while a small one is free.
TEST(Pool, TakesTheSmallestThatFits) {
  Pool pool(8 * kChunk);
  std::byte* large = pool.take(6 * kChunk);
  std::byte* small = pool.take(kChunk);
  ASSERT_NE(large, nullptr);
  pool.reset();
  EXPECT_EQ(pool.take(10), small);
  EXPECT_EQ(pool.take(6 * kChunk), large);
}

TEST(Arena, AllocationsAreAlignedAndApart) {
  std::mt19937_64 engine(3);
  Pool pool(64 * kChunk);
  Arena arena(pool), other(pool);
  for (int frame = 0; frame < 3; ++frame) {
    std::map<std::byte*, std::size_t> taken;
    for (;;) {
      std::size_t bytes = engine() % 3000;
      if (engine() % 50 == 0) bytes = engine() % (3 * kChunk);
      if (engine() % 100 == 0) bytes = kChunk - 64 - engine() % 20;
      std::byte* start = (engine() % 2 ? arena : other).take(bytes);
      if (!start) break;
      ASSERT_EQ(reinterpret_cast<std::uintptr_t>(start) % 16, 0u);
      std::memset(start, static_cast<int>(taken.size() % 251), bytes);
      ASSERT_TRUE(bytes == 0 || taken.emplace(start, bytes).second);
      // Readable beyond the end: the address sanitizer watches.
      unsigned sum = 0;
      for (std::size_t i = 0; i < 64; ++i) sum += static_cast<unsigned>(start[bytes + i] != std::byte{0});
      ASSERT_LE(sum, 64u);
    }
    EXPECT_TRUE(pool.exhausted());
    EXPECT_GT(taken.size(), 500u);
    std::byte* end = nullptr;
    for (const auto& [start, bytes] : taken) {
      ASSERT_GE(start, end);
      end = start + bytes;
      for (std::size_t i = 1; i < bytes; ++i) ASSERT_EQ(start[i], start[0]);
    }
    pool.reset();
  }
}

TEST(Arena, ShrinksOnlyTheLatest) {
  Pool pool(4 * kChunk);
  Arena arena(pool);
  std::byte* first = arena.take(100);
  std::byte* second = arena.take(1000);
  arena.shrink(first, 100, 10);  // no longer the latest: nothing happens
  EXPECT_EQ(arena.take(16), second + 1008);
  std::byte* third = arena.take(512);
  arena.shrink(third, 512, 0);
  EXPECT_EQ(arena.take(16), third);
}

TEST(Arena, StartsAnewAfterAReset) {
  Pool pool(2 * kChunk);
  Arena arena(pool);
  ASSERT_NE(arena.take(kChunk / 2), nullptr);
  pool.reset();
  ASSERT_NE(arena.take(kChunk / 2), nullptr);
  EXPECT_EQ(pool.used(), kChunk) << "accounted for in the new generation";
}

TEST(Arena, ThreadsShareAPool) {
  constexpr int kThreads = 4;
  Pool pool(32 * kChunk);
  std::vector<std::vector<std::pair<std::byte*, std::size_t>>> taken(kThreads);
  std::vector<std::thread> threads;
  for (int k = 0; k < kThreads; ++k) {
    threads.emplace_back([&, k] {
      Arena arena(pool);
      for (std::size_t i = 0;; ++i) {
        const std::size_t bytes = 16 + i * 37 % 5000;
        std::byte* start = arena.take(bytes);
        if (!start) return;
        std::memset(start, k, bytes);
        taken[static_cast<std::size_t>(k)].emplace_back(start, bytes);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_TRUE(pool.exhausted());
  EXPECT_LE(pool.used(), pool.budget());
  for (int k = 0; k < kThreads; ++k) {
    for (const auto& [start, bytes] : taken[static_cast<std::size_t>(k)])
      for (std::size_t i = 0; i < bytes; ++i) ASSERT_EQ(static_cast<int>(start[i]), k);
  }
}

}  // namespace
}  // namespace fas
