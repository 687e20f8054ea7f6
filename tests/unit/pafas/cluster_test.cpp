// SPDX-License-Identifier: MIT
// A whole job with its ranks as threads: the same bytes as one machine, whatever is lost, late or dead.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "pafas/master.h"
#include "pafas/worker.h"
#include "rayshade/cli/program.h"
#include "tests/program/run.h"
#include "tests/unit/pafas/loopback.h"

namespace pafas::test {
namespace {

using namespace rayshade;
using ::testing::HasSubstr;
using testing_tools::read_file;
using testing_tools::write_file;

/// What takes a while takes longer under a sanitizer: nobody shall seem dead only because of that.
constexpr int kSlowness = testing_tools::kSanitized ? 4 : 1;

constexpr const char* kScene = R"(screen 96 64 sample 2 eyep 0 -9 2 lookp 0 0 0 fov 40
light 1 point 4 -6 7
light .4 directional -1 -1 2
surface clay ambient .1 .1 .1 diffuse .7 .5 .4
surface steel ambient .05 .05 .05 diffuse .2 .2 .2 specular .8 .8 .8 specpow 30 reflect .6
plane clay 0 0 -1 0 0 1
#include "balls.inc"
)";

class ClusterTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string balls;
    for (int i = 0; i < 60; ++i)
      balls += "sphere " + std::string(i % 3 ? "clay" : "steel") + " .4 " + std::to_string(i % 8 * .9 - 3) +
               " " + std::to_string(i / 8 * .9 - 3) + " " + std::to_string(i % 5 * .3 - .5) + "\n";
    write_file(path("balls.inc"), balls);
    write_file(path("scene.ray"), kScene);
    // Includes are relative to the including file.
    timing_.alive = .05 * kSlowness;
    timing_.ask_again = .2 * kSlowness;
    timing_.relay = .15 * kSlowness;
    timing_.hold = .05 * kSlowness;
    timing_.patience = 3 * kSlowness;
    timing_.silence = .5 * kSlowness;
    timing_.reports = 4 * kSlowness;
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::vector<std::string> arguments(const std::string& picture, std::vector<std::string> more) const {
    for (const char* word : {"-q", "--threads", "2", "-O"}) more.emplace_back(word);
    more.push_back(path(picture));
    more.push_back(path("scene.ray"));
    return more;
  }
  std::string alone(const std::vector<std::string>& more) {
    LocalEngine engine;
    EXPECT_EQ(run_program(arguments("alone.ppm", more), engine), kComplete);
    return read_file(path("alone.ppm"));
  }
  /// Runs on `ranks` ranks; `meanwhile` goes on beside it. Returns the picture.
  std::string together(int ranks, std::vector<std::string> more, Network& network,
                       const std::function<void()>& meanwhile = {}) {
    std::vector<std::thread> slaves;
    codes_.assign(static_cast<std::size_t>(ranks), -1);
    for (int rank = 1; rank < ranks; ++rank) {
      slaves.emplace_back([&, rank] {
        Loopback transport(network, rank);
        Worker worker(transport, {version_of(rank), 1, timing_});
        codes_[static_cast<std::size_t>(rank)] = worker.run();
      });
    }
    std::thread other([&] {
      if (meanwhile) meanwhile();
    });
    more.insert(more.end(), {"--stats", path("stats.json")});
    const std::vector<std::string> words = arguments("together.ppm", more);
    {
      Loopback transport(network, 0);
      Master master(transport, {"1", words, 1, timing_});
      codes_[0] = run_program(words, master);
    }
    for (std::thread& slave : slaves) slave.join();
    other.join();
    return read_file(path("together.ppm"));
  }
  /// Makes the package of so many pieces at least, whatever zlib does.
  void enlarge_scene(std::size_t pieces) {
    std::mt19937_64 random(5);
    std::string text = "/* ";
    // Four bits of every character are random.
    while (text.size() < 2 * pieces * Piece::kBytes + 1000) {
      std::uint64_t bits = random();
      for (int i = 0; i < 16; ++i, bits >>= 4) text += static_cast<char>('a' + bits % 16);
    }
    write_file(path("balls.inc"), read_file(path("balls.inc")) + text + " */\n");
  }
  nlohmann::json stats() const { return nlohmann::json::parse(read_file(path("stats.json"))); }
  virtual std::string version_of(int) const { return "1"; }

  testing_tools::Folder folder_;
  Timing timing_;
  std::vector<int> codes_;
};

TEST_F(ClusterTest, AnyNumberOfRanksGivesTheSameBytes) {
  const std::string expected = alone({});
  for (const int ranks : {1, 2, 3, 7}) {
    Network network(ranks);
    EXPECT_EQ(together(ranks, {"--block", "16"}, network), expected) << ranks;
    EXPECT_EQ(codes_, std::vector<int>(static_cast<std::size_t>(ranks), kComplete));
    std::uint64_t blocks = 0;
    const nlohmann::json found = stats();
    for (const auto& row : found["cluster"]["ranks"]) {
      blocks += row["blocks"].get<std::uint64_t>();
      EXPECT_EQ(row["outcome"], "reported");
    }
    EXPECT_GT(found["rays"]["eye"].get<std::uint64_t>(), 96u * 64u);
    EXPECT_GE(found["sampling"]["pixels"], 96 * 64);  // blocks may be rendered twice
    EXPECT_EQ(blocks, 24u);
  }
}

