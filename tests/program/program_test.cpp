// SPDX-License-Identifier: MIT
// Streams, exit codes, files and signals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>
#include <tuple>

#include "rayshade/image/reader.h"
#include "tests/program/run.h"
#include "tests/program/xml.h"

namespace rayshade::testing_tools {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

constexpr const char* kSmall = "screen 20 16\nsample 1 nojitter\nsphere diffuse .8 .2 .2 3 0 0 0\n";

class ProgramTest : public ::testing::Test {
 protected:
  Folder folder;
  fs::path path(const std::string& name) const { return folder.path() / name; }
  Outcome go(const std::string& arguments, const std::string& input = {}) {
    return run(folder.path(), arguments, input);
  }
};

TEST_F(ProgramTest, HelpAndVersionGoToStandardOutput) {
  const Outcome help = go("--help");
  EXPECT_EQ(help.status, 0);
  EXPECT_THAT(help.out, HasSubstr("usage: rayshade"));
  EXPECT_EQ(help.err, "");
  const Outcome version = go("--version");
  EXPECT_EQ(version.status, 0);
  EXPECT_THAT(version.out, ::testing::MatchesRegex("rayshade [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST_F(ProgramTest, WrongUsageIsOneLineAndExitCode2) {
  const Outcome bad = go("-S3 x.ray");
  EXPECT_EQ(bad.status, 2);
  EXPECT_THAT(bad.err, HasSubstr("-S3"));
  EXPECT_THAT(bad.err, HasSubstr("Try 'rayshade --help'"));
  EXPECT_EQ(bad.out, "");
  EXPECT_EQ(go("--format gif x.ray").status, 2);
}

TEST_F(ProgramTest, SceneFromStandardInputPictureToStandardOutput) {
  const Outcome done = go("-q -O - --format ppm", kSmall);
  EXPECT_EQ(done.status, 0);
  EXPECT_EQ(done.err, "");
  EXPECT_EQ(done.out.substr(0, 12), "P6\n20 16\n255");
  EXPECT_EQ(done.out.size(), std::string("P6\n20 16\n255\n").size() + 3 * 20 * 16);
  // Without -O the picture goes to standard output as well.
  EXPECT_EQ(go("-q --format ppm", kSmall).out, done.out);
}

TEST_F(ProgramTest, TheReportGoesToStandardErrorOrAFile) {
  const Outcome loud = go("-O a.png", kSmall);
  EXPECT_EQ(loud.status, 0);
  EXPECT_EQ(loud.out, "");
  EXPECT_THAT(loud.err, HasSubstr("Eye rays:"));
  EXPECT_THAT(loud.err, Not(HasSubstr("\r")));
  const Outcome filed = go("-V report.txt -O a.png", kSmall);
  EXPECT_EQ(filed.err, "");
  EXPECT_THAT(read_file(path("report.txt")), HasSubstr("Screen resolution: 20 x 16"));
}

TEST_F(ProgramTest, APictureThatCannotBeWrittenIsKnownBeforeItIsRendered) {
  const Outcome lost = go("-O nowhere/a.png --stats a.json -v", kSmall);
  EXPECT_EQ(lost.status, 1);
  EXPECT_THAT(lost.err, HasSubstr("nowhere/a.png"));
  EXPECT_THAT(lost.err, Not(HasSubstr("Eye rays")));
  EXPECT_FALSE(fs::exists(path("a.json")));
}

TEST_F(ProgramTest, ExplainingAndCheckingLeaveFilesAlone) {
  write_file(path("a.ray"), std::string("report verbose keep.txt\n") + kSmall);
  write_file(path("a.png"), "a picture");
  write_file(path("keep.txt"), "kept");
  const Outcome explained = go("--explain 10 8 -O a.png a.ray");
  EXPECT_EQ(explained.status, 0);
  EXPECT_THAT(explained.out, HasSubstr("eye ray, depth 0"));
  EXPECT_EQ(go("--check -O a.png a.ray").status, 0);
  EXPECT_EQ(read_file(path("a.png")), "a picture");
  EXPECT_EQ(read_file(path("keep.txt")), "kept");
}

TEST_F(ProgramTest, CheckingLooksAtFilesOfUnusedObjectsToo) {
  for (const char* object : {"heightfield nofile", "sphere 1 0 0 0 texture image nofile",
                             "sphere 1 0 0 0 texture marble nofile"}) {
    write_file(path("a.ray"), std::string("name x ") + object + "\n" + kSmall);
    const Outcome checked = go("--check a.ray");
    EXPECT_EQ(checked.status, 1) << object;
    EXPECT_THAT(checked.err, HasSubstr("a.ray:1:")) << object;
    EXPECT_THAT(checked.err, HasSubstr("nofile")) << object;
    EXPECT_EQ(go("-q -O a.png a.ray").status, 0) << object;  // what is not used is not built
  }
}

TEST_F(ProgramTest, QuietMeansWarningsAndErrorsOnly) {
  const std::string named = std::string("name x sphere 1 0 0 0\n") + kSmall;
  EXPECT_EQ(go("-q -v -O a.png", named).err, "");
  EXPECT_THAT(go("-v -O a.png", named).err, HasSubstr("sphere \"x\""));
  EXPECT_EQ(go("-V report.txt -O a.png", named).err, "");
  EXPECT_THAT(read_file(path("report.txt")), HasSubstr("sphere \"x\""));
}

TEST_F(ProgramTest, AToleranceOutOfPlaceIsWrongUsage) {
  EXPECT_EQ(go("-q --tolerance .1 -O a.png", kSmall).status, 2);
  EXPECT_EQ(go("-q --tolerance -1 --sampling sobol -O a.png", kSmall).status, 2);
  EXPECT_EQ(go("-q --tolerance .1 --sampling sobol -O a.png", kSmall).status, 0);
}

TEST_F(ProgramTest, AFinishedPictureReplacesThePartialOneOfAnyRun) {
  write_file(path("a.partial.png"), "left behind");
  EXPECT_EQ(go("-q -O a.png", kSmall).status, 0);
  EXPECT_TRUE(fs::exists(path("a.png")));
  EXPECT_FALSE(fs::exists(path("a.partial.png")));
}

TEST_F(ProgramTest, AnIgnoredOutfileIsTold) {
  const Outcome one = go("-q -O a.png", std::string("outfile b.png\n") + kSmall);
  EXPECT_THAT(one.err, HasSubstr("outfile 'b.png' is ignored: -O names the picture"));
  EXPECT_FALSE(fs::exists(path("b.png")));
  const Outcome two = go("-q", std::string("outfile b.png outfile c.png\n") + kSmall);
  EXPECT_THAT(two.err, HasSubstr("outfile 'c.png' is ignored: the first one, 'b.png', holds"));
}

TEST_F(ProgramTest, ASceneErrorHasItsPlaceAndLeavesNoPicture) {
  write_file(path("bad.ray"), "sphere 1 0 0 0\nspere 2 0 0 0\n");
  const Outcome bad = go("-O a.png bad.ray");
  EXPECT_EQ(bad.status, 1);
  EXPECT_THAT(bad.err, HasSubstr("bad.ray:2:1: error:"));
  EXPECT_THAT(bad.err, HasSubstr("sphere"));
  EXPECT_FALSE(fs::exists(path("a.png")));
}

TEST_F(ProgramTest, MissingFilesAreErrors) {
  EXPECT_EQ(go("-O a.png none.ray").status, 1);
  write_file(path("hf.ray"), "sphere 1 0 0 0\nheightfield nowhere.hf\n");
  const Outcome missing = go("-O a.png hf.ray");
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.err, HasSubstr("hf.ray:2:"));
  EXPECT_THAT(missing.err, HasSubstr("nowhere.hf"));
  write_file(path("tex.ray"), "sphere 1 0 0 0 texture image nowhere.png\n");
  EXPECT_THAT(go("-O a.png tex.ray").err, HasSubstr("nowhere.png"));
  EXPECT_FALSE(fs::exists(path("a.png")));
}

TEST_F(ProgramTest, AnUnwritablePictureKeepsThePreviousOne) {
  ASSERT_EQ(go("-q -O a.png", kSmall).status, 0);
  const std::string before = read_file(path("a.png"));
  EXPECT_EQ(go("-q -O none/a.png", kSmall).status, 1);
  EXPECT_EQ(go("-q -O a.png", "sphere 1 0 0 0 nonsense").status, 1);
  EXPECT_EQ(read_file(path("a.png")), before);
  // Nothing else is left behind.
  int files = 0;
  for (const auto& entry : fs::directory_iterator(folder.path()))
    files += entry.path().filename().string()[0] != '.';
  EXPECT_EQ(files, 1);
}

TEST_F(ProgramTest, AFullDiskIsAnError) {
  const Outcome full = go("-q -O /dev/full", kSmall);
  EXPECT_EQ(full.status, 1);
  EXPECT_THAT(full.err, HasSubstr("No space left"));
}

TEST_F(ProgramTest, SameSceneSameBytes) {
  ASSERT_EQ(go("-q --threads 1 -O a.png", kSmall).status, 0);
  ASSERT_EQ(go("-q --threads 3 --block 5 -O b.png", kSmall).status, 0);
  EXPECT_EQ(read_file(path("a.png")), read_file(path("b.png")));
}

TEST_F(ProgramTest, VerifyingScenesFindsNothingAndChangesNothing) {
  // Scenes name files beside them.
  for (const auto& entry : fs::directory_iterator(std::string(SOURCE_DIR) + "/scenes")) {
    if (entry.is_regular_file()) fs::create_symlink(entry.path(), path(entry.path().filename().string()));
  }
  for (const std::string name : {"hero", "fern", "csg", "motion", "focus", "glass", "shadows", "spots"}) {
    SCOPED_TRACE(name);
    std::string pictures[2];
    for (const int verify : {0, 1}) {
      const Outcome done = go("-q -R 40 30 -S 2 --stats s.json --verify " + std::to_string(verify) +
                              " -O a.ppm " + name + ".ray");
      ASSERT_EQ(done.status, 0) << done.err;
      EXPECT_EQ(done.err, "");
      pictures[verify] = read_file(path("a.ppm"));
    }
    EXPECT_EQ(pictures[0], pictures[1]);
    const auto stats = nlohmann::json::parse(read_file(path("s.json")));
    EXPECT_EQ(stats["verification"]["nearest"], stats["rays"]["nearest_queries"]);
    EXPECT_EQ(stats["verification"]["occlusion"], stats["rays"]["occlusion_queries"]);
    EXPECT_EQ(stats["verification"]["differing"], 0);
  }
}

TEST_F(ProgramTest, SharesThatAreNoneAreRefused) {
  for (const char* share : {"50", "-1", "101%", "nan", "few", "5%%", "''"}) {
    const Outcome bad = go("-O a.png --verify " + std::string(share), kSmall);
    EXPECT_EQ(bad.status, 2) << share;
    EXPECT_THAT(bad.err, HasSubstr("--verify: ")) << share;
    EXPECT_THAT(bad.err, HasSubstr("not a share from 0 to 1")) << share;
  }
}

TEST_F(ProgramTest, StatisticsAreJson) {
  ASSERT_EQ(go("-q --stats s.json -O a.png", kSmall).status, 0);
  const auto stats = nlohmann::json::parse(read_file(path("s.json")));
  EXPECT_EQ(stats["outcome"], "complete");
  EXPECT_EQ(stats["rays"]["eye"], 20 * 16);
  EXPECT_EQ(stats["sampling"]["nan_pixels"], 0);
  EXPECT_EQ(stats["scene_hash"].get<std::string>().size(), 32u);
}

/// Enough objects for trees.
std::string many_spheres(const std::string& settings) {
  std::string text = "screen 40 32 sample 1 nojitter\nlight 1 point 5 -9 9\n" + settings + "\n";
  for (int row = 0; row < 6; ++row) {
    for (int i = 0; i < 10; ++i) {
      text += "sphere diffuse .8 .6 .4 .4 " + std::to_string(i - 4.5) + " " +
              std::to_string((10 * row + i) % 3) + " " + std::to_string(row - 2.5) + "\n";
    }
  }
  return text;
}

TEST_F(ProgramTest, ClassesOfRaysAreInTheReportAndTheStatistics) {
  const Outcome told = go("-v --stats s.json -O a.png", many_spheres(""));
  ASSERT_EQ(told.status, 0) << told.err;
  EXPECT_THAT(told.err, HasSubstr("trees of classes of rays"));
  EXPECT_THAT(told.err, HasSubstr("light 1 (point)"));
  EXPECT_THAT(told.err, HasSubstr("Memory of trees:"));
  const auto stats = nlohmann::json::parse(read_file(path("s.json")));
  const auto& trees = stats["trees"];
  EXPECT_EQ(trees["method"], "trees");
  EXPECT_GT(trees["memory"]["budget_bytes"], 0);
  std::uint64_t rays = 0, placed = 0;
  for (const auto& c : trees["classes"]) {
    rays += c["rays"].get<std::uint64_t>();
    placed += c["rays_in_tree"].get<std::uint64_t>() + c["left_by_place"].get<std::uint64_t>() +
              c["left_by_choice"].get<std::uint64_t>();
  }
  EXPECT_EQ(rays, placed);
  EXPECT_EQ(rays, stats["rays"]["nearest_queries"].get<std::uint64_t>() +
                      stats["rays"]["occlusion_queries"].get<std::uint64_t>());
  EXPECT_EQ(trees["classes"][0]["class"], "eye");
  EXPECT_EQ(trees["classes"][0]["rays"], 40 * 32);
  EXPECT_EQ(trees["classes"][3]["class"], "light 1 (point)");
  ASSERT_EQ(go("-q --stats s.json -O a.png", kSmall).status, 0);
  EXPECT_EQ(nlohmann::json::parse(read_file(path("s.json")))["trees"]["method"], "packs");
}

TEST_F(ProgramTest, TheEyeTreeIsDrawnAsSvg) {
  // A title that would break the markup, and pictures of every kind beneath.
  write_file(path("a<b>&\xff.ray"), many_spheres("background .2 .3 .5"));
  for (const std::string picture : {"a.png", "a.ppm", "a.pfm", "a.rle"}) {
    const Outcome done =
        go("-q --fas-dump t.svg --stats s.json --fas-split always -O " + picture + " 'a<b>&\xff.ray'");
    ASSERT_EQ(done.status, 0) << done.err;
    const std::string svg = read_file(path("t.svg"));
    EXPECT_EQ(xml_error(svg), "");
    EXPECT_THAT(svg, HasSubstr("data:image/png;base64,iVBORw0KGgo"));
    const auto stats = nlohmann::json::parse(read_file(path("s.json")));
    const auto& eye = stats["trees"]["classes"][0];
    const auto cells = eye["leaves"].get<std::int64_t>() - eye["splits"].get<std::int64_t>();
    std::int64_t drawn = 0, outside = 0;
    for (std::size_t at = 0; (at = svg.find("<polygon ", at)) != std::string::npos; ++at) ++drawn;
    EXPECT_EQ(std::sscanf(svg.c_str() + svg.find("<desc>"), "<desc>%*d cells, %ld more", &outside), 1);
    EXPECT_GT(drawn, 0);
    EXPECT_EQ(drawn + outside, cells);
  }
  ASSERT_EQ(go("-q --fas-dump t.svg -e -O a.rle", many_spheres("")).status, 0);
  // There is a tree to be drawn, even where it does not pay.
  EXPECT_THAT(read_file(path("t.svg")), testing::ContainsRegex("<desc>[1-9][0-9]* cells"));
  EXPECT_THAT(read_file(path("t.svg")), HasSubstr("cannot be shown"));
  // Each eye of a stereo pair has a tree, and each frame a drawing.
  EXPECT_EQ(go("-q --fas-dump t.svg -l -E .2 -O a.png", many_spheres("")).status, 0);
  ASSERT_EQ(go("-q --fas-dump t.%d.svg -N 2 -O a.%d.png", many_spheres("")).status, 0);
  EXPECT_EQ(xml_error(read_file(path("t.1.svg"))), "");
  EXPECT_EQ(go("-q --fas-dump t.svg -N 2 -O a.%d.png", many_spheres("")).status, 2);
}

TEST_F(ProgramTest, WithoutAnEyeTreeNothingIsDrawn) {
  const std::string lens = many_spheres("aperture .1 focaldist 8");
  for (const auto& [options, scene, why] :
       {std::tuple{"", lens, "aperture"}, std::tuple{"", std::string(kSmall), "few objects"},
        std::tuple{"--intersector hierarchy", many_spheres(""), "--intersector fas"},
        std::tuple{"--intersector brute", many_spheres(""), "--intersector fas"}}) {
    const Outcome refused = go("-q --fas-dump t.svg -O a.png " + std::string(options), scene);
    EXPECT_EQ(refused.status, 2);
    EXPECT_THAT(refused.err, HasSubstr("no tree of eye rays"));
    EXPECT_THAT(refused.err, HasSubstr(why));
    EXPECT_FALSE(fs::exists(path("t.svg")) || fs::exists(path("a.png")));
  }
}

TEST(XmlErrorTest, FindsWhatIsNotWellFormed) {
  EXPECT_EQ(xml_error("<?xml version=\"1.0\"?>\n<a b=\"c &amp; d\"><e f=\"1\"/>text</a>\n"), "");
  for (const char* bad : {"", "<a>", "<a></b>", "<a/><b/>", "<a b=c/>", "<a b=\"<\"/>", "<a>&</a>",
                          "<a>x</a>y", "<a b=\"1\" b=\"2\"/>", "<a", "<a>\xff</a>", "<a b=\"1\"c=\"2\"/>"})
    EXPECT_NE(xml_error(bad), "") << bad;
}

TEST_F(ProgramTest, CheckRendersNothing) {
  write_file(path("ok.ray"), kSmall);
  const Outcome ok = go("--check -O a.png ok.ray");
  EXPECT_EQ(ok.status, 0);
  EXPECT_THAT(ok.err, HasSubstr("1 primitive"));
  EXPECT_FALSE(fs::exists(path("a.png")));
  EXPECT_EQ(go("--check", "sphere").status, 1);
}

TEST_F(ProgramTest, TheDumpOfADumpIsTheDump) {
  const Outcome once = go("--dump-scene", kSmall);
  ASSERT_EQ(once.status, 0);
  const Outcome twice = go("--dump-scene", once.out);
  EXPECT_EQ(twice.out, once.out);
  EXPECT_NE(once.out, "");
  ASSERT_EQ(go("-q -O a.png", kSmall).status, 0);
  ASSERT_EQ(go("-q -O b.png", once.out).status, 0);
  EXPECT_EQ(read_file(path("a.png")), read_file(path("b.png")));
}

TEST_F(ProgramTest, ExplainPrintsTheRayTree) {
  const Outcome told = go("--explain 10 8", kSmall);
  EXPECT_EQ(told.status, 0);
  EXPECT_THAT(told.out, HasSubstr("eye ray"));
  EXPECT_THAT(told.out, HasSubstr("sphere"));
  EXPECT_EQ(go("--explain 20 8", kSmall).status, 2);
}

TEST_F(ProgramTest, CostMapAndLayersAreWritten) {
  ASSERT_EQ(go("-q --cost-map cost --layers l.pfm -O a.png", kSmall).status, 0);
  for (const char* name :
       {"cost.tests.pfm", "cost.tests.png", "cost.microseconds.pfm", "cost.bounds_tests.png", "cost.rays.pfm",
        "cost.tree_rays.png", "l.depth.Z.pfm", "l.normal.X.pfm", "l.object.pfm", "l.samples.pfm"}) {
    EXPECT_TRUE(fs::exists(path(name))) << name;
  }
}

TEST_F(ProgramTest, FramesGoToNumberedFilesOrOneAfterTheOther) {
  const std::string moving = std::string(kSmall) + "sphere 1 0 0 0 translate (frame) 0 0\n";
  ASSERT_EQ(go("-q -N 3 -A 5 -O f.%03d.png", moving).status, 0);
  EXPECT_TRUE(fs::exists(path("f.005.png")) && fs::exists(path("f.006.png")) &&
              fs::exists(path("f.007.png")));
  EXPECT_FALSE(fs::exists(path("f.008.png")));
  ASSERT_EQ(go("-q -N 3 -O all.ppm", moving).status, 0);
  ASSERT_EQ(go("-q -O one.ppm", moving).status, 0);
  EXPECT_EQ(fs::file_size(path("all.ppm")), 3 * fs::file_size(path("one.ppm")));
  EXPECT_EQ(go("-q -N 3 -O all.png", moving).status, 2);
}

TEST_F(ProgramTest, AbsurdSizesAreRefusedBeforeMemoryIsTaken) {
  const auto start = std::chrono::steady_clock::now();
  const Outcome huge = go("-q -R 1000000 1000000 -O a.png", kSmall);
  EXPECT_EQ(huge.status, 1);
  EXPECT_THAT(huge.err, HasSubstr("memory"));
  EXPECT_EQ(go("-q --memory 1K -O a.png", kSmall).status, 1);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10 * kTimeFactor));
}

