// SPDX-License-Identifier: MIT
// Interrupted renderings: killed at random moments, stopped, continued, refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "tests/program/run.h"

namespace rayshade::testing_tools {
namespace {

using ::testing::ContainsRegex;
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
  /// Bytes of a file, 0 where there is none.
  std::uintmax_t size(const std::string& name) const {
    std::error_code none;
    const std::uintmax_t bytes = fs::file_size(path(name), none);
    return none ? 0 : bytes;
  }
  /// Sends a signal as soon as the run is so far, however fast the machine is; returns the exit code,
  /// 128 + signal where it was killed.
  int interrupt(const std::string& arguments, int signal, const std::function<bool()>& so_far) {
    const pid_t child = fork();
    if (child == 0) {
      if (chdir(folder.path().c_str()) != 0 || !freopen("log", "w", stderr)) _exit(127);
      execl("/bin/sh", "sh", "-c", ("exec '" + program() + "' " + arguments).c_str(), nullptr);
      _exit(127);
    }
    int status = 0;
    bool ended = false;
    while (!ended && !so_far()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      ended = waitpid(child, &status, WNOHANG) == child;
    }
    if (!ended) {
      kill(child, signal);
      waitpid(child, &status, 0);
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  /// So many bytes of finished blocks and more are in a journal.
  std::function<bool()> recorded(const std::string& journal, std::uintmax_t bytes) const {
    return [this, journal, bytes] { return size(journal) >= bytes; };
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
      // Anywhere between the start and the end, and anywhere between two blocks.
      const std::uintmax_t far = random() % (32U * 25 * (16 * 16 * 4 + 72));
      const auto then = std::chrono::microseconds(random() % 3000);
      if (interrupt("-q --block 16 -O a.png --threads " + std::to_string(threads) + " a.ray", SIGKILL, [&] {
            if (size("a.png.journal") < far) return false;
            std::this_thread::sleep_for(then);
            return true;
          }) == 0)
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
  ASSERT_EQ(interrupt("-O a.png a.ray", SIGINT, recorded("a.png.journal", 400'000)), 3);
  EXPECT_THAT(read_file(path("log")),
              HasSubstr("; the partial picture is a.partial.png; the same command goes "
                        "on from there (journal 'a.png.journal')"));
  // 900 x 700 pixels of four bytes: at least fifteen percent.
  EXPECT_THAT(read_file(path("log")), ContainsRegex("stopped at (1[5-9]|[2-9][0-9]) %;"));
  EXPECT_THAT(read_file(path("log")), Not(HasSubstr("Done by earlier runs")));
  EXPECT_TRUE(fs::exists(path("a.partial.png")));
  const Outcome rest = go("--block 23 --threads 3 --stats s.json -O a.png a.ray");
  EXPECT_EQ(rest.status, 0);
  EXPECT_THAT(rest.err, HasSubstr("going on from the journal"));
  EXPECT_GT(stats()["resumed"]["pixels"], 0);
  EXPECT_THAT(rest.err, HasSubstr("Done by earlier runs:               0 frames, " +
                                  stats()["resumed"]["blocks"].dump() + " blocks (" +
                                  stats()["resumed"]["pixels"].dump() + " pixels)"));
  EXPECT_FALSE(fs::exists(path("a.partial.png")));
  EXPECT_FALSE(fs::exists(path("a.png.journal")));
  ASSERT_EQ(go("-q -O b.png a.ray").status, 0);
  EXPECT_EQ(read_file(path("a.png")), read_file(path("b.png")));
}

TEST_F(ResumeTest, WhatChangedIsNamed) {
  scene("1500 1200");
  ASSERT_EQ(interrupt("-q -O a.png a.ray", SIGKILL, recorded("a.png.journal", 10'000)), 128 + SIGKILL);
  const std::string journal = read_file(path("a.png.journal"));
  Outcome out = go("-c -S 1 -O a.png a.ray");
  EXPECT_EQ(out.status, 1);
  EXPECT_THAT(out.err, HasSubstr("samples was 4, is now 1"));
  out = go("-c --sampling sobol -O a.png a.ray");
  EXPECT_EQ(out.status, 1);
  EXPECT_THAT(out.err, HasSubstr("sampling was original, is now sobol"));
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
    const bool numbered = name == "n%d.ppm";
    const auto so_far = [&] { return numbered ? size("n1.ppm") > 0 : size("one.ppm.journal") > 250'000; };
    ASSERT_EQ(interrupt("-q --threads 1 -O " + name + " a.ray", SIGKILL, so_far), 128 + SIGKILL);
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

TEST_F(ResumeTest, StoppedFramesOfOneFileAreNoPicture) {
  scene("250 200", std::string("frames 6\n") + kScene);
  ASSERT_EQ(go("-q --no-journal -O w%d.ppm a.ray").status, 0);
  ASSERT_EQ(interrupt("-q --threads 1 -O one.ppm a.ray", SIGINT, recorded("one.ppm.journal", 250'000)), 3);
  EXPECT_THAT(read_file(path("log")),
              ContainsRegex("stopped at [0-9]+ % of frame [1-5] \\([2-6] of 6\\); the partial picture is "
                            "one.partial.ppm"));
  EXPECT_FALSE(fs::exists(path("one.ppm")));
  // What is finished, and then what there is of the next.
  const std::string first = read_file(path("w0.ppm")), partial = read_file(path("one.partial.ppm"));
  EXPECT_TRUE(partial.starts_with(first));
  EXPECT_EQ(partial.size() % first.size(), 0U);
  EXPECT_GE(partial.size(), 2 * first.size());
  ASSERT_EQ(go("-q -c -O one.ppm a.ray").status, 0);
  EXPECT_FALSE(fs::exists(path("one.partial.ppm")));
  std::string all;
  for (int i = 0; i < 6; ++i) all += read_file(path("w" + std::to_string(i) + ".ppm"));
  EXPECT_TRUE(read_file(path("one.ppm")) == all);
}

TEST_F(ResumeTest, HiddenFilesOfKilledRunsGo) {
  scene("1500 1200");
  const auto hidden = [&] {
    std::string name;
    for (const auto& entry : fs::directory_iterator(folder.path()))
      if (entry.path().filename().string().starts_with(".a.partial.png.")) name = entry.path().filename();
    return name;
  };
  std::string left;
  ASSERT_EQ(interrupt("-q --partial-interval 0.01 -O a.png a.ray", SIGKILL,
                      [&] { return !(left = hidden()).empty(); }),
            128 + SIGKILL);
  // It may have got its final name just before the kill.
  write_file(path(left), "half a picture");
  ASSERT_EQ(interrupt("-q -c -O a.png a.ray", SIGINT, recorded("a.png.journal", size("a.png.journal") + 1)),
            3);
  EXPECT_EQ(hidden(), "");
}

TEST_F(ResumeTest, WhatIsOddIsCountedInTheWholePicture) {
  const std::string text = std::string("light -1 directional 0 0 1\nsurface dark ambient -1 -1 -1\n") +
                           kScene + "plane dark 0 9 0 0 1 0\n";
  scene("500 400", text);
  ASSERT_EQ(go("-q --no-journal --stats s.json -O w.png a.ray").status, 0);
  const auto negative = stats()["sampling"]["negative_pixels"].get<std::uint64_t>();
  ASSERT_GT(negative, 1000U);
  ASSERT_EQ(interrupt("-q --block 16 -O a.png a.ray", SIGKILL, recorded("a.png.journal", 400'000)),
            128 + SIGKILL);
  // Blocks that overlap those of the first run, whose rest is recorded row by row.
  interrupt("-q --block 23 -O a.png a.ray", SIGKILL, recorded("a.png.journal", 600'000));
  ASSERT_EQ(go("-q -c --block 19 --stats s.json -O a.png a.ray").status, 0);
  EXPECT_GT(stats()["resumed"]["pixels"], 0);
  EXPECT_EQ(stats()["sampling"]["negative_pixels"], negative);
  EXPECT_EQ(read_file(path("a.png")), read_file(path("w.png")));
}

TEST_F(ResumeTest, WhatChangedInALargeSceneIsNamed) {
  std::string text = kScene;
  for (int i = 0; i < 12'000; ++i)
    text += "sphere .001 " + std::to_string(i % 80 * .5) + " 9 " + std::to_string(i) + ".123456789\n";
  scene("3000 2400", text);
  // Runs that are short for the size of their scene do not record it.
  const auto scene_recorded = [&] {
    return read_file(path("a.png.journal")).find("RSRc\x01\x04") != std::string::npos;
  };
  ASSERT_EQ(interrupt("-q -O a.png a.ray", SIGKILL, scene_recorded), 128 + SIGKILL);
  scene("3000 2400", text.replace(text.find("4321.123"), 8, "4321.789"));
  const Outcome out = go("-c -O a.png a.ray");
  EXPECT_EQ(out.status, 1);
  EXPECT_THAT(out.err,
              ContainsRegex("the scene has changed, first in its line [0-9]+ that is now '.*4321\\.789"));
}

TEST_F(ResumeTest, PartialPicturesAreKept) {
  scene("1500 1200");
  ASSERT_EQ(interrupt("-q --partial-interval 0.1 -O a.png a.ray", SIGKILL,
                      [&] { return size("a.partial.png") > 0; }),
            128 + SIGKILL);
  EXPECT_TRUE(fs::exists(path("a.partial.png")));
  EXPECT_EQ(go("-q -c --no-journal -O a.png a.ray").status, 2);
  EXPECT_EQ(go("-q -c -O - a.ray").status, 1);
}

}  // namespace
}  // namespace rayshade::testing_tools
