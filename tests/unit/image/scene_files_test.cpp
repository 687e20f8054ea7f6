// SPDX-License-Identifier: MIT
// Colour maps (textures.md 4) and height fields (objects.md 5.2).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "rayshade/image/color_map.h"
#include "rayshade/image/height_field_file.h"

namespace rayshade {
namespace {

using testing::HasSubstr;

TEST(ColorMapFile, OneEntryPerLine) {
  const ColorMap map = read_color_map("255 0 128 and words\n  -10\t300 +7\r\n0 0 1");
  EXPECT_EQ(map[0], (Color{1.0 / 255 * 255, 0, 1.0 / 255 * 128}));
  EXPECT_EQ(map[1], (Color{1.0 / 255 * -10, 1.0 / 255 * 300, 1.0 / 255 * 7}));
  EXPECT_EQ(map[2].b, 1.0 / 255);
  EXPECT_EQ(map[3], Color{});
  EXPECT_EQ(map[255], Color{});
  EXPECT_EQ(read_color_map("")[0], Color{});
}

TEST(ColorMapFile, ReadsTwoHundredAndFiftySixLines) {
  std::string text;
  for (int i = 0; i < 256; ++i) text += std::to_string(i) + " 1 2\n";
  EXPECT_EQ(read_color_map(text + "not a colour\n")[255].r, 1.0 / 255 * 255);
}

TEST(ColorMapFile, NamesTheLineOfAnError) {
  const auto line = [](const std::string& text) {
    try {
      read_color_map(text);
    } catch (const ColorMapError& error) {
      EXPECT_THAT(error.what(), HasSubstr("line " + std::to_string(error.line) + ":"));
      return error.line;
    }
    return 0;
  };
  EXPECT_EQ(line("1 2 3\n1 2\n"), 2);
  EXPECT_EQ(line("1 2 3\n\n1 2 3\n"), 2);
  EXPECT_EQ(line("x"), 1);
  EXPECT_EQ(line("1 2 +-3"), 1);
  EXPECT_EQ(line("1 2 99999999999"), 1);
  EXPECT_EQ(line("1 2 3\n4 5 6\n"), 0);
}

std::string words(std::initializer_list<std::uint32_t> values, bool little) {
  std::string out;
  for (const std::uint32_t v : values)
    for (int i = 0; i < 4; ++i) out += static_cast<char>(v >> 8 * (little ? i : 3 - i) & 255);
  return out;
}

std::uint32_t bits(float value) { return std::bit_cast<std::uint32_t>(value); }

TEST(HeightFieldFile, BothByteOrders) {
  for (const bool little : {true, false}) {
    const HeightFieldData field =
        read_height_field(words({2, bits(0.5F), bits(-2), bits(-999.5F), bits(7)}, little) + "rest");
    EXPECT_EQ(field.size, 2);
    EXPECT_EQ(field.at(0, 0), 0.5F);
    EXPECT_EQ(field.at(1, 0), -2);
    EXPECT_EQ(field.at(0, 1), -999.5F);
    EXPECT_EQ(field.at(1, 1), 7);
    EXPECT_TRUE(HeightFieldData::is_set(field.at(0, 1)));
  }
}

TEST(HeightFieldFile, UnsetPoints) {
  const HeightFieldData field = read_height_field(
      words({2, bits(-1000), bits(-5000), bits(std::numeric_limits<float>::quiet_NaN()), bits(1)}, true));
  EXPECT_EQ(field.altitudes, (std::vector<float>{-1000, -1000, -1000, 1}));
  EXPECT_FALSE(HeightFieldData::is_set(field.at(0, 0)));
}

TEST(HeightFieldFile, Errors) {
  const auto reason = [](const std::string& file) -> std::string {
    try {
      read_height_field(file);
    } catch (const HeightFieldError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_THAT(reason(""), HasSubstr("too short"));
  EXPECT_THAT(reason("abc"), HasSubstr("too short"));
  EXPECT_THAT(reason(words({1, 0, 0, 0, 0}, true)), HasSubstr("1 points per side"));
  EXPECT_THAT(reason(words({1, 0, 0, 0, 0}, false)), HasSubstr("1 points per side"));
  EXPECT_THAT(reason(words({0}, true)), HasSubstr("0 points per side"));
  EXPECT_THAT(reason(words({0xffffffff}, true)), HasSubstr("-1 points per side"));
  EXPECT_THAT(reason(words({3, 0, 0, 0}, true)), HasSubstr("3 x 3 altitudes are announced, 3 are there"));
  EXPECT_THAT(reason(words({3, 0, 0, 0}, false)), HasSubstr("3 x 3 altitudes are announced, 3 are there"));
  EXPECT_THAT(reason(words({2, 0, bits(std::numeric_limits<float>::infinity()), 0, 0}, true)),
              HasSubstr("altitude number 1 is infinite"));
}

}  // namespace
}  // namespace rayshade
