// SPDX-License-Identifier: MIT
// The vector code of every instruction set that this processor has is the scalar code, bit by bit.
#include "fas/kernels.h"

#include <array>
#include <bit>
#include <cstring>
#include <random>
#include <vector>

#include "tests/unit/fas/targets.h"

namespace fas {
namespace {

/// A block of random candidates, many of them alike or extreme, with what kernels may read beyond it.
class RandomBlock {
 public:
  explicit RandomBlock(std::mt19937_64& engine) : engine_(engine) {}

  void make(int n, bool cuts) {
    count = n;
    stride = Block::stride(static_cast<std::size_t>(n));
    // No byte more than kernels may read: the address sanitizer watches.
    bytes_.assign(Block::readable(static_cast<std::size_t>(n), cuts), 0);
    bytes_.shrink_to_fit();
    for (std::uint8_t& byte : bytes_) byte = any();
    // Wide areas, so that matches are common; lo <= hi is not required.
    for (std::size_t i = 0; i < stride && engine_() % 4 != 0; ++i) {
      for (std::size_t k : {0u, 2u, 4u}) bytes_[k * stride + i] /= 4;
      for (std::size_t k : {1u, 3u}) bytes_[k * stride + i] = static_cast<std::uint8_t>(255 - any() / 4);
    }
    if (!cuts) return;
    std::uint8_t* factors = bytes_.data() + Block::kAreaBytes * stride;
    for (std::size_t i = 0; i < 6 * stride; ++i) {
      // Factors are within +-127.
      static constexpr std::array<int, 6> kExtreme{-127, -1, 0, 1, 126, 127};
      int value = static_cast<int>(engine_() % 255) - 127;
      if (engine_() % 3 == 0) value = kExtreme[engine_() % kExtreme.size()];
      factors[i] = static_cast<std::uint8_t>(static_cast<std::int8_t>(value));
    }
    for (std::size_t i = 0; i < 3 * stride; ++i) {
      static constexpr std::array<int, 8> kExtreme{-32768, -32767, -32512, -1, 0, 1, 32512, 32767};
      int value = static_cast<int>(engine_() % 65536) - 32768;
      if (engine_() % 3 == 0) value = kExtreme[engine_() % kExtreme.size()];
      if (engine_() % 3 == 0) value = static_cast<int>(engine_() % 256) - 128;
      const auto offset = static_cast<std::int16_t>(value);
      std::memcpy(factors + 6 * stride + 2 * i, &offset, sizeof offset);
    }
  }
  std::uint8_t any() {
    static constexpr std::array<std::uint8_t, 8> kExtreme{0, 1, 127, 128, 129, 254, 255, 255};
    const std::uint64_t random = engine_();
    return random % 3 == 0 ? kExtreme[(random >> 8) % 8] : static_cast<std::uint8_t>(random >> 16);
  }
  const std::uint8_t* data() const { return bytes_.data(); }

  int count = 0;
  std::size_t stride = 0;

 private:
  std::mt19937_64& engine_;
  std::vector<std::uint8_t> bytes_;
};

class KernelsTest : public test::TargetTest {
 protected:
  void SetUp() override {
    test::TargetTest::SetUp();
    kernels_ = dispatched_kernels();
    ASSERT_STREQ(kernels_.name, hwy::TargetName(GetParam()));
  }
  Kernels kernels_{};
};

/// Some five million pairs of candidate and probe for each kernel.
TEST_P(KernelsTest, EqualTheScalarTwins) {
  const Kernels& plain = scalar_kernels();
  std::mt19937_64 engine(11);
  RandomBlock block(engine);
  std::uint64_t pairs = 0, matches = 0;
  for (int round = 0; round < 5'000; ++round) {
    const int n = 1 + round % Block::kMost;
    const bool cuts = engine() % 2 != 0;
    block.make(n, cuts);
    std::array<std::uint8_t, 64> u, v, z;
    for (std::size_t k = 0; k < 64; ++k) u[k] = block.any(), v[k] = block.any(), z[k] = block.any();
    const int count = 1 + static_cast<int>(engine() % 64);
    std::array<std::uint64_t, 64> expected{};
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
      const Probe probe{u[k], v[k], z[k]};
      expected[k] = plain.match(block.data(), n, cuts, probe);
      ASSERT_EQ(kernels_.match(block.data(), n, cuts, probe), expected[k])
          << "round " << round << ", probe " << k;
      matches += static_cast<std::uint64_t>(std::popcount(expected[k]));
      pairs += static_cast<std::uint64_t>(n);
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
      const auto mask =
          kernels_.match_rays(block.data(), block.stride, i, cuts, u.data(), v.data(), z.data(), count);
      ASSERT_EQ(mask,
                plain.match_rays(block.data(), block.stride, i, cuts, u.data(), v.data(), z.data(), count))
          << "round " << round << ", candidate " << i;
      // The same question asked the other way about.
      for (int k = 0; k < count; ++k)
        ASSERT_EQ(mask >> k & 1, expected[static_cast<std::size_t>(k)] >> i & 1);
    }
  }
  EXPECT_GT(pairs, 4'000'000u);
  EXPECT_GT(matches, pairs / 50);
  EXPECT_LT(matches, pairs / 2);
}

/// What is beyond the candidates, in the block and in the arrays of probes, has no influence.
TEST_P(KernelsTest, PlacesBeyondTheEndDoNotMatter) {
  const Kernels& plain = scalar_kernels();
  for (int n = 1; n <= Block::kMost; ++n) {
    for (const bool cuts : {false, true}) {
      const std::size_t s = Block::stride(static_cast<std::size_t>(n));
      for (const std::uint8_t junk : {std::uint8_t{0}, std::uint8_t{255}, std::uint8_t{90}}) {
        // Everything matches everywhere.
        std::vector<std::uint8_t> bytes(Block::bytes(static_cast<std::size_t>(n), cuts) + Block::kPadding,
                                        junk);
        std::fill_n(bytes.begin(), 5 * s, std::uint8_t{0});
        std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(s), s, std::uint8_t{255});
        std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(3 * s), s, std::uint8_t{255});
        if (cuts) std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(5 * s), 12 * s, std::uint8_t{0});
        const std::uint64_t all = n == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << n) - 1;
        ASSERT_EQ(kernels_.match(bytes.data(), n, cuts, {7, 200, 0}), all);
        ASSERT_EQ(plain.match(bytes.data(), n, cuts, {7, 200, 0}), all);
        std::array<std::uint8_t, 64> u;
        u.fill(junk);
        ASSERT_EQ(kernels_.match_rays(bytes.data(), s, 0, cuts, u.data(), u.data(), u.data(), n), all);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, KernelsTest, testing::ValuesIn(test::targets()), test::target_name);

TEST(Kernels, AreThoseOfThisProcessor) {
  EXPECT_STRNE(kernels().name, "");
  EXPECT_STREQ(scalar_kernels().name, "scalar");
}

}  // namespace
}  // namespace fas
