// SPDX-License-Identifier: MIT
// Sorting a span of queries by leaf: every query is in exactly one chain, that of its leaf, however many
// leaves there are.
#include "fas/batch.h"

#include <gtest/gtest.h>

#include <random>

namespace fas {
namespace {

class NoCandidates final : public Candidates {
 public:
  std::uint32_t count() const override { return 0; }
  Bounds bounds() const override { return {}; }
  void geometry(std::uint32_t, Geometry&) const override {}
  int open(std::uint32_t, Child (&)[kMostChildren]) const override { return 0; }
};

TEST(LeafGroups, EveryQueryIsInOneChain) {
  const NoCandidates nothing;
  Pool pool(0);
  Tuner tuner;
  HyperTree tree(make_view(View::Kind::kPoint, {}, {}, 1), nothing, pool, tuner, 0);
  std::mt19937_64 engine(5);
  LeafGroups groups;
  for (const std::uint32_t leaves : {1u, 3u, 100u, 2047u, 2048u, 2049u, 4096u, 9000u}) {
    for (const std::uint32_t queries : {1u, 64u, 4096u, 20'000u}) {
      groups.clear();
      std::vector<const Leaf*> leaf_of(queries);
      for (std::uint32_t i = 0; i < queries; ++i) {
        // The groups never look into a leaf.
        const std::uintptr_t number = queries >= leaves && i < leaves ? i : engine() % leaves;
        leaf_of[i] = reinterpret_cast<const Leaf*>(0x10000 + 48 * number);
        groups.add(tree, leaf_of[i], {}, i, queries);
      }
      std::vector<int> seen(queries, 0);
      std::uint32_t total = 0;
      for (const LeafGroups::Group& group : groups.groups()) {
        std::uint32_t place = group.first;
        for (std::uint32_t k = 0; k < group.count; ++k) {
          ASSERT_LT(place, queries);
          ASSERT_EQ(leaf_of[place], group.leaf);
          ++seen[place];
          ++total;
          if (k + 1 == group.count) {
            ASSERT_EQ(place, group.last);
          }
          place = groups.next(place);
        }
      }
      ASSERT_EQ(total, queries);
      for (std::uint32_t i = 0; i < queries; ++i) ASSERT_EQ(seen[i], 1);
      // While there are few leaves, one group each.
      if (leaves <= 2048) {
        ASSERT_LE(groups.groups().size(), leaves);
      }
    }
  }
}

}  // namespace
}  // namespace fas