TEST_F(ClusterTest, EverySchedule) {
  const std::string expected = alone({});
  for (const char* schedule : {"auto", "roundrobin", "bands", "blocks", "cost"}) {
    Network network(4);
    EXPECT_EQ(together(4, {"--schedule", schedule, "--block", "8"}, network), expected) << schedule;
  }
}

TEST_F(ClusterTest, WindowsFramesAndADedicatedMaster) {
  for (const std::vector<std::string>& options :
       std::vector<std::vector<std::string>>{{"-W", "10", "50", "7", "40"},
                                             {"-X", "0", ".5", "0", ".7"},
                                             {"-N", "3"},
                                             {"--dedicated-master"}}) {
    const std::string expected =
        alone(options[0] == "--dedicated-master" ? std::vector<std::string>{} : options);
    Network network(3);
    EXPECT_EQ(together(3, options, network), expected) << options[0];
  }
  EXPECT_EQ(stats()["cluster"]["ranks"][0]["blocks"], 0);
}

TEST_F(ClusterTest, MessagesLostAndRepeatedDoNoHarm) {
  const std::string expected = alone({});
  for (unsigned seed = 1; seed <= 4; ++seed) {
    Network network(4, {.05, .05, seed});
    EXPECT_EQ(together(4, {"--block", "8"}, network), expected) << seed;
    EXPECT_EQ(codes_[0], kComplete);
  }
}

TEST_F(ClusterTest, TheDeadAreReplacedAndNamed) {
  const std::string expected = alone({"-S", "6"});
  std::mt19937 random(7);
  for (int round = 0; round < 4; ++round) {
    Network network(5);
    const int dead = 1 + static_cast<int>(random() % 4);
    const auto after = std::chrono::milliseconds(random() % (300U * kSlowness));
    const std::string picture = together(5, {"-S", "6", "--block", "8"}, network, [&] {
      std::this_thread::sleep_for(after);
      for (int rank = 1; rank <= dead; ++rank) network.kill(rank);
    });
    EXPECT_EQ(picture, expected);
    EXPECT_EQ(codes_[0], kComplete);
  }
}

TEST_F(ClusterTest, WhoComesBackIsWelcome) {
  const std::string expected = alone({"-S", "8"});
  Network network(2);
  const std::string picture = together(2, {"-S", "8", "--block", "8", "--dedicated-master"}, network, [&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(150 * kSlowness));
    network.kill(1);
    std::this_thread::sleep_for(std::chrono::milliseconds(900 * kSlowness));  // more than `silence`
    network.revive(1);
  });
  EXPECT_EQ(picture, expected);
}

TEST_F(ClusterTest, AfterTheSceneIsSentTheMasterSaysLittle) {
  write_file(path("balls.inc"), read_file(path("balls.inc")) + std::string(200'000, ' '));
  Network network(3);
  together(3, {}, network);
  EXPECT_LE(network.largest_from_master(), 4000u);
}

TEST_F(ClusterTest, ThePackageIsPassedOn) {
  constexpr std::size_t kPieces = 40;
  enlarge_scene(kPieces);
  const std::string expected = alone({});
  constexpr int kRanks = 20;
  Network network(kRanks);
  EXPECT_EQ(together(kRanks, {}, network), expected);
  EXPECT_EQ(codes_, std::vector<int>(kRanks, kComplete));
  std::size_t passed_on = 0;
  for (int rank = 1; rank < kRanks; ++rank) passed_on += network.pieces_from(rank);
  // Four of nineteen pull from the master, and who was too slow.
  EXPECT_GE(network.pieces_from(0), 4 * kPieces);
  EXPECT_LE(network.pieces_from(0), 10 * 2 * kPieces);
  EXPECT_GE(passed_on, 5 * kPieces);
}

TEST_F(ClusterTest, TheDeadDoNotKeepThePackage) {
  enlarge_scene(40);
  const std::string expected = alone({});
  constexpr int kRanks = 12;
  std::mt19937 random(11);
  for (int round = 0; round < 4; ++round) {
    Network network(kRanks);
    const auto after = std::chrono::microseconds(random() % (20'000U * kSlowness));
    const std::string picture = together(kRanks, {"--block", "8"}, network, [&] {
      std::this_thread::sleep_for(after);
      for (int rank = 1; rank <= 6; ++rank) network.kill(rank);
    });
    EXPECT_EQ(picture, expected);
    for (const int rank : {0, 7, 8, 9, 10, 11})
      EXPECT_EQ(codes_[static_cast<std::size_t>(rank)], kComplete) << rank;
  }
}

TEST_F(ClusterTest, ErrorsSendEverybodyHome) {
  write_file(path("scene.ray"), "sphere nonsense\n");
  Network network(3);
  together(3, {}, network);
  EXPECT_EQ(codes_, (std::vector<int>{kFailed, kComplete, kComplete}));
}

class VersionTest : public ClusterTest {
 protected:
  std::string version_of(int rank) const override { return rank == 2 ? "2" : "1"; }
};

TEST_F(VersionTest, AnotherVersionIsRefused) {
  const std::string expected = alone({});
  Network network(3);
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(together(3, {}, network), expected);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("this is pafas 2"));
  EXPECT_EQ(codes_, (std::vector<int>{kComplete, kComplete, kFailed}));
}

}  // namespace
}  // namespace pafas::test
