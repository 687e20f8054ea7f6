// SPDX-License-Identifier: MIT
// Published values of MurmurHash3 x64 128 with seed 0.
#include "rayshade/scene/hash128.h"

#include <gtest/gtest.h>

namespace rayshade {
namespace {

TEST(Hash128Test, PublishedValues) {
  EXPECT_EQ(hash128("").text(), "00000000000000000000000000000000");
  EXPECT_EQ(hash128("hello").text(), "cbd8a7b341bd9b025b1e906a48ae1d19");
  EXPECT_EQ(hash128("hello, world").text(), "342fac623a5ebc8e4cdcbc079642414d");
  EXPECT_EQ(hash128("19 Jan 2038 at 3:14:07 AM").text(), "b89e5988b737affc664fc2950231b2cb");
  EXPECT_EQ(hash128("The quick brown fox jumps over the lazy dog.").text(),
            "cd99481f9ee902c9695da1a38987b6e7");
}

TEST(Hash128Test, EveryLengthAndByteCounts) {
  std::string text(40, 'x');
  for (std::size_t size = 0; size < text.size(); ++size) {
    EXPECT_NE(hash128(std::string_view(text).substr(0, size)),
              hash128(std::string_view(text).substr(0, size + 1)));
  }
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string other = text;
    other[i] = 'y';
    EXPECT_NE(hash128(text), hash128(other)) << i;
  }
  EXPECT_NE(hash128(text, 1), hash128(text, 2));
}

}  // namespace
}  // namespace rayshade
