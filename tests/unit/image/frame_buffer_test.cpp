// SPDX-License-Identifier: MIT
// Blocks into rows: any order, any thread, any storage.
#include "rayshade/image/frame_buffer.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "tests/unit/image/pictures.h"

namespace rayshade {
namespace {

struct Rectangle {
  std::int64_t x, y, width, height;
};

// A partition of the picture into blocks of uneven sizes, shuffled.
std::vector<Rectangle> shuffled_blocks(std::int64_t width, std::int64_t height, std::int64_t side,
                                       unsigned seed) {
  std::vector<Rectangle> blocks;
  for (std::int64_t y = 0; y < height; y += side)
    for (std::int64_t x = 0; x < width; x += side)
      blocks.push_back({x, y, std::min(side, width - x), std::min(side, height - y)});
  std::mt19937 random(seed);
  std::shuffle(blocks.begin(), blocks.end(), random);
  return blocks;
}

std::vector<double> cut(const std::vector<double>& rgba, std::int64_t width, const Rectangle& r) {
  std::vector<double> out;
  for (std::int64_t y = r.y; y < r.y + r.height; ++y) {
    const auto start = rgba.begin() + 4 * (y * width + r.x);
    out.insert(out.end(), start, start + 4 * r.width);
  }
  return out;
}

FrameBufferOptions options(std::int64_t width, std::int64_t height,
                           PixelStorage storage = PixelStorage::kByte) {
  FrameBufferOptions o;
  o.width = width;
  o.height = height;
  o.storage = storage;
  return o;
}

class FrameBufferStorage : public testing::TestWithParam<PixelStorage> {};

TEST_P(FrameBufferStorage, BlocksOfManyThreadsMakeTheWholePicture) {
  constexpr std::int64_t kWidth = 203, kHeight = 97;
  const std::vector<double> rgba = test::mixed_pixels(kWidth, kHeight);
  FrameBufferOptions o = options(kWidth, kHeight, GetParam());
  o.encoding = {2.2, false};
  o.layers = {"cost", "depth.Z"};
  FrameBuffer whole(o), pieces(o), encoded(o);
  std::vector<float> cost(static_cast<std::size_t>(kWidth * kHeight)), depth(cost.size());
  for (std::size_t i = 0; i < cost.size(); ++i) {
    cost[i] = static_cast<float>(i);
    depth[i] = -static_cast<float>(i);
  }
  whole.put(PixelBlock{0, 0, kWidth, kHeight, rgba, {cost, depth}});

  const std::vector<Rectangle> blocks = shuffled_blocks(kWidth, kHeight, 13, 5);
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i; (i = next++) < blocks.size();) {
      const Rectangle& r = blocks[i];
      const std::vector<double> part = cut(rgba, kWidth, r);
      std::vector<float> part_cost, part_depth;
      for (std::int64_t y = r.y; y < r.y + r.height; ++y)
        for (std::int64_t x = r.x; x < r.x + r.width; ++x) {
          part_cost.push_back(static_cast<float>(y * kWidth + x));
          part_depth.push_back(-static_cast<float>(y * kWidth + x));
        }
      const PixelBlock block{r.x, r.y, r.width, r.height, part, {part_cost, part_depth}};
      pieces.put(block);
      encoded.put(encode_block(block, GetParam(), encoded.encoder()));
    }
  };
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i) threads.emplace_back(work);
    // Somebody looks on meanwhile.
    std::vector<std::uint8_t> row(pieces.row_bytes());
    for (std::int64_t y = 0; y < kHeight; ++y) pieces.read_row(y, row.data());
  }
  EXPECT_TRUE(pieces.complete());
  EXPECT_TRUE(encoded.complete());
  EXPECT_EQ(pieces.statistics(), whole.statistics());
  EXPECT_EQ(encoded.statistics(), whole.statistics());
  EXPECT_GT(whole.statistics().negative, 0U);
  for (std::int64_t y = 0; y < kHeight; ++y) {
    EXPECT_EQ(std::memcmp(whole.row(y), pieces.row(y), whole.row_bytes()), 0) << y;
    EXPECT_EQ(std::memcmp(whole.row(y), encoded.row(y), whole.row_bytes()), 0) << y;
    for (int layer = 0; layer < 2; ++layer) {
      const float sign = layer == 0 ? 1.0F : -1.0F;
      EXPECT_EQ(pieces.layer_row(layer, y)[kWidth - 1], sign * static_cast<float>(y * kWidth + kWidth - 1));
      EXPECT_EQ(std::memcmp(whole.layer_row(layer, y), encoded.layer_row(layer, y), kWidth * sizeof(float)),
                0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, FrameBufferStorage,
                         testing::Values(PixelStorage::kByte, PixelStorage::kWord, PixelStorage::kFloat,
                                         PixelStorage::kExponential));

TEST(FrameBuffer, StoresWhatTheFormatNeeds) {
  const std::vector<double> pixel = {0.25, 1.5, -0.5, 0.5};
  const auto stored = [&](PixelStorage storage) {
    FrameBufferOptions o = options(1, 1, storage);
    o.encoding = {2, false};
    FrameBuffer buffer(o);
    buffer.put(PixelBlock{0, 0, 1, 1, pixel, {}});
    return std::vector<std::uint8_t>(buffer.row(0), buffer.row(0) + buffer.row_bytes());
  };
  EXPECT_EQ(stored(PixelStorage::kByte), (std::vector<std::uint8_t>{127, 255, 0, 127}));
  const auto words = stored(PixelStorage::kWord);
  std::uint16_t w[4];
  ASSERT_EQ(words.size(), sizeof w);
  std::memcpy(w, words.data(), sizeof w);
  EXPECT_EQ(w[0], 32767);
  EXPECT_EQ(w[1], 65535);
  EXPECT_EQ(w[2], 0);
  EXPECT_EQ(w[3], 32767);
  const auto floats = stored(PixelStorage::kFloat);
  float f[4];
  ASSERT_EQ(floats.size(), sizeof f);
  std::memcpy(f, floats.data(), sizeof f);
  EXPECT_EQ(f[0], 0.25F);  // linear, whatever the gamma
  EXPECT_EQ(f[1], 1.5F);
  EXPECT_EQ(f[2], -0.5F);
  EXPECT_EQ(f[3], 0.5F);
  const auto exponential = stored(PixelStorage::kExponential);
  const auto expected = ColorEncoder({2, false}).exponential(0.25, 1.5, -0.5);
  ASSERT_EQ(exponential.size(), 5U);
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), exponential.begin()));
  EXPECT_EQ(exponential[4], 127);
}

