// SPDX-License-Identifier: MIT
// Pictures written are read back; headers say what they should; a sink that fails is reported.
#include "rayshade/image/writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>

#include "rayshade/image/reader.h"
#include "tests/unit/image/pictures.h"

namespace rayshade {
namespace {

using testing::HasSubstr;
using testing::Not;

// What the frame buffer holds at (x, y), sample c, as the reader should give it. Row 0 of the image is the
// bottom, except in raw files.
double expected_value(const std::vector<double>& rgba, const FrameBuffer& buffer, FileFormat format,
                      std::int64_t x, std::int64_t y, int c) {
  const double* const p = &rgba[static_cast<std::size_t>(4 * (y * buffer.width() + x))];
  if (format == FileFormat::kPfm) return static_cast<float>(p[c]);
  if (format == FileFormat::kRleExponential && c < 3) {
    const auto bytes = buffer.encoder().exponential(p[0], p[1], p[2]);
    return static_cast<float>(std::ldexp(bytes[static_cast<std::size_t>(c)], bytes[3] - 135));
  }
  const double stored = c == 3 ? p[c] : buffer.encoder().value(p[c]);
  if (format == FileFormat::kPng16) return to_word(stored) / 65535.0;
  const double byte = to_byte(stored) / 255.0;
  return format == FileFormat::kRleExponential ? static_cast<float>(byte) : byte;
}

struct RoundTripCase {
  FileFormat format;
  bool alpha;
  ColorEncoding encoding;
};

class RoundTrip : public testing::TestWithParam<RoundTripCase> {};

TEST_P(RoundTrip, GivesBackEveryPixel) {
  const auto [format, alpha, encoding] = GetParam();
  const std::pair<std::int64_t, std::int64_t> sizes[] = {{1, 1}, {1, 7}, {33, 1}, {64, 48}, {700, 11}};
  for (const auto& [width, height] : sizes) {
    SCOPED_TRACE(testing::Message() << format_name(format) << " " << width << " x " << height);
    FrameBuffer buffer = test::make_buffer(format, width, height, encoding);
    const std::vector<double> rgba = test::mixed_pixels(width, height);
    test::fill(buffer, rgba);
    PictureInfo info;
    info.alpha = alpha;
    const std::string file = test::written(buffer, format, info);
    EXPECT_EQ(file, test::written(buffer, format, info));
    const Image image = read_image(file);
    ASSERT_EQ(image.width, width);
    ASSERT_EQ(image.height, height);
    ASSERT_EQ(image.channels, 3);
    ASSERT_EQ(image.has_alpha, alpha && has_alpha(format));
    for (std::int64_t y = 0; y < height; ++y) {
      const std::int64_t row = format == FileFormat::kRaw ? y : height - 1 - y;
      for (std::int64_t x = 0; x < width; ++x)
        for (int c = 0; c < image.samples_per_pixel(); ++c)
          ASSERT_EQ(image.value(x, row, c), expected_value(rgba, buffer, format, x, y, c))
              << "at " << x << "," << y << " sample " << c;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, RoundTrip,
                         testing::Values(RoundTripCase{FileFormat::kPng8, true, {}},
                                         RoundTripCase{FileFormat::kPng8, false, {2.2, false}},
                                         RoundTripCase{FileFormat::kPng16, true, {1, true}},
                                         RoundTripCase{FileFormat::kPng16, false, {}},
                                         RoundTripCase{FileFormat::kPpm, false, {}},
                                         RoundTripCase{FileFormat::kPfm, false, {2.2, false}},
                                         RoundTripCase{FileFormat::kRle, true, {}},
                                         RoundTripCase{FileFormat::kRle, false, {2, false}},
                                         RoundTripCase{FileFormat::kRleExponential, true, {}},
                                         RoundTripCase{FileFormat::kRleExponential, false, {2, false}},
                                         RoundTripCase{FileFormat::kRaw, false, {}}));

// The chunks of a PNG by type; several of one type are concatenated.
std::map<std::string, std::string> png_chunks(const std::string& file) {
  std::map<std::string, std::string> chunks;
  for (std::size_t i = 8; i + 12 <= file.size();) {
    std::size_t length = 0;
    for (std::size_t k = 0; k < 4; ++k) length = length << 8 | static_cast<std::uint8_t>(file[i + k]);
    chunks[file.substr(i + 4, 4)] += file.substr(i + 8, length);
    i += length + 12;
  }
  return chunks;
}

std::map<std::string, std::string> png_chunks(ColorEncoding encoding, const PictureInfo& info) {
  FrameBuffer buffer = test::make_buffer(FileFormat::kPng8, 2, 2, encoding);
  return png_chunks(test::written(buffer, FileFormat::kPng8, info));
}

TEST(PngWriter, TagsTheEncodingWhenThereIsOne) {
  EXPECT_EQ(png_chunks({}, {}).count("gAMA"), 0U);
  EXPECT_EQ(png_chunks({}, {}).count("sRGB"), 0U);
  EXPECT_EQ(png_chunks({1, true}, {}).at("sRGB"), std::string(1, '\0'));
  const std::string gamma = png_chunks({2, false}, {}).at("gAMA");
  EXPECT_EQ(gamma, std::string("\x00\x00\xc3\x50", 4));  // 0.5 * 100000
  PictureInfo untagged;
  untagged.tag_encoding = false;
  EXPECT_EQ(png_chunks({2, false}, untagged).count("gAMA"), 0U);
  EXPECT_EQ(png_chunks({1, true}, untagged).count("sRGB"), 0U);
  EXPECT_EQ(png_chunks({0, false}, {}).count("gAMA"), 0U);  // an exponent of 1e14 has no tag
}

TEST(PngWriter, CarriesProvenanceAndNoDate) {
  PictureInfo info;
  info.provenance = {
      {"Software", "rayshade 5"}, {"Title", "K\xc3\xb6rper"}, {std::string(200, 'k'), "long key"}};
  const auto chunks = png_chunks({}, info);
  EXPECT_THAT(chunks.at("tEXt"), HasSubstr(std::string("Software\0rayshade 5", 19)));
  EXPECT_THAT(chunks.at("tEXt"), HasSubstr(std::string(79, 'k') + '\0'));
  EXPECT_THAT(chunks.at("iTXt"), HasSubstr("K\xc3\xb6rper"));
  EXPECT_EQ(chunks.count("tIME"), 0U);
}

TEST(PngWriter, MissingPixelsAreTransparentBlack) {
  FrameBuffer buffer = test::make_buffer(FileFormat::kPng8, 4, 4);
  const std::vector<double> one = {1, 1, 1, 1};
  buffer.put(PixelBlock{3, 0, 1, 1, one, {}});
  const Image image = read_image(test::written(buffer, FileFormat::kPng8));
  for (int c = 0; c < 4; ++c) {
    EXPECT_EQ(image.value(3, 3, c), 1);
    EXPECT_EQ(image.value(2, 3, c), 0);
    EXPECT_EQ(image.value(3, 2, c), 0);
  }
}

TEST(PlainWriter, BytesAreThoseOfTheFormats) {
  const std::vector<double> rgba = {1, 0.5, 0, 1, 0, 0.25, 1, 0};
  for (const FileFormat format : {FileFormat::kPpm, FileFormat::kRaw}) {
    FrameBuffer buffer = test::make_buffer(format, 1, 2);
    test::fill(buffer, rgba);
    const std::string header = format == FileFormat::kPpm ? "P6\n1 2\n255\n" : "1 2\n";
    EXPECT_EQ(test::written(buffer, format), header + std::string("\xff\x7f\x00\x00\x3f\xff", 6));
  }
  FrameBuffer floats = test::make_buffer(FileFormat::kPfm, 1, 2);
  test::fill(floats, rgba);
  const std::string file = test::written(floats, FileFormat::kPfm);
  ASSERT_EQ(file.substr(0, 12), "PF\n1 2\n-1.0\n");
  float samples[6];
  ASSERT_EQ(file.size(), 12 + sizeof samples);
  std::memcpy(samples, file.data() + 12, sizeof samples);
  EXPECT_EQ(samples[1], 0.25F);  // the lower row is first
  EXPECT_EQ(samples[3], 1.0F);
}

TEST(RleWriter, HeaderAndRowsByteForByte) {
  FrameBuffer buffer = test::make_buffer(FileFormat::kRle, 8, 3);
  // Bottom row: a run of eight reds of 1; middle row empty; top row: green in columns 6 and 7.
  std::vector<double> rgba(4 * 8 * 3, 0.0);
  for (std::size_t x = 0; x < 8; ++x) {
    rgba[4 * (16 + x)] = 1;
    rgba[4 * (16 + x) + 3] = 1;
  }
  rgba[4 * 6 + 1] = 0.5;
  rgba[4 * 7 + 1] = 0.25;
  test::fill(buffer, rgba);
  PictureInfo info;
  info.min_x = 10;
  info.min_y = 20;
  info.screen_width = 100;
  info.screen_height = 300;
  info.provenance = {{"HISTORY", "x"}};
  const std::string comments = std::string("display_gamma=1\0HISTORY=x\0", 26);
  const std::string expected =
      std::string("\x52\xcc\x0a\x00\x15\x01\x08\x00\x03\x00",
                  10) +                                     // window at 10, 300 - 20 - 3 = 277 from below
      std::string("\x0d\x03\x08\x00\x08\x00\x00\x00", 8) +  // flags 1 + 4 + 8, 3 colours of 8 bits, no map
      std::string("\x1a\x00", 2) +
      comments +                                            //
      std::string("\x02\xff\x06\x07\xff\x00", 6) +          // alpha: a run of 8
      std::string("\x02\x00\x06\x07\xff\x00", 6) +          // red: a run of 8
      std::string("\x01\x02", 2) +                          // up two rows
      std::string("\x02\x01\x03\x06\x05\x01\x7f\x3f", 8) +  // green: skip 6, then 2 bytes
      std::string("\x07\x00", 2);
  EXPECT_EQ(test::written(buffer, FileFormat::kRle, info), expected);
}

TEST(RleWriter, ExponentialFilesSaySo) {
  FrameBuffer buffer = test::make_buffer(FileFormat::kRleExponential, 5, 4, {2.2, false});
  test::fill(buffer, test::mixed_pixels(5, 4));
  const std::string file = test::written(buffer, FileFormat::kRleExponential);
  const RleInfo info = inspect_rle(file);
  EXPECT_TRUE(info.exponential);
  EXPECT_TRUE(info.alpha);
  EXPECT_TRUE(info.whole);
  EXPECT_EQ(info.size, file.size());
  EXPECT_THAT(info.comments, testing::ElementsAre("exponential_data", "display_gamma=2.2"));
}

TEST(RleWriter, RefusesWhatSixteenBitsCannotHold) {
  FrameBuffer wide = test::make_buffer(FileFormat::kRle, 65536, 1);
  MemorySink sink;
  EXPECT_THROW(write_picture(wide, FileFormat::kRle, {}, sink), WriteError);
  FrameBuffer small = test::make_buffer(FileFormat::kRle, 4, 4);
  PictureInfo info;
  info.min_x = 70000;
  EXPECT_THROW(write_picture(small, FileFormat::kRle, info, sink), WriteError);
  FrameBuffer widest = test::make_buffer(FileFormat::kRle, 65535, 2);
  test::fill(widest, test::mixed_pixels(65535, 2));
  EXPECT_EQ(read_image(test::written(widest, FileFormat::kRle)).width, 65535);
}

TEST(RleWriter, CommentsThatDoNotFitAreLeftOut) {
  FrameBuffer buffer = test::make_buffer(FileFormat::kRle, 4, 4);
  PictureInfo info;
  info.provenance = {{"Long", std::string(70000, 'x')}, {"Short", "y"}};
  const RleInfo read = inspect_rle(test::written(buffer, FileFormat::kRle, info));
  EXPECT_THAT(read.comments, testing::ElementsAre("display_gamma=1", "Short=y"));
  EXPECT_TRUE(read.whole);
}

TEST(Writer, ConcatenatedFramesAreFound) {
  const std::string first = test::mixed_file(FileFormat::kRle, 9, 5),
                    second = test::mixed_file(FileFormat::kRle, 4, 6);
  const std::string both = first + second;
  const RleInfo info = inspect_rle(both);
  ASSERT_EQ(info.size, first.size());
  EXPECT_EQ(read_image(std::string_view(both).substr(info.size)).height, 6);
}

TEST(Writer, InsistsOnTheStorageOfTheFormat) {
  FrameBuffer buffer = test::make_buffer(FileFormat::kPng8, 2, 2);
  MemorySink sink;
  EXPECT_THROW(write_picture(buffer, FileFormat::kPng16, {}, sink), std::invalid_argument);
  EXPECT_THROW(write_picture(buffer, FileFormat::kExr, {}, sink), std::invalid_argument);
}

class BrokenSink : public Sink {
 public:
  explicit BrokenSink(std::uint64_t limit) : limit_(limit) {}
  void write(const void*, std::size_t size) override {
    if (written_ + size > limit_) throw WriteError("cannot write \"x\": No space left on device");
    written_ += size;
  }
  std::uint64_t written() const override { return written_; }

 private:
  std::uint64_t limit_, written_ = 0;
};

class WriterFormats : public testing::TestWithParam<FileFormat> {};

TEST_P(WriterFormats, ReportsAFullDiskWhereverItHappens) {
  FrameBuffer buffer = test::make_buffer(GetParam(), 40, 30);
  test::fill(buffer, test::mixed_pixels(40, 30));
  const std::size_t size = test::written(buffer, GetParam()).size();
  std::vector<std::uint64_t> limits = {0, 1, 7, 8, 20, 40, 100, size / 2, size - 20, size - 1};
  for (const std::uint64_t limit : limits) {
    BrokenSink sink(limit);
    try {
      write_picture(buffer, GetParam(), {}, sink);
      ADD_FAILURE() << "limit " << limit << " of " << size;
    } catch (const WriteError& error) {
      EXPECT_THAT(error.what(), HasSubstr("No space left"));
    }
  }
  BrokenSink enough(size);
  write_picture(buffer, GetParam(), {}, enough);
  EXPECT_EQ(enough.written(), size);
}

TEST_P(WriterFormats, DoesNotNameTheMachineOrTheTime) {
  FrameBuffer buffer = test::make_buffer(GetParam(), 10, 10);
  const std::string file = test::written(buffer, GetParam());
  EXPECT_THAT(file, Not(HasSubstr("202")));
}

INSTANTIATE_TEST_SUITE_P(All, WriterFormats, testing::ValuesIn(test::all_formats()));

}  // namespace
}  // namespace rayshade
