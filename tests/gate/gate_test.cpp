// SPDX-License-Identifier: MIT
// Renders every scene of scenes/ small and compares it with the picture kept beside this file: every pixel
// must be equal, for pictures depend on nothing but the scene. Where one differs, the new picture and an
// amplified difference are left in the build folder, under gate/. RAYSHADE_UPDATE_GOLDEN=1 writes the kept
// pictures anew; look at them before keeping them.
#include <gtest/gtest.h>

#include <algorithm>

#include "rayshade/image/reader.h"
#include "tests/program/run.h"

namespace rayshade::testing_tools {
namespace {

namespace fs = std::filesystem;

/// The stems of the files in a folder of the source that have this suffix, in order.
std::vector<std::string> stems(const std::string& folder, const std::string& suffix) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(std::string(SOURCE_DIR) + folder)) {
    if (entry.path().extension() == suffix) names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

class GateTest : public ::testing::TestWithParam<std::string> {};

TEST_P(GateTest, PictureIsTheKeptOne) {
  const std::string name = GetParam();
  const fs::path golden = std::string(SOURCE_DIR) + "/tests/gate/" + name + ".png";
  Folder folder;
  for (const auto& entry : fs::directory_iterator(std::string(SOURCE_DIR) + "/scenes")) {
    if (entry.is_regular_file()) fs::create_symlink(entry.path(), folder.path() / entry.path().filename());
  }
  const fs::path picture = folder.path() / "out" / (name + ".png");
  fs::create_directory(picture.parent_path());
  const Outcome done =
      run(folder.path(), "-q -R 160 120 -S 2 -N 1 -O '" + picture.string() + "' " + name + ".ray", {}, 120);
  ASSERT_EQ(done.status, 0) << done.err;
  if (std::getenv("RAYSHADE_UPDATE_GOLDEN"))
    fs::copy_file(picture, golden, fs::copy_options::overwrite_existing);
  ASSERT_TRUE(fs::exists(golden)) << "there is no kept picture " << golden;
  const Image expected = read_image(read_file(golden));
  const Image found = read_image(read_file(picture));
  ASSERT_FALSE(expected.bytes.empty());
  if (found.width == expected.width && found.height == expected.height && found.bytes == expected.bytes)
    return;
  // Several gates may run at once (with other processor features, or other compilers' programs).
  const fs::path left = fs::path(BINARY_DIR) / "gate" / std::to_string(getpid());
  fs::create_directories(left);
  fs::copy_file(picture, left / (name + ".png"), fs::copy_options::overwrite_existing);
  const std::string compare = std::string(BINARY_DIR) + "/bin/compare_pictures '" + golden.string() + "' '" +
                              picture.string() + "' --diff '" + (left / (name + "-diff.png")).string() +
                              "' >'" + (folder.path() / "report").string() + "' 2>&1";
  const int status = std::system(compare.c_str());
  FAIL() << read_file(folder.path() / "report") << "(exit status " << status << ") see " << left;
}

INSTANTIATE_TEST_SUITE_P(Scenes, GateTest, ::testing::ValuesIn(stems("/scenes", ".ray")),
                         [](const auto& scene) {
                           std::string name = scene.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(GateTest, ScenesAndKeptPicturesAreTheSame) {
  EXPECT_GE(stems("/scenes", ".ray").size(), 12u);
  EXPECT_EQ(stems("/scenes", ".ray"), stems("/tests/gate", ".png"));
}

}  // namespace
}  // namespace rayshade::testing_tools
