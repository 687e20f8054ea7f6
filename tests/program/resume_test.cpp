// SPDX-License-Identifier: MIT
// Interrupted renderings: killed at random moments, stopped, continued, refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "tests/program/run.h"

namespace rayshade::testing_tools {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

constexpr const char* kScene =
    "sample 4\ncontrast 0 0 0\nsphere reflect .5 specular 1 1 1 3 0 0 0\n"
    "sphere reflect .5 specular 1 1 1 2 3 0 0\nplane 0 0 -2 0 0 1 texture marble\n";

class ResumeTest : public ::testing::Test {
 protected:
  Folder folder;
  fs::path path(const std::string& name) const { return folder.path() / name; }
  Outcome go(const std::string& arguments) { return run(folder.path(), arguments); }
  void scene(const std::string& screen, const std::string& text = kScene) {
    write_file(path("a.ray"), "screen " + screen + "\n" + text);
  }
  /// Sends a signal after a while; returns the exit code, 128 + signal where it was killed.
  int interrupt(const std::string& arguments, int signal, int milliseconds) {
    const pid_t child = fork();
    if (child == 0) {
      if (chdir(folder.path().c_str()) != 0 || !freopen("log", "w", stderr)) _exit(127);
      execl("/bin/sh", "sh", "-c", ("exec '" + program() + "' " + arguments).c_str(), nullptr);
      _exit(127);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    kill(child, signal);
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  nlohmann::json stats() const { return nlohmann::json::parse(read_file(path("s.json"))); }

  /// Kills it again and again until it is complete; the picture is that of a run without a kill, and no run
  /// renders again what an earlier one had finished.
  void kill_and_go_on(int kills) {
    const unsigned seed = std::random_device{}();
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    scene("500 400");
    ASSERT_EQ(go("-q --no-journal -O whole.png a.ray").status, 0);
    const std::string whole = read_file(path("whole.png"));
    int killed = 0;
    for (int tries = 0; killed < kills && tries < 10 * kills; ++tries) {
      fs::remove(path("a.png"));
      const int threads = 1 + static_cast<int>(random() % 3);
      const int wait = static_cast<int>(random() % 500U) * kTimeFactor;
      if (interrupt("-q --block 16 -O a.png --threads " + std::to_string(threads) + " a.ray", SIGKILL,
                    wait) == 0)
        continue;
      ++killed;
      EXPECT_FALSE(fs::exists(path("a.png")));
      const auto bytes = fs::exists(path("a.png.journal")) ? fs::file_size(path("a.png.journal")) : 0;
      if (random() % 3 == 0) continue;  // and killed again
      const Outcome rest = go("-q -c --block 16 --stats s.json -O a.png a.ray");
      ASSERT_EQ(rest.status, 0) << rest.err;
      EXPECT_EQ(read_file(path("a.png")), whole);
      EXPECT_FALSE(fs::exists(path("a.png.journal")));
      // Every block that reached the journal is done; a block's record has 16 x 16 x 4 bytes and a head.
      const auto resumed = stats()["resumed"]["blocks"].get<std::uint64_t>();
      EXPECT_EQ(resumed + stats()["sampling"]["blocks"].get<std::uint64_t>(), 32U * 25);
      if (bytes > 10'000) {
        EXPECT_GE(resumed + 1, (bytes - 10'000) / (16 * 16 * 4 + 72));
      }
    }
    EXPECT_EQ(killed, kills);
  }
};

TEST_F(ResumeTest, KilledAndContinuedItIsTheSamePicture) { kill_and_go_on(4); }

TEST_F(ResumeTest, DISABLED_KilledTwentyTimesItIsTheSamePicture) { kill_and_go_on(20); }

TEST_F(ResumeTest, InterruptedItSaysHowToGoOnAndOtherBlocksDo) {
  scene("900 700");
  ASSERT_EQ(interrupt("-O a.png a.ray", SIGINT, 700 * kTimeFactor), 3);
  EXPECT_THAT(read_file(path("log")),
              HasSubstr("the same command goes on from there (journal 'a.png.journal')"));
  EXPECT_TRUE(fs::exists(path("a.partial.png")));
  const Outcome rest = go("--block 23 --threads 3 --stats s.json -O a.png a.ray");
  EXPECT_EQ(rest.status, 0);
  EXPECT_THAT(rest.err, HasSubstr("going on from the journal"));
  EXPECT_GT(stats()["resumed"]["pixels"], 0);
  EXPECT_FALSE(fs::exists(path("a.partial.png")));
  EXPECT_FALSE(fs::exists(path("a.png.journal")));
  ASSERT_EQ(go("-q -O b.png a.ray").status, 0);
  EXPECT_EQ(read_file(path("a.png")), read_file(path("b.png")));
}

TEST_F(ResumeTest, WhatChangedIsNamed) {
  scene("1500 1200");
  ASSERT_EQ(interrupt("-q -O a.png a.ray", SIGKILL, 500 * kTimeFactor), 128 + SIGKILL);
  const std::string journal = read_file(path("a.png.journal"));
  Outcome out = go("-c -S 1 -O a.png a.ray");
  EXPECT_EQ(out.status, 1);
  EXPECT_THAT(out.err, HasSubstr("samples was 4, is now 1"));
  std::string changed = kScene;
  changed.replace(changed.find("3 0 0 0"), 7, "3 0 0 1");
  scene("1500 1200", changed);
  out = go("-c -O a.png a.ray");
  EXPECT_EQ(out.status, 1);
  EXPECT_THAT(out.err, HasSubstr("the scene has changed: "));
  EXPECT_THAT(out.err, HasSubstr("3 0 0 1"));
  EXPECT_EQ(read_file(path("a.png.journal")), journal);  // a refusal costs nothing
  scene("60 50", changed);
  out = go("-O a.png a.ray");
  EXPECT_EQ(out.status, 0);
  EXPECT_THAT(out.err, HasSubstr("rendering from the start"));
  ASSERT_EQ(go("-q --no-journal -O b.png a.ray").status, 0);
  EXPECT_EQ(read_file(path("a.png")), read_file(path("b.png")));
}

TEST_F(ResumeTest, FramesGoOnWhereTheyWere) {
  scene("250 200", std::string("frames 6\n") + kScene);
  ASSERT_EQ(go("-q --no-journal -O w%d.ppm a.ray").status, 0);
  for (const std::string name : {"n%d.ppm", "one.ppm"}) {
    ASSERT_EQ(interrupt("-q --threads 1 -O " + name + " a.ray", SIGKILL, 600 * kTimeFactor), 128 + SIGKILL);
    ASSERT_EQ(go("-q -c --stats s.json -O " + name + " a.ray").status, 0);
    EXPECT_GT(stats()["resumed"]["blocks"].get<int>() + stats()["resumed"]["frames"].get<int>(), 0) << name;
    EXPECT_FALSE(fs::exists(path(name + ".journal")));
  }
  std::string all;
  for (int i = 0; i < 6; ++i) {
    const std::string number = std::to_string(i);
    all += read_file(path("w" + number + ".ppm"));
    EXPECT_EQ(read_file(path("n" + number + ".ppm")), read_file(path("w" + number + ".ppm")));
  }
  EXPECT_TRUE(read_file(path("one.ppm")) == all);
}

TEST_F(ResumeTest, PartialPicturesAreKept) {
  scene("1500 1200");
  ASSERT_EQ(interrupt("-q --partial-interval 0.1 -O a.png a.ray", SIGKILL, 900 * kTimeFactor), 128 + SIGKILL);
  EXPECT_TRUE(fs::exists(path("a.partial.png")));
  EXPECT_EQ(go("-q -c --no-journal -O a.png a.ray").status, 2);
  EXPECT_EQ(go("-q -c -O - a.ray").status, 1);
}

}  // namespace
}  // namespace rayshade::testing_tools
