// SPDX-License-Identifier: MIT
// The program on real ranks: the bytes of rayshade, whatever the number of ranks and threads; errors, signals
// and deaths.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/mpi/job.h"

namespace pafas::test {
namespace {

using rayshade::testing_tools::run;
using ::testing::HasSubstr;
using ::testing::Not;

class MpiTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string scene =
        "eyep 0 -9 2 lookp 0 0 0 fov 40\nlight 1 point 4 -6 7\nlight .3 area 4 -4 6  5 -4 6 2  4 -3 6 2\n"
        "surface clay ambient .1 .1 .1 diffuse .7 .5 .4\n"
        "surface glass transp .8 body .95 1 .95 specular .5 .5 .5 specpow 40 reflect .1 index 1.1\n"
        "plane clay 0 0 -1 0 0 1 texture marble scale .5 .5 .5\n#include \"balls.inc\"\n";
    std::string balls;
    for (int i = 0; i < 60; ++i)
      balls += "sphere " + std::string(i % 3 ? "clay" : "glass") + " .4 " + std::to_string(i % 8 * .9 - 3) +
               " " + std::to_string(i / 8 * .9 - 3) + " " + std::to_string(i % 5 * .3 - .5) + "\n";
    write_file(folder() / "scene.ray", scene);
    write_file(folder() / "balls.inc", balls);
  }
  const std::filesystem::path& folder() const { return folder_.path(); }
  /// The picture that rayshade makes of the scene.
  std::string expected(const std::string& options) {
    const Outcome out = run(folder(), options + " -q -O expected.ppm scene.ray");
    EXPECT_EQ(out.status, 0) << out.err;
    return read_file(folder() / "expected.ppm");
  }
  std::string picture() const { return read_file(folder() / "out.ppm"); }
  nlohmann::json stats() const { return nlohmann::json::parse(read_file(folder() / "stats.json")); }

  Folder folder_;
};

TEST_F(MpiTest, TheBytesOfRayshadeOnAnyNumberOfRanks) {
  const std::string options = "-R 96 64 -S 2";
  const std::string picture_alone = expected(options);
  for (const int ranks : {1, 2, 3, 5, 16}) {
    for (const int threads : {1, 2}) {
      std::filesystem::remove(folder() / "out.ppm");
      Job job(
          folder(), on_ranks(ranks),
          options + " -q -O out.ppm --stats stats.json --threads " + std::to_string(threads) + " scene.ray");
      const Outcome out = job.wait();
      EXPECT_EQ(out.status, 0) << out.err;
      EXPECT_EQ(out.err, "");
      EXPECT_TRUE(picture() == picture_alone) << ranks << " ranks";
      EXPECT_EQ(stats()["outcome"], "complete");
      EXPECT_EQ(stats()["cluster"]["ranks"].size(), static_cast<std::size_t>(ranks));
    }
  }
}

TEST_F(MpiTest, SchedulesWindowsAndFrames) {
  for (const char* options :
       {"--schedule roundrobin", "--schedule bands", "--schedule blocks --start third",
        "--schedule cost --granularity 1", "-W 5 60 3 40", "-S 4 --sampling sobol --tolerance .02",
        "-X .2 .9 .1 .6", "--dedicated-master --block 7"}) {
    const std::string view = options[1] == '-' ? "-R 80 60 -S 2" : std::string("-R 80 60 -S 2 ") + options;
    const std::string picture_alone = expected(view);
    Job job(folder(), on_ranks(3), std::string("-R 80 60 -S 2 ") + options + " -q -O out.ppm scene.ray");
    const Outcome out = job.wait();
    EXPECT_EQ(out.status, 0) << out.err;
    EXPECT_TRUE(picture() == picture_alone) << options;
  }
  expected("-R 40 30 -S 1");
  Outcome out = run(folder(), "-R 40 30 -S 1 -N 3 -q -O a.%d.ppm scene.ray");
  ASSERT_EQ(out.status, 0) << out.err;
  Job job(folder(), on_ranks(3), "-R 40 30 -S 1 -N 3 -q -O b.%d.ppm scene.ray");
  EXPECT_EQ(job.wait().status, 0);
  for (const char* frame : {"0", "1", "2"})
    EXPECT_EQ(read_file(folder() / ("a." + std::string(frame) + ".ppm")),
              read_file(folder() / ("b." + std::string(frame) + ".ppm")));
}

TEST_F(MpiTest, SlavesNeedNoFiles) {
  const std::string picture_alone = expected("-R 64 48 -S 1");
  const std::filesystem::path empty = folder() / "empty";
  std::filesystem::create_directory(empty);
  const std::string words = "-R 64 48 -S 1 -q -O out.ppm --stats stats.json scene.ray";
  Job job(folder(), on_ranks(1), words + " : -wdir '" + empty.string() + "' -n 3 '" + pafas_program() + "'");
  const Outcome out = job.wait();
  EXPECT_EQ(out.status, 0) << out.err;
  EXPECT_TRUE(picture() == picture_alone);
  const nlohmann::json found = stats();
  for (const auto& row : found["cluster"]["ranks"]) EXPECT_EQ(row["outcome"], "reported");
}

