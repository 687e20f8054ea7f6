// SPDX-License-Identifier: MIT
// Renders every scene of scenes/ small and compares it with the picture kept beside this file: every pixel
// must be equal, for pictures depend on nothing but the scene. Where one differs, the new picture and an
// amplified difference are left in the build folder. RAYSHADE_UPDATE_GOLDEN=1 writes the kept pictures anew;
// look at them before keeping them.
#include <gtest/gtest.h>

#include <algorithm>

#include "rayshade/image/reader.h"
#include "tests/program/run.h"

namespace rayshade::testing_tools {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> scenes() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(std::string(SOURCE_DIR) + "/scenes")) {
    if (entry.path().extension() == ".ray") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

class GateTest : public ::testing::TestWithParam<std::string> {};

TEST_P(GateTest, PictureIsTheKeptOne) {
  const std::string name = GetParam();
  const fs::path golden = std::string(SOURCE_DIR) + "/tests/gate/" + name + ".png";
  const fs::path left = fs::path(BINARY_DIR) / "gate";
  fs::create_directories(left);
  const fs::path picture = left / (name + ".png");
  Folder folder;
  for (const auto& entry : fs::directory_iterator(std::string(SOURCE_DIR) + "/scenes")) {
    if (entry.is_regular_file()) fs::create_symlink(entry.path(), folder.path() / entry.path().filename());
  }
  const Outcome done =
      run(folder.path(), "-q -R 160 120 -S 2 -N 1 -O '" + picture.string() + "' " + name + ".ray", {}, 120);
  ASSERT_EQ(done.status, 0) << done.err;
  if (std::getenv("RAYSHADE_UPDATE_GOLDEN"))
    fs::copy_file(picture, golden, fs::copy_options::overwrite_existing);
  ASSERT_TRUE(fs::exists(golden)) << "there is no kept picture " << golden;
  const Image expected = read_image(read_file(golden));
  const Image found = read_image(read_file(picture));
  ASSERT_EQ(found.width, expected.width);
  ASSERT_EQ(found.height, expected.height);
  EXPECT_TRUE(found.bytes == expected.bytes)
      << "compare with: compare_pictures " << golden << " " << picture << " --diff diff.png";
}

INSTANTIATE_TEST_SUITE_P(Scenes, GateTest, ::testing::ValuesIn(scenes()), [](const auto& scene) {
  std::string name = scene.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(GateTest, ThereAreScenes) { EXPECT_GE(scenes().size(), 12u); }

}  // namespace
}  // namespace rayshade::testing_tools
