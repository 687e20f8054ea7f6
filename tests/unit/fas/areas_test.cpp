// SPDX-License-Identifier: MIT
// Areas of primitives: each is that of its own primitive and face, whatever was asked for before, and what is
// asked for again soon is not computed again.
#include "fas/areas.h"

#include <gtest/gtest.h>

#include <random>

namespace fas {
namespace {

class AreaCacheTest : public testing::Test {
 protected:
  static bool sees(std::uint32_t face, std::uint32_t primitive) { return (face + primitive) % 5 != 0; }
  /// Asks, and checks the answer.
  void ask(std::uint32_t face, std::uint32_t primitive) {
    const Area* area = cache_.find(face, primitive, [&](Area& out) {
      ++projections_;
      out.id = primitive;
      out.x0 = face;
      return sees(face, primitive);
    });
    ASSERT_EQ(area != nullptr, sees(face, primitive)) << face << " " << primitive;
    if (!area) return;
    ASSERT_EQ(area->id, primitive);
    ASSERT_EQ(area->x0, face);
  }
  AreaCache cache_;
  int projections_ = 0;
};

TEST_F(AreaCacheTest, WhatIsAskedForAgainIsThere) {
  for (int round = 0; round < 3; ++round) {
    for (std::uint32_t primitive = 40; primitive < 140; ++primitive)
      for (const std::uint32_t face : {0u, 3u, 17u}) ask(face, primitive);
  }
  EXPECT_EQ(projections_, 300);
}

TEST_F(AreaCacheTest, EveryAreaIsOfItsOwnPrimitiveAndFace) {
  std::mt19937 random(3);
  std::uniform_int_distribution<std::uint32_t> primitive(0, 20'000), face(0, 40);
  for (int i = 0; i < 100'000; ++i) ask(face(random), primitive(random));
  EXPECT_GT(projections_, 90'000);
}

}  // namespace
}  // namespace fas