TEST_F(MpiTest, BlockCostsTellWhatSlavesAreSent) {
  std::array<std::string, 2> lines;
  for (const int ranks : {1, 2}) {
    Job job(folder(), on_ranks(ranks), "-R 48 32 -S 1 -q -O out.ppm --block-costs costs.txt scene.ray");
    const Outcome out = job.wait();
    ASSERT_EQ(out.status, 0) << out.err;
    const std::string costs = read_file(folder() / "costs.txt");
    const std::size_t at = costs.find("scene-bytes ");
    ASSERT_NE(at, std::string::npos);
    lines[static_cast<std::size_t>(ranks - 1)] = costs.substr(at, costs.find('\n', at) - at);
  }
  EXPECT_EQ(lines[0], lines[1]);
  const double written = static_cast<double>(read_file(folder() / "scene.ray").size() +
                                             read_file(folder() / "balls.inc").size());
  const double sent = std::stod(lines[0].substr(12));
  EXPECT_GT(sent, 200);
  EXPECT_LT(sent, written);
}

TEST_F(MpiTest, ErrorsEndTheWholeJobAtOnce) {
  write_file(folder() / "bad.ray", "sphere nonsense\n");
  {
    Job job(folder(), on_ranks(4), "-O out.ppm bad.ray");
    const Outcome out = job.wait(40);
    EXPECT_EQ(out.status, 1);
    EXPECT_THAT(out.err, HasSubstr("bad.ray:1:"));
    EXPECT_THAT(out.err, Not(HasSubstr("rank")));
  }
  {
    Job job(folder(), on_ranks(3), "--nonsense scene.ray");
    const Outcome out = job.wait(40);
    EXPECT_EQ(out.status, 2);
    EXPECT_THAT(out.err, HasSubstr("Try 'pafas --help'"));
  }
  Job job(folder(), on_ranks(3), "--help");
  const Outcome out = job.wait(40);
  EXPECT_EQ(out.status, 0);
  EXPECT_THAT(out.out, HasSubstr("--schedule"));
}

TEST_F(MpiTest, SingletonsByMistakeAreRefused) {
  for (const char* environment : {"SLURM_STEP_ID=0 SLURM_NTASKS=4", "OMPI_COMM_WORLD_SIZE=4", "PMI_SIZE=2"}) {
    const std::string command = "cd '" + folder().string() + "' && env -u OMPI_COMM_WORLD_SIZE " +
                                environment + " timeout 30 '" + pafas_program() +
                                "' -O out.ppm scene.ray 2>.stderr";
    const int status = std::system(command.c_str());
    EXPECT_EQ(WEXITSTATUS(status), 2) << environment;
    EXPECT_THAT(read_file(folder() / ".stderr"), HasSubstr("each would render the whole picture"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder() / "out.ppm"));
}

TEST_F(MpiTest, TheReportNamesEveryRankAndDrawsTheTiling) {
  Job job(folder(), on_ranks(3),
          "-R 128 96 -S 1 -v -O out.ppm --tile-map tiles.png --timeline time.svg --block 32 scene.ray");
  const Outcome out = job.wait();
  EXPECT_EQ(out.status, 0) << out.err;
  EXPECT_THAT(out.err, HasSubstr("3 ranks, schedule"));
  // Four columns, three rows of blocks.
  EXPECT_THAT(out.err, ::testing::ContainsRegex("\n[012]{4}\n[012]{4}\n[012]{4}\n"));
  EXPECT_EQ(read_file(folder() / "tiles.png").substr(1, 3), "PNG");
  EXPECT_THAT(read_file(folder() / "time.svg"), HasSubstr("rank 2"));
}

TEST_F(MpiTest, KilledSlavesCostNothingButTheirWork) {
  const std::string options = "-R 240 180 -S 8";
  const std::string picture_alone = expected(options);
  const char* seed_text = std::getenv("SEED");
  const unsigned seed = seed_text ? static_cast<unsigned>(std::atoi(seed_text)) : std::random_device{}();
  SCOPED_TRACE("SEED=" + std::to_string(seed));
  std::mt19937 random(seed);
  std::size_t lost = 0;
  for (const std::size_t dead : {1U, 4U}) {
    std::filesystem::remove(folder() / "out.ppm");
    std::filesystem::remove(folder() / "out.ppm.journal");
    Job job(folder(), on_ranks(5, ENABLE_RECOVERY),
            options + " -q --threads 1 -O out.ppm --stats stats.json scene.ray");
    std::vector<pid_t> ranks = job.wait_for_ranks(5);
    ASSERT_EQ(ranks.size(), 5u);
    // A rank that dies while MPI starts takes the others along. Once the master has begun a journal, all have
    // started; the scene is not yet sent then. From there to the half of the picture, as the journal tells on
    // a machine of any speed.
    const std::uintmax_t far = 1 + random() % (160 * 120 * 4 / 2);
    const auto recorded = [this] {
      std::error_code none;
      const std::uintmax_t bytes = std::filesystem::file_size(folder() / "out.ppm.journal", none);
      return none ? 0 : bytes;
    };
    while (recorded() < far && job.running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ranks.erase(ranks.begin());
    std::shuffle(ranks.begin(), ranks.end(), random);
    for (std::size_t i = 0; i < dead; ++i) kill(ranks[i], SIGKILL);
    const Outcome out = job.wait(60);
    EXPECT_TRUE(picture() == picture_alone) << out.err;
    EXPECT_EQ(stats()["outcome"], "complete");
    // One that dies when all is done is not missed.
    const auto missed = stats()["cluster"]["ranks_lost"].get<std::size_t>();
    EXPECT_LE(missed, dead) << out.err;
    lost += missed;
  }
  EXPECT_GE(lost, 1u);
}

}  // namespace
}  // namespace pafas::test
