// SPDX-License-Identifier: MIT
// Records come back as they went, and nothing else is taken for one: cut, flipped, swapped or invented.
#include "rayshade/image/block_record.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

namespace rayshade {
namespace {

constexpr std::uint64_t kLimit = 1 << 22;
constexpr PixelStorage kStorages[] = {PixelStorage::kByte, PixelStorage::kWord, PixelStorage::kFloat,
                                      PixelStorage::kExponential};

EncodedBlock random_block(std::mt19937& random, PixelStorage storage, std::size_t layers, int largest) {
  const auto below = [&](int n) { return static_cast<std::int64_t>(random() % static_cast<unsigned>(n)); };
  EncodedBlock out;
  out.x = below(100'000);
  out.y = below(100'000);
  out.width = 1 + below(largest);
  out.height = 1 + below(largest);
  const auto pixels = static_cast<std::size_t>(out.width * out.height);
  out.pixels.resize(pixels * pixel_size(storage));
  const bool dull = random() % 2 == 0;  // packs well
  for (std::uint8_t& byte : out.pixels) byte = static_cast<std::uint8_t>(dull ? 7 : random() & 0xff);
  out.layers.resize(layers);
  for (std::vector<float>& layer : out.layers)
    for (std::size_t i = 0; i < pixels; ++i) layer.push_back(static_cast<float>(random()) - 1e9F);
  if (random() % 2 == 0) {
    for (std::size_t i = 0; i < pixels; ++i) out.odd.push_back(static_cast<std::uint8_t>(random() & 7));
    out.odd.back() = kNegative;
  }
  return out;
}

void expect_same(const EncodedBlock& a, const EncodedBlock& b) {
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.y, b.y);
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.pixels, b.pixels);
  EXPECT_EQ(a.layers, b.layers);
  EXPECT_EQ(a.odd, b.odd);
}

TEST(BlockRecord, ComesBackAsItWent) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int i = 0; i < 200; ++i) {
    const PixelStorage storage = kStorages[i % 4];
    const EncodedBlock block = random_block(random, storage, random() % 4, 40);
    const int frame = static_cast<int>(random());
    for (const RecordPacking packing : {RecordPacking::kPlain, RecordPacking::kDeflate}) {
      const std::string record = encode_block_record(frame, block, storage, packing);
      const std::optional<BlockRecord> back = decode_block_record(record, kLimit);
      ASSERT_TRUE(back);
      EXPECT_EQ(back->frame, frame);
      EXPECT_EQ(back->storage, storage);
      expect_same(back->block, block);
      EXPECT_LE(record.size(), 80 +
                                   static_cast<std::size_t>(block.width * block.height) *
                                       recorded_pixel_size(storage, block.layers.size()) +
                                   block.odd.size());
    }
  }
}

TEST(BlockRecord, IsLittleEndianAndPinned) {
  // Written by hand from the description: another machine, or a later version, must read it.
  EncodedBlock block;
  block.x = 1;
  block.y = 2;
  block.width = 1;
  block.height = 1;
  const std::uint16_t words[] = {0x0102, 0x0304, 0x0506, 0x0708};
  block.pixels.resize(8);
  std::memcpy(block.pixels.data(), words, 8);
  const std::string record = encode_block_record(-2, block, PixelStorage::kWord);
  ASSERT_EQ(record.size(), kRecordHead + 48 + 8);
  EXPECT_EQ(record.substr(0, 6), std::string("RSRc\1\1"));
  EXPECT_EQ(record.substr(8, 8), std::string("\x38\0\0\0\0\0\0\0", 8));
  EXPECT_EQ(record.substr(24, 8), std::string("\xfe\xff\xff\xff\1\0\0\0", 8));
  EXPECT_EQ(record.substr(record.size() - 8), "\2\1\4\3\6\5\10\7");
}

TEST(BlockRecord, DullPixelsArePackedAndNoiseIsNot) {
  EncodedBlock block;
  block.width = block.height = 64;
  block.pixels.assign(64 * 64 * 4, 3);
  EXPECT_LT(encode_block_record(0, block, PixelStorage::kByte, RecordPacking::kDeflate).size(), 400U);
  std::mt19937 random(1);
  for (std::uint8_t& byte : block.pixels) byte = static_cast<std::uint8_t>(random());
  EXPECT_EQ(encode_block_record(0, block, PixelStorage::kByte, RecordPacking::kDeflate),
            encode_block_record(0, block, PixelStorage::kByte));
}

TEST(BlockRecord, CutAnywhereItIsNone) {
  std::mt19937 random(2);
  for (const RecordPacking packing : {RecordPacking::kPlain, RecordPacking::kDeflate}) {
    const std::string record = encode_block_record(3, random_block(random, PixelStorage::kFloat, 1, 5),
                                                   PixelStorage::kFloat, packing);
    for (std::size_t size = 0; size < record.size(); ++size)
      EXPECT_FALSE(decode_block_record(record.substr(0, size), kLimit)) << size;
    EXPECT_FALSE(decode_block_record(record + "x", kLimit));
  }
}

TEST(BlockRecord, AnyFlippedBitIsNoticed) {
  std::mt19937 random(3);
  for (const RecordPacking packing : {RecordPacking::kPlain, RecordPacking::kDeflate}) {
    std::string record =
        encode_block_record(3, random_block(random, PixelStorage::kByte, 1, 6), PixelStorage::kByte, packing);
    for (std::size_t bit = 0; bit < 8 * record.size(); ++bit) {
      record[bit / 8] = static_cast<char>(record[bit / 8] ^ 1 << bit % 8);
      EXPECT_FALSE(decode_block_record(record, kLimit)) << bit;
      record[bit / 8] = static_cast<char>(record[bit / 8] ^ 1 << bit % 8);
    }
    EXPECT_TRUE(decode_block_record(record, kLimit));
  }
}