TEST(FrameBuffer, KnowsWhichPixelsAreThere) {
  FrameBuffer buffer(options(150, 4));
  const std::vector<double> rgba(4 * 70 * 2, 1.0);
  buffer.put(PixelBlock{60, 1, 70, 2, rgba, {}});
  EXPECT_EQ(buffer.present(), 140);
  EXPECT_FALSE(buffer.is_present(59, 1));
  EXPECT_TRUE(buffer.is_present(60, 1));
  EXPECT_TRUE(buffer.is_present(129, 2));
  EXPECT_FALSE(buffer.is_present(130, 2));
  EXPECT_FALSE(buffer.is_present(60, 0));
  EXPECT_FALSE(buffer.row_complete(1));
  EXPECT_EQ(buffer.row(1)[4 * 59 + 3], 0);  // missing: black, alpha 0
  EXPECT_EQ(buffer.row(1)[4 * 60 + 3], 255);

  // A lease that lapsed and came back is counted once; an overlap by its new pixels.
  buffer.put(PixelBlock{60, 1, 70, 2, rgba, {}});
  EXPECT_EQ(buffer.present(), 140);
  const std::vector<double> row(4 * 150, 0.5);
  buffer.put(PixelBlock{0, 1, 150, 1, row, {}});
  EXPECT_EQ(buffer.present(), 220);
  EXPECT_TRUE(buffer.row_complete(1));
  EXPECT_FALSE(buffer.complete());
  for (const std::int64_t y : {0, 2, 3}) buffer.put(PixelBlock{0, y, 150, 1, row, {}});
  EXPECT_TRUE(buffer.complete());

  buffer.clear();
  EXPECT_EQ(buffer.present(), 0);
  EXPECT_FALSE(buffer.is_present(60, 1));
  EXPECT_EQ(buffer.row(1)[4 * 60 + 3], 0);
}

TEST(FrameBuffer, CountsOddPixelsOnce) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const std::vector<double> rgba = {kNan, kNan, -1, 1, -0.1, 0, 0, 1, 0, kInf, 0, 1, 1e308, 1e308, 1e308, 1};
  FrameBuffer buffer(options(2, 2));
  const PixelBlock block{0, 0, 2, 2, rgba, {}};
  buffer.put(block);
  buffer.put(block);
  EXPECT_EQ(buffer.statistics(), (PixelStatistics{1, 2, 1}));
}

