// SPDX-License-Identifier: MIT
// Twenty runs whose slaves are killed at random moments, and twenty jobs killed as a whole and gone on with.
// Long: CTest label long.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <string_view>

#include "rayshade/image/record.h"
#include "tests/mpi/job.h"

namespace pafas::test {
namespace {

namespace fs = std::filesystem;
using rayshade::testing_tools::run;

/// The finished blocks that a journal holds, up to where it was cut.
std::uint64_t whole_blocks(std::string_view journal) {
  std::uint64_t blocks = 0;
  while (const std::optional<rayshade::Record> record = rayshade::open_record(journal)) {
    blocks += record->kind == rayshade::RecordKind::kBlock;
    journal.remove_prefix(record->size);
  }
  return blocks;
}

class KillTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* text = std::getenv("SEED");
    seed_ = text ? static_cast<unsigned>(std::atoi(text)) : std::random_device{}();
    random_.seed(seed_);
    ASSERT_EQ(std::system(("'" BINARY_DIR "/bin/spd' rings -s 3 > '" + path("scene.ray") + "'").c_str()), 0);
    const Outcome out =
        run(folder_.path(), kOptions + " --no-journal --stats s.json -O whole.png scene.ray", {}, 600);
    ASSERT_EQ(out.status, 0) << out.err;
    whole_ = read_file(path("whole.png"));
    seconds_ = nlohmann::json::parse(read_file(path("s.json")))["resources"]["cpu_seconds"];
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  nlohmann::json stats() const { return nlohmann::json::parse(read_file(path("stats.json"))); }
  /// Waits until MPI has started everywhere: the master has begun a journal.
  void wait_for_start(Job& job) const {
    while (!fs::exists(path("out.png.journal")) && job.running())
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  void wait_some(double seconds) {
    std::uniform_real_distribution<> share(0, 1);
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds * share(random_)));
  }

  // Ten seconds or more on two processors.
  const std::string kOptions = "-q -R 512 512 -S 8 -T 0 0 0 --block 32";
  Folder folder_;
  unsigned seed_ = 0;
  std::mt19937 random_;
  std::string whole_;
  double seconds_ = 0;
};

TEST_F(KillTest, TwentyRunsWhoseSlavesDie) {
  SCOPED_TRACE("SEED=" + std::to_string(seed_));
  for (int round = 0; round < 20; ++round) {
    const std::size_t dead = 1 + random_() % 6;
    fs::remove(path("out.png"));
    Job job(folder_.path(), on_ranks(7, ENABLE_RECOVERY),
            kOptions + " --threads 1 --stats stats.json -O out.png scene.ray");
    std::vector<pid_t> ranks = job.wait_for_ranks(7);
    ASSERT_EQ(ranks.size(), 7u);
    wait_for_start(job);
    ranks.erase(ranks.begin());
    std::shuffle(ranks.begin(), ranks.end(), random_);
    for (std::size_t i = 0; i < dead; ++i) {
      wait_some(seconds_ / 2 / static_cast<double>(dead));
      kill(ranks[i], SIGKILL);
    }
    const Outcome out = job.wait(300);
    EXPECT_TRUE(read_file(path("out.png")) == whole_) << "round " << round << "\n" << out.err;
    EXPECT_EQ(stats()["outcome"], "complete");
    EXPECT_LE(stats()["cluster"]["ranks_lost"], dead);
    EXPECT_FALSE(fs::exists(path("out.png.journal")));
  }
}

TEST_F(KillTest, TwentyJobsKilledAndGoneOnWith) {
  SCOPED_TRACE("SEED=" + std::to_string(seed_));
  constexpr std::uint64_t kBlocks = 16 * 16;
  for (int round = 0; round < 20; ++round) {
    fs::remove(path("out.png"));
    fs::remove(path("out.png.journal"));
    {
      Job job(folder_.path(), on_ranks(3), kOptions + " --threads 1 --stats stats.json -O out.png scene.ray");
      ASSERT_EQ(job.wait_for_ranks(3).size(), 3u);
      wait_for_start(job);
      wait_some(seconds_ / 2);
      for (const pid_t rank : job.ranks()) kill(rank, SIGKILL);
    }  // and its mpirun
    ASSERT_FALSE(fs::exists(path("out.png"))) << "too late";
    const std::uint64_t recorded = whole_blocks(read_file(path("out.png.journal")));
    const int ranks = 1 + static_cast<int>(random_() % 4);
    Job job(folder_.path(), on_ranks(ranks),
            kOptions + " -c --threads 1 --stats stats.json -O out.png scene.ray");
    const Outcome out = job.wait(300);
    EXPECT_EQ(out.status, 0) << out.err;
    EXPECT_TRUE(read_file(path("out.png")) == whole_) << "round " << round;
    const nlohmann::json found = stats();
    const auto resumed = found["resumed"]["blocks"].get<std::uint64_t>();
    EXPECT_EQ(resumed, recorded);
    // Twice only what two ranks had at a time: with results that came twice, or that came too late to be
    // sent.
    EXPECT_LE(found["sampling"]["blocks"].get<std::uint64_t>(),
              kBlocks - resumed + found["cluster"]["blocks_repeated"].get<std::uint64_t>() +
                  static_cast<std::uint64_t>(ranks));
  }
}

}  // namespace
}  // namespace pafas::test