/// Starts the program on a scene that takes long, in the background.
class SignalTest : public ProgramTest {
 protected:
  pid_t start(const std::string& extra) {
    write_file(path("slow.ray"),
               "screen 4000 4000\nsample 8\ncontrast 0 0 0\nsphere reflect .5 specular 1 1 1 3 0 0 0\n"
               "sphere reflect .5 specular 1 1 1 2 3 0 0\nplane 0 0 -2 0 0 1 texture marble\n");
    const pid_t child = fork();
    if (child == 0) {
      if (chdir(folder.path().c_str()) != 0) _exit(127);
      if (!freopen("log", "w", stderr)) _exit(127);
      execl("/bin/sh", "sh", "-c", ("exec '" + program() + "' -O slow.png " + extra + " slow.ray").c_str(),
            nullptr);
      _exit(127);
    }
    // Signals are taken from before the first block on.
    std::error_code none;
    for (int i = 0; i < 60'000 * kTimeFactor; ++i) {
      const std::uintmax_t recorded = fs::file_size(path("slow.png.journal"), none);
      if (!none && recorded > 10'000) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return child;
  }
  int wait_for(pid_t child) {
    for (int i = 0; i < 300 * kTimeFactor; ++i) {
      int status = 0;
      if (waitpid(child, &status, WNOHANG) == child)
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    return -1;
  }
};

TEST_F(SignalTest, TermKeepsThePartialPictureAndExitsWith3) {
  const pid_t child = start("--stats s.json");
  kill(child, SIGTERM);
  EXPECT_EQ(wait_for(child), 3);
  EXPECT_FALSE(fs::exists(path("slow.png")));
  const std::string bytes = read_file(path("slow.partial.png"));
  ASSERT_NE(bytes, "");
  EXPECT_EQ(read_image(bytes).width, 4000);
  EXPECT_EQ(nlohmann::json::parse(read_file(path("s.json")))["outcome"], "stopped");
}

TEST_F(SignalTest, HangUpWritesThePartialPictureAndGoesOn) {
  const pid_t child = start("-q");
  kill(child, SIGHUP);
  for (int i = 0; i < 100 * kTimeFactor && !fs::exists(path("slow.partial.png")); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_TRUE(fs::exists(path("slow.partial.png")));
  EXPECT_EQ(kill(child, 0), 0);
  kill(child, SIGINT);
  EXPECT_EQ(wait_for(child), 3);
}

}  // namespace
}  // namespace rayshade::testing_tools
