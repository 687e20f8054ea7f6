// SPDX-License-Identifier: MIT
// Messages survive the way there and back; anything else is refused, however it came about.
#include "pafas/archive.h"

#include <gtest/gtest.h>

#include <random>

#include "pafas/message.h"
#include "pafas/package.h"

namespace pafas {
namespace {

Results sample_results() {
  Results results;
  results.frame = 3;
  results.wants_work = true;
  results.sent = 1.5;
  for (int i = 0; i < 3; ++i) {
    Result result;
    result.number = i;
    result.cpu_seconds = .25 * i;
    result.record = std::string(100, static_cast<char>(i));
    results.results.push_back(std::move(result));
  }
  return results;
}

TEST(ArchiveTest, MessagesComeBackAsTheyWere) {
  const std::string bytes = pack(sample_results());
  EXPECT_EQ(kind_of(bytes), Kind::kResults);
  const auto again = unpack<Results>(bytes);
  EXPECT_EQ(pack(again), bytes);
  EXPECT_EQ(again.results[2].record, sample_results().results[2].record);
  EXPECT_EQ(again.results[1].cpu_seconds, .25);

  Plan plan{
      "no", {"-O", "a b.png", ""}, "hash", {rayshade::PixelStorage::kWord, {2.2, true}, {"depth.Z"}}, 77, 3};
  const auto plan_again = unpack<Plan>(pack(plan));
  EXPECT_EQ(plan_again.arguments, plan.arguments);
  EXPECT_EQ(plan_again.format, plan.format);
  EXPECT_EQ(plan_again.package_bytes, 77u);
  EXPECT_EQ(plan_again.source, 3);

  RankReport report;
  report.host = "node1";
  report.statistics.shading.eye_rays = 5;
  report.statistics.intersector.classes.resize(2);
  report.statistics.intersector.classes[1].in_tree.nodes = 9;
  const auto report_again = unpack<Report>(pack(Report{report})).report;
  EXPECT_EQ(report_again.tree_nodes(), 9u);
  EXPECT_EQ(report_again.statistics.shading.eye_rays, 5u);
}

TEST(ArchiveTest, EveryCutIsRefused) {
  const std::string bytes = pack(sample_results());
  for (std::size_t size = 1; size < bytes.size(); ++size)
    EXPECT_THROW(unpack<Results>(std::string_view(bytes).substr(0, size)), ArchiveError) << size;
  EXPECT_THROW(unpack<Results>(bytes + '\0'), ArchiveError);
  EXPECT_THROW(kind_of(""), ArchiveError);
  EXPECT_THROW(kind_of("\xff"), ArchiveError);
}

TEST(ArchiveTest, FlippedBitsGiveAValueOrAnError) {
  std::mt19937 random(1);
  const std::string good = pack(sample_results());
  int refused = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::string bytes = good;
    for (unsigned k = 0; k <= random() % 4; ++k)
      bytes[1 + random() % (bytes.size() - 1)] ^= static_cast<char>(1U << (random() % 8));
    try {
      unpack<Results>(bytes);
    } catch (const ArchiveError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
}

TEST(PackageTest, FilesComeBackAndDamageIsNoticed) {
  // The provider reads this very file.
  RecordingProvider provider;
  const std::string name = SOURCE_DIR "/tests/unit/pafas/archive_test.cpp";
  const rayshade::Bytes bytes = provider.read(name);
  const std::string package = provider.package();
  EXPECT_LT(package.size(), bytes->size());
  rayshade::MemoryProvider memory;
  unpack_files(package, memory);
  EXPECT_EQ(*memory.read(name), *bytes);
  for (std::size_t i = 0; i < package.size(); i += 7) {
    std::string damaged = package;
    damaged[i] ^= 0x10;
    rayshade::MemoryProvider other;
    try {
      unpack_files(damaged, other);
      EXPECT_EQ(*other.read(name), *bytes) << i;
    } catch (const ArchiveError&) {
    }
  }
}

}  // namespace
}  // namespace pafas