TEST(FrameBuffer, CountsOddPixelsOnceWhereBlocksOverlap) {
  FrameBuffer buffer(options(200, 40));
  const auto negative = [](std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height) {
    const std::vector<double> rgba(static_cast<std::size_t>(4 * width * height), -1);
    return encode_block({x, y, width, height, rgba, {}}, PixelStorage::kByte, ColorEncoder(ColorEncoding{}));
  };
  for (const std::int64_t x : {50, 0, 100, 90})
    for (const std::int64_t y : {0, 13}) buffer.put(negative(x, y, 100, 20));
  EXPECT_EQ(buffer.statistics().negative, 200U * 33);
  EncodedBlock wrong = negative(0, 0, 4, 4);
  wrong.odd.pop_back();
  EXPECT_THROW(buffer.put(wrong), std::invalid_argument);
}

TEST(FrameBuffer, RefusesWhatDoesNotFit) {
  FrameBuffer buffer(options(10, 10));
  const std::vector<double> four(16, 0.5);
  EXPECT_THROW(buffer.put(PixelBlock{9, 0, 2, 2, four, {}}), std::invalid_argument);
  EXPECT_THROW(buffer.put(PixelBlock{-1, 0, 2, 2, four, {}}), std::invalid_argument);
  EXPECT_THROW(buffer.put(PixelBlock{0, std::numeric_limits<std::int64_t>::max(), 2, 2, four, {}}),
               std::invalid_argument);
  EXPECT_THROW(buffer.put(PixelBlock{0, 0, 3, 2, four, {}}), std::invalid_argument);
  EXPECT_THROW(buffer.put(PixelBlock{0, 0, -2, -2, four, {}}), std::invalid_argument);
  const std::vector<float> layer(4);
  EXPECT_THROW(buffer.put(PixelBlock{0, 0, 2, 2, four, {layer}}), std::invalid_argument);
  EncodedBlock encoded = encode_block(PixelBlock{0, 0, 2, 2, four, {}}, PixelStorage::kWord, ColorEncoder());
  EXPECT_THROW(buffer.put(encoded), std::invalid_argument);
  EXPECT_EQ(buffer.present(), 0);
  EXPECT_THROW(FrameBuffer(options(0, 5)), std::invalid_argument);
  EXPECT_THROW(FrameBuffer(options(5, std::int64_t{1} << 31)), std::invalid_argument);
}

// 20,000 x 20,000 with 64-bit offsets: the far corner is written and read; untouched pages cost nothing.
TEST(FrameBuffer, HoldsHugePictures) {
  FrameBufferOptions o = options(20000, 20000, PixelStorage::kFloat);
  o.spill_threshold = ~std::uint64_t{0};
  FrameBuffer buffer(o);
  const std::vector<double> rgba(4 * 4, 0.75);
  buffer.put(PixelBlock{19998, 19998, 2, 2, rgba, {}});
  EXPECT_EQ(buffer.present(), 4);
  float corner[4];
  std::memcpy(corner, buffer.row(19999) + 19999 * 16, sizeof corner);
  EXPECT_EQ(corner[0], 0.75F);
}

TEST(FrameBuffer, LivesInAFileAboveTheThreshold) {
  FrameBufferOptions o = options(300, 200);
  o.spill_threshold = 1000;
  o.spill_directory = testing::TempDir();
  FrameBuffer buffer(o), plain(options(300, 200));
  const std::vector<double> rgba = test::mixed_pixels(300, 200);
  test::fill(buffer, rgba);
  test::fill(plain, rgba);
  for (std::int64_t y = 0; y < 200; ++y)
    EXPECT_EQ(std::memcmp(buffer.row(y), plain.row(y), plain.row_bytes()), 0);
  buffer.clear();
  EXPECT_EQ(buffer.row(7)[5], 0);
  o.spill_directory = "/nonexistent/directory";
  EXPECT_THROW(FrameBuffer{o}, std::system_error);
}

TEST(MappedMemory, ChoosesItsBacking) {
  EXPECT_FALSE(MappedMemory(4096).file_backed());
  MappedMemory file(10000, testing::TempDir());
  EXPECT_TRUE(file.file_backed());
  file.data()[9999] = 7;
  MappedMemory moved(std::move(file));
  EXPECT_EQ(moved.data()[9999], 7);
  moved.clear();
  EXPECT_EQ(moved.data()[9999], 0);
  EXPECT_EQ(MappedMemory(0).data(), nullptr);
}

TEST(FrameBuffer, FindsLayersByName) {
  FrameBufferOptions o = options(2, 2);
  o.layers = {"normal.X", "cost"};
  const FrameBuffer buffer(o);
  EXPECT_EQ(buffer.layer_index("cost"), 1);
  EXPECT_EQ(buffer.layer_index("normal.Y"), -1);
}

}  // namespace
}  // namespace rayshade
