// SPDX-License-Identifier: MIT
// Pictures made by hand, from the descriptions of their formats, are read as textures.md 6.1 demands.
#include "rayshade/image/reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "tests/unit/image/pictures.h"

namespace rayshade {
namespace {

using testing::HasSubstr;

std::string bytes(std::initializer_list<int> values) {
  std::string out;
  for (const int v : values) out += static_cast<char>(v);
  return out;
}

std::string word_be(std::size_t v) {
  return bytes({static_cast<int>(v >> 24 & 255), static_cast<int>(v >> 16 & 255),
                static_cast<int>(v >> 8 & 255), static_cast<int>(v & 255)});
}

std::string reason(const std::string& file) {
  try {
    read_image(file);
  } catch (const ImageError& error) {
    return error.what();
  }
  return "no error";
}

// --- PNG, chunk by chunk ---

std::string chunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  const auto crc = crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return word_be(data.size()) + body + word_be(crc);
}

std::string png(int width, int height, int depth, int type, const std::string& rows,
                const std::string& extra = {}, int interlace = 0) {
  std::vector<Bytef> packed(compressBound(rows.size()));
  uLongf size = packed.size();
  compress(packed.data(), &size, reinterpret_cast<const Bytef*>(rows.data()), rows.size());
  return bytes({0x89, 'P', 'N', 'G', 13, 10, 26, 10}) +
         chunk("IHDR", word_be(static_cast<std::size_t>(width)) + word_be(static_cast<std::size_t>(height)) +
                           bytes({depth, type, 0, 0, interlace})) +
         extra +
         chunk("IDAT", std::string(packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(size))) +
         chunk("IEND", "");
}

TEST(PngReader, GreyWithOneBit) {
  // 3 x 2, upper row 1 0 1, lower row 0 1 0; each row is preceded by its filter type.
  const Image image = read_image(png(3, 2, 1, 0, bytes({0, 0xa0, 0, 0x40})));
  EXPECT_EQ(image.channels, 1);
  EXPECT_FALSE(image.has_alpha);
  EXPECT_EQ(image.depth, 8);
  EXPECT_EQ(image.value(0, 0, 0), 0);  // row 0 is the lower one
  EXPECT_EQ(image.value(1, 0, 0), 1);
  EXPECT_EQ(image.value(0, 1, 0), 1);
  EXPECT_EQ(image.alpha(0, 1), 1);
}

TEST(PngReader, SixteenBitsWithAlpha) {
  const Image image = read_image(png(1, 1, 16, 4, bytes({0, 0x12, 0x34, 0x80, 0x00})));
  EXPECT_EQ(image.channels, 1);
  EXPECT_TRUE(image.has_alpha);
  EXPECT_EQ(image.depth, 16);
  EXPECT_EQ(image.value(0, 0, 0), 0x1234 / 65535.0);
  EXPECT_EQ(image.alpha(0, 0), 0x8000 / 65535.0);
}

TEST(PngReader, PaletteWithTransparency) {
  const std::string palette =
      chunk("PLTE", bytes({10, 20, 30, 40, 50, 60})) + chunk("tRNS", bytes({255, 128}));
  const Image image = read_image(png(2, 1, 8, 3, bytes({0, 0, 1}), palette));
  EXPECT_EQ(image.channels, 3);
  EXPECT_TRUE(image.has_alpha);
  EXPECT_EQ(image.value(0, 0, 2), 30 / 255.0);
  EXPECT_EQ(image.value(1, 0, 0), 40 / 255.0);
  EXPECT_EQ(image.alpha(0, 0), 1);
  EXPECT_EQ(image.alpha(1, 0), 128 / 255.0);
}

TEST(PngReader, InterlacedWithGammaLeftAlone) {
  // Adam7 of 2 x 2: pass 1 holds (0,0), pass 6 holds (1,0), pass 7 the second row.
  const std::string gamma = chunk("gAMA", word_be(100000));
  const Image image = read_image(png(2, 2, 8, 0, bytes({0, 10, 0, 20, 0, 30, 40}), gamma, 1));
  EXPECT_EQ(image.value(0, 1, 0), 10 / 255.0);
  EXPECT_EQ(image.value(1, 1, 0), 20 / 255.0);
  EXPECT_EQ(image.value(0, 0, 0), 30 / 255.0);
  EXPECT_EQ(image.value(1, 0, 0), 40 / 255.0);
}

TEST(PngReader, SizesThatTheFileCannotHoldAreRefused) {
  EXPECT_THAT(reason(png(100000, 100000, 8, 6, bytes({0, 1, 2, 3, 4}))), HasSubstr("more than can be read"));
  EXPECT_THAT(reason(png(16000, 16000, 8, 6, bytes({0, 1, 2, 3, 4}))), HasSubstr("too short"));
  EXPECT_THAT(reason(png(2, 2, 8, 2, bytes({0, 1, 2, 3}))), HasSubstr("broken PNG"));
  std::string damaged = png(1, 1, 8, 0, bytes({0, 7}));
  damaged[20] = static_cast<char>(damaged[20] ^ 1);
  EXPECT_THAT(reason(damaged), HasSubstr("CRC"));
}

// --- PNM ---

TEST(PnmReader, TextWithComments) {
  const Image grey = read_image("P2\n# a comment\n2 2 # another\n10\n0 5\n10 99");
  EXPECT_EQ(grey.channels, 1);
  EXPECT_EQ(grey.value(0, 1, 0), 0);
  EXPECT_EQ(grey.value(1, 1, 0), 32768 / 65535.0);
  EXPECT_EQ(grey.value(0, 0, 0), 1);
  EXPECT_EQ(grey.value(1, 0, 0), 1);  // limited
  const Image color = read_image("P3 1 1 255 1 2 3");
  EXPECT_EQ(color.channels, 3);
  EXPECT_EQ(color.depth, 8);
  EXPECT_EQ(color.value(0, 0, 2), 3 / 255.0);
}

TEST(PnmReader, Binary) {
  const Image color = read_image("P6 1 2 255\n" + bytes({1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(color.value(0, 0, 0), 4 / 255.0);
  EXPECT_EQ(color.value(0, 1, 2), 3 / 255.0);
  const Image deep = read_image("P5\n2 1\n65535\n" + bytes({0x12, 0x34, 0xff, 0xff}));
  EXPECT_EQ(deep.depth, 16);
  EXPECT_EQ(deep.value(0, 0, 0), 0x1234 / 65535.0);
  EXPECT_EQ(deep.value(1, 0, 0), 1);
  const Image narrow = read_image("P5 2 1 15\n" + bytes({3, 15}));
  EXPECT_EQ(narrow.value(0, 0, 0), 13107 / 65535.0);
  EXPECT_EQ(narrow.value(1, 0, 0), 1);
}

TEST(PnmReader, Errors) {
  EXPECT_EQ(reason("P6"), "not a picture of a known format");
  EXPECT_EQ(reason("P6 "), "the width is missing");
  EXPECT_EQ(reason("P6 2"), "the height is missing");
  EXPECT_EQ(reason("P6 2 x"), "the height is missing");
  EXPECT_EQ(reason("P6 0 4 255 abc"), "a picture of 0 x 4 pixels");
  EXPECT_EQ(reason("P6 1 1 0 abc"), "a largest sample value of 0");
  EXPECT_EQ(reason("P6 1 1 65536 abc"), "a largest sample value of 65536");
  EXPECT_EQ(reason("P6 99999999999 1 255 abc"), "the width is too large");
  EXPECT_THAT(reason("P6 30000 30000 255 abc"), HasSubstr("more than can be read"));
  EXPECT_THAT(reason("P6 3000 3000 255 abc"), HasSubstr("too short"));
  EXPECT_THAT(reason("P6 2 1 255\nabcde"), HasSubstr("too short"));
  EXPECT_EQ(reason("P3 2 2 255 1 2 3 4 5 6 7 8 9 10 11"), "the next sample is missing");
  EXPECT_EQ(reason("P2 2 2 255 1 2 3 -4"), "the next sample is missing");
}

// --- PFM ---

TEST(PfmReader, BothByteOrders) {
  const Image little = read_image("Pf\n1 2\n-1.0\n" + bytes({0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0}));
  EXPECT_EQ(little.channels, 1);
  EXPECT_EQ(little.depth, 32);
  EXPECT_EQ(little.value(0, 0, 0), 1);
  EXPECT_EQ(little.value(0, 1, 0), -2);
  const Image big = read_image("PF 1 1 1\n" + bytes({0x3f, 0x80, 0, 0, 0xc0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(big.channels, 3);
  EXPECT_EQ(big.value(0, 0, 0), 1);
  EXPECT_EQ(big.value(0, 0, 1), -2);
  EXPECT_EQ(reason("PF 1 1"), "the scale is missing");
  EXPECT_EQ(reason("PF 1 1 -"), "the scale is missing");
  EXPECT_EQ(reason("PF 1 1 x"), "the scale is missing");
  EXPECT_THAT(reason("PF 1 1 1\nabc"), HasSubstr("too short"));
  EXPECT_THAT(reason("PF 1 1 1.0"), HasSubstr("too short"));
}

// --- the original's raw format ---

TEST(RawReader, KeepsTheOrderOfTheFile) {
  const Image image = read_image("1 2\n" + bytes({1, 2, 3, 4, 5, 6}) + "ignored");
  EXPECT_EQ(image.value(0, 0, 0), 1 / 255.0);
  EXPECT_EQ(image.value(0, 1, 0), 4 / 255.0);
  EXPECT_EQ(read_image("1 1\r\nabc").value(0, 0, 0), 'a' / 255.0);
  EXPECT_EQ(reason(""), "the file is empty");
  EXPECT_EQ(reason("hello\n"), "not a picture of a known format");
  EXPECT_EQ(reason("1 1"), "not a picture of a known format");
  EXPECT_EQ(reason("1\nabc"), "the height is missing");
  EXPECT_EQ(reason("1 1 1\nabc"), "more than width and height in the first line");
  EXPECT_THAT(reason("2 1\nabc"), HasSubstr("too short"));
  EXPECT_THAT(reason("2000000 2000000\nabc"), HasSubstr("more than can be read"));
}

// --- Utah RLE ---

std::string rle(int width, int height, int flags, int colors, const std::string& tail) {
  return bytes({0x52, 0xcc, 3, 0, 4, 0, width & 255, width >> 8, height & 255, height >> 8, flags, colors, 8,
                0, 8}) +
         tail;
}

TEST(RleReader, InstructionsOneByOne) {
  // 5 x 3, background 9 8 7. Row 0: red bytes 1 2 3 (padded), green run of 2 after a skip of 1. Row 2: blue,
  // long forms.
  const std::string body =
      bytes({2, 0, 5, 2, 1, 2, 3, 0})      // red
      + bytes({2, 1, 3, 1, 6, 1, 77, 99})  // green: skip 1, run of 2 of the low byte
      + bytes({0x41, 0, 2, 0})             // skip 2 lines, long
      + bytes({0x42, 0, 2, 0, 0x43, 0, 1, 0, 0x45, 0, 1, 0, 50, 60, 0x46, 0, 1, 0, 70, 0}) + bytes({7, 0});
  const Image image = read_image(rle(5, 3, 1, 3, bytes({9, 8, 7}) + body) + "rest");
  ASSERT_EQ(image.width, 5);
  ASSERT_EQ(image.height, 3);
  EXPECT_FALSE(image.has_alpha);
  const auto row = [&](std::int64_t y, int c) {
    std::vector<int> values;
    for (std::int64_t x = 0; x < 5; ++x)
      values.push_back(image.bytes[static_cast<std::size_t>((y * 5 + x) * 3 + c)]);
    return values;
  };
  EXPECT_EQ(row(0, 0), (std::vector<int>{1, 2, 3, 9, 9}));
  EXPECT_EQ(row(0, 1), (std::vector<int>{8, 77, 77, 8, 8}));
  EXPECT_EQ(row(0, 2), (std::vector<int>(5, 7)));
  EXPECT_EQ(row(1, 0), (std::vector<int>(5, 9)));
  EXPECT_EQ(row(2, 2), (std::vector<int>{7, 50, 60, 70, 70}));
}

TEST(RleReader, BackgroundOnlyWhereTheFlagsSaySo) {
  const std::string end = bytes({7, 0});
  EXPECT_EQ(read_image(rle(1, 1, 1, 3, bytes({9, 8, 7}) + end)).bytes, (std::vector<std::uint8_t>{9, 8, 7}));
  EXPECT_EQ(read_image(rle(1, 1, 0, 3, bytes({9, 8, 7}) + end)).bytes, (std::vector<std::uint8_t>{0, 0, 0}));
  EXPECT_EQ(read_image(rle(1, 1, 3, 3, bytes({0}) + end)).bytes, (std::vector<std::uint8_t>{0, 0, 0}));
  const Image alpha = read_image(rle(1, 1, 5, 1, bytes({9}) + end));
  EXPECT_EQ(alpha.channels, 1);
  EXPECT_EQ(alpha.bytes, (std::vector<std::uint8_t>{9, 0}));  // alpha is 0 where nothing was drawn
}

TEST(RleReader, MapsAndCommentsArePassedOver) {
  std::string file = rle(2, 1, 8, 1, bytes({0}));
  file[13] = 1;  // one map
  file[14] = 2;  // of four entries
  file += std::string(8, 'm') + bytes({5, 0}) + std::string("a=b\0c", 5) + bytes({0});
  file += bytes({2, 0, 5, 1, 11, 12, 7, 0});
  EXPECT_EQ(read_image(file).bytes, (std::vector<std::uint8_t>{11, 12}));
  EXPECT_THAT(inspect_rle(file).comments, testing::ElementsAre("a=b", "c"));
}

TEST(RleReader, DrawingOutsideIsIgnored) {
  const std::string body = bytes({2, 0, 6, 9, 5, 0})          // ten pixels into a row of two
                           + bytes({6, 200, 6, 0})            // and more
                           + bytes({2, 7, 6, 1, 6, 0})        // a channel that does not exist
                           + bytes({2, 255, 6, 1, 6, 0})      // alpha that does not exist
                           + bytes({1, 9, 2, 0, 6, 1, 8, 0})  // above the picture
                           + bytes({63, 1, 7, 0});            // an unknown instruction
  EXPECT_EQ(read_image(rle(2, 1, 2, 1, bytes({0}) + body)).bytes, (std::vector<std::uint8_t>{5, 5}));
}

TEST(RleReader, Errors) {
  const std::string end = bytes({7, 0});
  EXPECT_EQ(reason(rle(2, 2, 2, 2, bytes({0}) + end)), "2 colour channels; 1 or 3 can be read");
  EXPECT_EQ(reason(rle(2, 2, 2, 4, bytes({0}) + end)), "4 colour channels; 1 or 3 can be read");
  EXPECT_EQ(reason(rle(0, 2, 2, 3, bytes({0}) + end)), "a picture of 0 x 2 pixels");
  EXPECT_EQ(reason(rle(2, 2, 2, 3, bytes({0}) + bytes({2, 0, 1, 1}))), "the data end in row 1 of 2");
  EXPECT_EQ(reason(rle(2, 2, 2, 3, bytes({0}) + bytes({5, 9, 1, 1}))), "the data end in row 0 of 2");
  EXPECT_EQ(reason(bytes({0x52, 0xcc, 1})), "the RLE header is cut off");
  EXPECT_THAT(reason(rle(65535, 65535, 2, 3, bytes({0}) + end)), HasSubstr("more than can be read"));
  EXPECT_THAT(reason(rle(16000, 16000, 2, 3, bytes({0}) + end)), HasSubstr("too short"));
  std::string deep = rle(2, 2, 2, 3, bytes({0}) + end);
  deep[12] = 16;
  EXPECT_EQ(reason(deep), "RLE samples of 16 bits; only 8 can be read");
  std::string endless = rle(60000, 1, 2, 1, bytes({0}));
  for (int i = 0; i < 100; ++i) endless += bytes({2, 0, 0x46, 0, 255, 255, 1, 0});
  EXPECT_THAT(reason(endless + end), HasSubstr("again and again"));
}

TEST(RleReader, InspectionCountsCompleteRows) {
  FrameBuffer buffer = test::make_buffer(FileFormat::kRle, 30, 20);
  std::vector<double> rgba = test::mixed_pixels(30, 20);
  for (double& v : rgba) v += 0.3;  // no empty rows
  test::fill(buffer, rgba);
  PictureInfo info;
  info.min_x = 7;
  const std::string file = test::written(buffer, FileFormat::kRle, info);
  const RleInfo whole = inspect_rle(file);
  EXPECT_TRUE(whole.whole);
  EXPECT_EQ(whole.rows, 20);
  EXPECT_EQ(whole.x, 7);
  EXPECT_EQ(whole.width, 30);
  EXPECT_TRUE(whole.alpha);
  std::int64_t previous = 0;
  for (std::size_t length = 60; length < file.size(); ++length) {
    const RleInfo part = inspect_rle(std::string_view(file).substr(0, length));
    EXPECT_FALSE(part.whole);
    EXPECT_GE(part.rows, previous);
    EXPECT_LT(part.rows, 20);
    previous = part.rows;
  }
  EXPECT_EQ(previous, 19);
  EXPECT_THROW(inspect_rle("P6 1 1 255 abc abc"), ImageError);
}

}  // namespace
}  // namespace rayshade
