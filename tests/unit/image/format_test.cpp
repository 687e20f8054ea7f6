// SPDX-License-Identifier: MIT
// Names of formats, of numbered files, of partial files.
#include "rayshade/image/format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/image/pictures.h"

namespace rayshade {
namespace {

TEST(Format, NamesAreTheirOwnInverse) {
  for (const FileFormat format : test::all_formats()) EXPECT_EQ(format_by_name(format_name(format)), format);
  EXPECT_EQ(format_by_name("png8"), FileFormat::kPng8);
}

TEST(Format, UnknownNamesListTheChoices) {
  for (const char* name : {"", "jpeg", "PNG", "png ", "png32"}) {
    try {
      format_by_name(name);
      ADD_FAILURE() << name;
    } catch (const FormatError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("png16"));
    }
  }
}

TEST(Format, BySuffix) {
  EXPECT_EQ(format_by_suffix("a.png"), FileFormat::kPng8);
  EXPECT_EQ(format_by_suffix("/x.ppm/A.PFM"), FileFormat::kPfm);
  EXPECT_EQ(format_by_suffix("b.ppm"), FileFormat::kPpm);
  EXPECT_EQ(format_by_suffix("b.tar.rle"), FileFormat::kRle);
  EXPECT_EQ(format_by_suffix("b.img"), FileFormat::kRaw);
  EXPECT_EQ(format_by_suffix("b.raw"), FileFormat::kRaw);
  for (const char* path : {"", "-", "png", ".png", "a/.png", "a.png/b", "a.jpg", "a."})
    EXPECT_FALSE(format_by_suffix(path).has_value()) << path;
}

TEST(Format, ExrIsEitherThereOrExplained) {
#ifdef RAYSHADE_HAVE_OPENEXR
  EXPECT_EQ(format_by_suffix("a.exr"), FileFormat::kExr);
#else
  EXPECT_THROW(format_by_suffix("a.exr"), FormatError);
  EXPECT_THROW(format_by_name("exr"), FormatError);
#endif
}

TEST(Format, NumberedNames) {
  EXPECT_EQ(numbered_name("out.%04d.png", 7), "out.0007.png");
  EXPECT_EQ(numbered_name("%d", 12345), "12345");
  EXPECT_EQ(numbered_name("a%02d", 123), "a123");
  EXPECT_EQ(numbered_name("a%03d", -5), "a-05");
  EXPECT_EQ(numbered_name("100%%_%d", 1), "100%_1");
  EXPECT_EQ(numbered_name("plain.png", 1), "plain.png");
  EXPECT_EQ(numbered_name("{}%d{0}", 3), "{}3{0}");
  EXPECT_TRUE(is_numbered("%05d"));
  EXPECT_FALSE(is_numbered("100%%d"));
  for (const char* bad : {"%", "%s", "a%d%d", "%0d", "%00d", "%4d", "%010d", "%ld", "%-4d", "%n", "%04",
                          "x%04s", "% d", "%d%", "%d%%%"})
    EXPECT_THROW(numbered_name(bad, 1), FormatError) << bad;
}

TEST(Format, PartialNames) {
  EXPECT_EQ(partial_name("a/b.png"), "a/b.partial.png");
  EXPECT_EQ(partial_name("a.dir/b"), "a.dir/b.partial");
  EXPECT_EQ(partial_name(".hidden"), ".hidden.partial");
  EXPECT_EQ(partial_name("b.0001.exr"), "b.0001.partial.exr");
}

TEST(Format, Properties) {
  EXPECT_TRUE(can_append(FileFormat::kRle));
  EXPECT_TRUE(can_append(FileFormat::kRaw));
  EXPECT_TRUE(can_append(FileFormat::kPpm));
  EXPECT_TRUE(can_append(FileFormat::kPfm));
  EXPECT_FALSE(can_append(FileFormat::kPng8));
  EXPECT_FALSE(can_append(FileFormat::kPng16));
  EXPECT_FALSE(can_append(FileFormat::kExr));
  EXPECT_FALSE(has_alpha(FileFormat::kRaw));
  EXPECT_TRUE(has_alpha(FileFormat::kRleExponential));
  EXPECT_TRUE(is_linear(FileFormat::kPfm));
  EXPECT_FALSE(is_linear(FileFormat::kPng16));
}

}  // namespace
}  // namespace rayshade
