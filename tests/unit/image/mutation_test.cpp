// SPDX-License-Identifier: MIT
// Damaged pictures: whatever the bytes, a reader gives an Image that is consistent or throws ImageError.
#include <gtest/gtest.h>

#include <random>

#include "rayshade/image/color_map.h"
#include "rayshade/image/height_field_file.h"
#include "rayshade/image/reader.h"
#include "tests/unit/image/pictures.h"

namespace rayshade {
namespace {

void read_any(const std::string& file) {
  try {
    const Image image = read_image(file);
    ASSERT_GE(image.width, 1);
    ASSERT_GE(image.height, 1);
    ASSERT_TRUE(image.channels == 1 || image.channels == 3);
    const auto samples = static_cast<std::size_t>(image.width * image.height * image.samples_per_pixel());
    ASSERT_EQ(image.depth == 8    ? image.bytes.size()
              : image.depth == 16 ? image.words.size()
                                  : image.floats.size(),
              samples);
  } catch (const ImageError& error) {
    ASSERT_STRNE(error.what(), "");
  }
  try {
    const RleInfo info = inspect_rle(file);
    ASSERT_LE(info.size, file.size());
    ASSERT_LE(info.rows, info.height);
  } catch (const ImageError&) {
    // Most of these are no RLE files.
  }
}

std::string damage(std::string file, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  for (int edits = 1 + static_cast<int>(below(4)); edits > 0 && !file.empty(); --edits) {
    // Headers are short; half of the edits go there.
    const std::size_t at = below(random() % 2 == 0 ? std::min<std::size_t>(file.size(), 48) : file.size());
    switch (below(6)) {
      case 0:
        file[at] = static_cast<char>(file[at] ^ (1 << below(8)));
        break;
      case 1:
        file[at] = static_cast<char>(random());
        break;
      case 2:
        file[at] = static_cast<char>(random() % 2 == 0 ? 0 : 255);
        break;
      case 3:
        file.resize(at);
        break;
      case 4:
        file.erase(at, 1 + below(8));
        break;
      default:
        file.insert(at, file.substr(below(file.size()), below(16)));
        break;
    }
  }
  return file;
}

class Mutation : public testing::TestWithParam<std::string> {};

TEST_P(Mutation, NeverBreaksAReader) {
  constexpr unsigned kSeed = 4711;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  const std::string& file = GetParam();
  for (int i = 0; i < 1500; ++i) {
    read_any(damage(file, random));
    if (HasFatalFailure()) FAIL() << "mutation " << i;
  }
}

TEST_P(Mutation, NeverBreaksAReaderByTruncation) {
  const std::string& file = GetParam();
  const std::size_t step = std::max<std::size_t>(1, file.size() / 500);
  for (std::size_t length = 0; length < file.size(); length += length < 100 ? 1 : step)
    read_any(file.substr(0, length));
}

std::vector<std::string> samples() {
  std::vector<std::string> files = {"P2\n2 2 # two\n10\n0 5\n10 9\n", "P3 1 1 255 1 2 3",
                                    "Pf\n1 2\n-1.0\nabcdefgh"};
  for (const FileFormat format : test::all_formats())
    if (format != FileFormat::kExr)
      for (const bool alpha : {true, false}) files.push_back(test::mixed_file(format, 19, 13, alpha));
  return files;
}

INSTANTIATE_TEST_SUITE_P(Files, Mutation, testing::ValuesIn(samples()),
                         [](const auto& param) { return "sample" + std::to_string(param.index); });

TEST(MutationOfSmallFiles, ColorMapsAndHeightFields) {
  std::mt19937 random(12);
  std::string map, field = std::string("\x03\0\0\0", 4) + std::string(36, '\x3f');
  for (int i = 0; i < 256; ++i) map += std::to_string(i) + " 0 255\n";
  for (int i = 0; i < 3000; ++i) {
    try {
      read_color_map(damage(map, random));
    } catch (const ColorMapError& error) {
      ASSERT_GE(error.line, 1);
      ASSERT_LE(error.line, 256);
    }
    try {
      const HeightFieldData data = read_height_field(damage(field, random));
      ASSERT_EQ(data.altitudes.size(),
                static_cast<std::size_t>(data.size) * static_cast<std::size_t>(data.size));
    } catch (const HeightFieldError& error) {
      ASSERT_STRNE(error.what(), "");
    }
  }
}

}  // namespace
}  // namespace rayshade