TEST(BlockRecord, SealedNonsenseIsRefusedWithoutTakingMemory) {
  // The checksums of these are right: only what they announce is wrong.
  const auto sealed = [](std::uint8_t storage, std::uint8_t packing, std::uint32_t x, std::uint32_t width,
                         std::uint32_t height, std::uint16_t layers, std::size_t data) {
    RecordWriter out(RecordKind::kBlock);
    out.number(std::int32_t{0});
    out.number(storage);
    out.number(packing);
    out.number(layers);
    for (const std::uint32_t value : {x, std::uint32_t{0}, width, height}) out.number(value);
    for (int i = 0; i < 3; ++i) out.number(std::uint64_t{0});
    const std::string bytes(data, '\0');
    out.bytes(bytes.data(), bytes.size());
    return decode_block_record(out.seal(), kLimit);
  };
  EXPECT_TRUE(sealed(0, 0, 0, 2, 2, 0, 16));
  EXPECT_FALSE(sealed(0, 0, 0, 2, 2, 0, 15));
  EXPECT_FALSE(sealed(0, 0, 0, 2, 2, 0, 17));
  EXPECT_FALSE(sealed(0, 0, 0, 2, 2, 1, 16));
  EXPECT_FALSE(sealed(9, 0, 0, 2, 2, 0, 16));
  EXPECT_FALSE(sealed(0, 9, 0, 2, 2, 0, 16));
  EXPECT_FALSE(sealed(0, 1, 0, 2, 2, 0, 16));
  EXPECT_FALSE(sealed(0, 0, 0, 0, 2, 0, 0));
  EXPECT_FALSE(sealed(0, 0, 0x7fffffff, 2, 2, 0, 16));
  EXPECT_FALSE(sealed(2, 0, 0, 0x7fffffff, 0x7fffffff, 65'535, 16));
  EXPECT_FALSE(sealed(2, 1, 0, 0x7fffffff, 0x7fffffff, 65'535, 16));
  EXPECT_FALSE(sealed(0, 1, 0, 0xffffffff, 0xffffffff, 0, 16));
  EXPECT_FALSE(sealed(0, 1, 0, 1000, 1000, 0, 16));  // more than sixteen packed bytes can hold
}

TEST(BlockRecord, RandomPayloadsUnderARightSealDoNoHarm) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::string good = encode_block_record(1, random_block(random, PixelStorage::kByte, 1, 6),
                                         PixelStorage::kByte, RecordPacking::kDeflate);
  for (int i = 0; i < 20'000; ++i) {
    std::string payload = good.substr(kRecordHead);
    for (unsigned n = 1 + random() % 4; n-- > 0;)
      payload[random() % payload.size()] = static_cast<char>(random());
    if (const auto back = decode_block_payload(payload, kLimit)) {
      const auto pixels = static_cast<std::size_t>(back->block.width * back->block.height);
      EXPECT_EQ(back->block.pixels.size(), pixels * pixel_size(back->storage));
    }
  }
}

TEST(BlockRecord, RefusesBlocksThatAreNotWhatTheyAnnounce) {
  EncodedBlock block;
  block.width = block.height = 2;
  block.pixels.resize(15);
  EXPECT_THROW(encode_block_record(0, block, PixelStorage::kByte), std::invalid_argument);
  block.pixels.resize(16);
  block.layers.resize(1);
  EXPECT_THROW(encode_block_record(0, block, PixelStorage::kByte), std::invalid_argument);
  block.layers.clear();
  block.odd.assign(3, kNegative);
  EXPECT_THROW(encode_block_record(0, block, PixelStorage::kByte), std::invalid_argument);
  block.odd.clear();
  block.x = -1;
  EXPECT_THROW(encode_block_record(0, block, PixelStorage::kByte), std::invalid_argument);
}

TEST(BlockRecord, CutsArePartsOfTheBlock) {
  std::mt19937 random(5);
  EncodedBlock block = random_block(random, PixelStorage::kWord, 2, 20);
  block.width = block.height = 4;
  block.pixels.resize(16 * 8);
  for (auto& layer : block.layers) layer.assign(16, 0);
  block.odd.assign(16, 0);
  block.odd[10] = kNegative;
  for (std::size_t i = 0; i < 16; ++i) {
    block.layers[1][i] = static_cast<float>(i);
    block.pixels[8 * i + 3] = static_cast<std::uint8_t>(i);
  }
  const EncodedBlock cut = cut_block(block, PixelStorage::kWord, block.x + 1, block.y + 2, 2, 2);
  EXPECT_EQ(cut.layers[1], (std::vector<float>{9, 10, 13, 14}));
  ASSERT_EQ(cut.pixels.size(), 32U);
  EXPECT_EQ(cut.pixels[3], 9);
  EXPECT_EQ(cut.pixels[27], 14);
  EXPECT_EQ(cut.odd, (std::vector<std::uint8_t>{0, kNegative, 0, 0}));
  EXPECT_TRUE(cut_block(block, PixelStorage::kWord, block.x, block.y, 4, 2).odd.empty());
  EXPECT_THROW(cut_block(block, PixelStorage::kWord, block.x + 3, block.y, 2, 1), std::invalid_argument);
}

}  // namespace
}  // namespace rayshade
