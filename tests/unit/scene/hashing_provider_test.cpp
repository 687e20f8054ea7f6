// SPDX-License-Identifier: MIT
// Every file read leaves the hash of its content, from any thread; none that could not be read does.
#include "rayshade/scene/hashing_provider.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "rayshade/scene/hash128.h"

namespace rayshade {
namespace {

using Hashes = std::map<std::string, std::string>;

TEST(HashingProviderTest, NotesWhatWasRead) {
  MemoryProvider memory;
  memory.add("a", "first");
  memory.add("b", "second");
  memory.add("never", "asked for");
  HashingProvider hashing(memory);
  EXPECT_TRUE(hashing.hashes().empty());
  EXPECT_EQ(*hashing.read("a"), "first");
  EXPECT_EQ(*hashing.read("b"), "second");
  EXPECT_EQ(*hashing.read("a"), "first");
  EXPECT_EQ(hashing.hashes(), (Hashes{{"a", hash128("first").text()}, {"b", hash128("second").text()}}));
}

TEST(HashingProviderTest, WhatChangedHasTheHashOfTheLastReading) {
  MemoryProvider memory;
  memory.add("a", "before");
  HashingProvider hashing(memory);
  hashing.read("a");
  memory.add("a", "after");
  EXPECT_EQ(*hashing.read("a"), "after");
  EXPECT_EQ(hashing.hashes(), (Hashes{{"a", hash128("after").text()}}));
}

TEST(HashingProviderTest, ErrorsPassAndLeaveNothing) {
  MemoryProvider memory;
  HashingProvider hashing(memory);
  EXPECT_THROW(hashing.read("none"), ProviderError);
  EXPECT_TRUE(hashing.hashes().empty());
}

TEST(HashingProviderTest, FromAnyThread) {
  MemoryProvider memory;
  Hashes expected;
  for (int i = 0; i < 64; ++i) {
    const std::string name = std::to_string(i), content = "content of " + name;
    memory.add(name, content);
    expected[name] = hash128(content).text();
  }
  HashingProvider hashing(memory);
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&hashing, t] {
        for (int i = 0; i < 64; ++i) hashing.read(std::to_string((17 * t + i) % 64));
      });
  }
  EXPECT_EQ(hashing.hashes(), expected);
}

}  // namespace
}  // namespace rayshade
