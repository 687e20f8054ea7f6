// SPDX-License-Identifier: MIT
// A run whose intersector lies ends as the manual says: told on standard error, and by its exit status.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "rayshade/cli/program.h"
#include "tests/program/run.h"
#include "tests/unit/geometry/lying_intersector.h"

namespace rayshade {
namespace {

using test::LyingIntersector;
using ::testing::HasSubstr;
using testing_tools::Folder;
using testing_tools::read_file;

class LyingEngine : public LocalEngine {
 public:
  LyingEngine(std::uint64_t every_nearest, std::uint64_t every_occlusion)
      : every_nearest_(every_nearest), every_occlusion_(every_occlusion) {}
  void adjust(const Options&, RenderOptions& options) const override {
    options.wrap = [this](const CompiledScene&, std::unique_ptr<Intersector> inner) {
      return std::make_unique<LyingIntersector>(std::move(inner), every_nearest_, every_occlusion_);
    };
  }

 private:
  std::uint64_t every_nearest_, every_occlusion_;
};

class VerifyRunTest : public ::testing::Test {
 protected:
  void SetUp() override {
    testing_tools::write_file(folder_.path() / "scene.ray",
                              "screen 24 18 sample 1 nojitter light 1 point 3 -8 6\n"
                              "sphere reflect .3 specular 1 1 1 2 0 0 0 plane 0 0 -2 0 0 1\n");
  }
  /// Runs with an intersector that lies now and then.
  int go(std::vector<std::string> arguments, std::uint64_t every_nearest, std::uint64_t every_occlusion) {
    for (const char* word : {"-q", "--threads", "2", "-O"}) arguments.emplace_back(word);
    arguments.push_back(path("a.ppm"));
    arguments.push_back(path("scene.ray"));
    ::testing::internal::CaptureStderr();
    LyingEngine engine(every_nearest, every_occlusion);
    const int code = run_program(arguments, engine);
    err_ = ::testing::internal::GetCapturedStderr();
    return code;
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  bool picture_is_there() const { return std::filesystem::exists(path("a.ppm")); }

  Folder folder_;
  std::string err_;
};

TEST_F(VerifyRunTest, LiesEndWithStatus4AndTheWholePicture) {
  for (const bool about_shadows : {false, true}) {
    EXPECT_EQ(
        go({"--verify", "1", "--stats", path("s.json")}, about_shadows ? 0 : 50, about_shadows ? 50 : 0),
        kDiffers);
    EXPECT_TRUE(picture_is_there());
    EXPECT_THAT(err_, HasSubstr("pixel "));
    EXPECT_THAT(err_, HasSubstr("than brute force gives"));
    EXPECT_THAT(err_, HasSubstr(about_shadows ? "toward light 1 (point)" : "nearest hit of a"));
    const auto stats = nlohmann::json::parse(read_file(path("s.json")));
    EXPECT_EQ(stats["outcome"], "differs");
    EXPECT_GT(stats["verification"]["differing"], 0);
    EXPECT_EQ(stats["verification"]["nearest"], stats["rays"]["nearest_queries"]);
    EXPECT_EQ(stats["verification"]["occlusion"], stats["rays"]["occlusion_queries"]);
    std::filesystem::remove(path("a.ppm"));
  }
}

TEST_F(VerifyRunTest, LiesAreOnlyFoundWhereTheyAreLookedFor) {
  EXPECT_EQ(go({}, 50, 50), kComplete);
  EXPECT_EQ(err_, "");
  EXPECT_EQ(go({"--verify", "0"}, 50, 50), kComplete);
  EXPECT_EQ(go({"--verify", "100%"}, 0, 0), kComplete);
  EXPECT_EQ(err_, "");
}

TEST_F(VerifyRunTest, ExplainedPixelsAreVerifiedToo) {
  EXPECT_EQ(go({"--verify", "1", "--explain", "12", "9"}, 1, 0), kDiffers);
  EXPECT_THAT(err_, HasSubstr("pixel 12 9, sample 0"));
}

}  // namespace
}  // namespace rayshade
