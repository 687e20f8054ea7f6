// SPDX-License-Identifier: MIT
// Areas of primitives: what is kept is found again, by every thread, and a spent budget only means that less
// is.
#include "fas/areas.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace fas {
namespace {

Area area_of(std::uint32_t id) {
  Area area{};
  area.id = id;
  area.x0 = id;
  area.z1 = 2.0 * id;
  return area;
}

TEST(AreaStore, KeepsWhatIsSeenAndWhatIsNot) {
  Pool pool(std::size_t{8} << 20);
  Arena arena(pool);
  AreaStore store;
  EXPECT_EQ(store.find(5), nullptr);  // before start()
  EXPECT_EQ(store.keep(5, area_of(5), arena), 0u);
  EXPECT_GT(store.start(1000, arena), 0u);
  EXPECT_EQ(store.find(999), nullptr);
  EXPECT_GE(store.keep(999, area_of(999), arena), sizeof(Area));
  store.keep(998, AreaStore::unseen(), arena);
  ASSERT_NE(store.find(999), nullptr);
  EXPECT_EQ(store.find(999)->id, 999u);
  EXPECT_EQ(store.find(999)->z1, 1998);
  EXPECT_EQ(store.find(998), &AreaStore::unseen());
  EXPECT_EQ(store.find(997), nullptr);
  store.clear();
  EXPECT_EQ(store.find(999), nullptr);
}

TEST(AreaStore, DoesWithoutMemory) {
  Pool pool(Pool::kChunk);
  Arena arena(pool);
  AreaStore store;
  ASSERT_GT(store.start(4096, arena), 0u);
  std::size_t bytes = 0;
  for (std::uint32_t i = 0; i < 4096; ++i) bytes += store.keep(i, area_of(i), arena);
  EXPECT_LT(bytes, Pool::kChunk);
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < 4096; ++i) {
    if (const Area* area = store.find(i)) {
      ++kept;
      ASSERT_EQ(area->id, i);
    }
  }
  EXPECT_GT(kept, 100u);
  EXPECT_LT(kept, 4096u);
}

TEST(AreaStore, IsFilledByManyThreadsAtOnce) {
  Pool pool(std::size_t{64} << 20);
  Arena first(pool);
  AreaStore store;
  store.start(2048, first);
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&] {
        Arena arena(pool);
        for (std::uint32_t i = 0; i < 2048; ++i)
          if (!store.find(i)) store.keep(i, area_of(i), arena);
      });
    }
  }
  for (std::uint32_t i = 0; i < 2048; ++i) {
    ASSERT_NE(store.find(i), nullptr) << i;
    EXPECT_EQ(store.find(i)->x0, i);
  }
}

}  // namespace
}  // namespace fas
