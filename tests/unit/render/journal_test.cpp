// SPDX-License-Identifier: MIT
// What was recorded comes back whatever happens to the file: cut at any byte, any bit flipped.
#include "rayshade/render/journal.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

namespace {
std::atomic<int> folders_synced = 0;
}  // namespace

// In the place of the C library's: counts the folders.
extern "C" int fsync(int file) {
  struct stat info {};
  if (fstat(file, &info) == 0 && S_ISDIR(info.st_mode)) ++folders_synced;
  return static_cast<int>(syscall(SYS_fsync, file));
}

namespace rayshade {
namespace {

namespace fs = std::filesystem;

FrameBufferOptions small(int width, int height) {
  FrameBufferOptions out;
  out.width = width;
  out.height = height;
  return out;
}

/// A block whose pixels tell where they are.
EncodedBlock block_at(std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height) {
  EncodedBlock out;
  out.x = x;
  out.y = y;
  out.width = width;
  out.height = height;
  for (std::int64_t v = y; v < y + height; ++v)
    for (std::int64_t u = x; u < x + width; ++u)
      for (const std::int64_t byte : {u, v, u ^ v, std::int64_t{255}})
        out.pixels.push_back(static_cast<std::uint8_t>(byte));
  // Above the line of row 9 every third column is below zero.
  for (std::int64_t v = y; v < y + height && y < 9; ++v)
    for (std::int64_t u = x; u < x + width; ++u) out.odd.push_back(v < 9 && u % 3 == 0 ? kNegative : 0);
  if (count_odd(out.odd) == PixelStatistics{}) out.odd.clear();
  return out;
}

std::int64_t pixels_of(std::string_view payload) {
  const auto record = decode_block_payload(payload, 1 << 20);
  return record ? record->block.width * record->block.height : 0;
}

class JournalTest : public ::testing::Test {
 protected:
  JournalTest() {
    std::string name = (fs::temp_directory_path() / "journal-test-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("mkdtemp");
    folder = name;
    path = folder / "a.png.journal";
  }
  ~JournalTest() override { fs::remove_all(folder); }
  std::string bytes() const {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
  }
  /// In place: file systems flush a file that is truncated and written anew.
  void set(const std::string& content) const {
    fs::resize_file(path, content.size());
    std::fstream(path, std::ios::binary | std::ios::in | std::ios::out) << content;
  }
  void expect_right(const FrameBuffer& picture) const {
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) {
        if (!picture.is_present(x, y)) continue;
        ASSERT_EQ(picture.row(y)[4 * x], x);
        ASSERT_EQ(picture.row(y)[4 * x + 1], y);
      }
    }
  }
  /// Four blocks of 4 x 4 in a picture of 8 x 8.
  void write_four() const {
    FrameBuffer picture(small(8, 8));
    Journal journal(path, identity, picture);
    journal.begin();
    for (const int y : {0, 4})
      for (const int x : {0, 4}) journal.record(0, picture, block_at(x, y, 4, 4));
    EXPECT_EQ(journal.failure(), "");
  }

  fs::path folder, path;
  JournalIdentity identity{
      "abc", {{"samples", "2"}, {"seed", "0"}}, [] { return std::string("screen 8 8\nsphere 1 0 0 0\n"); }};
};

TEST_F(JournalTest, GoesOnFromWhatWasRecorded) {
  write_four();
  FrameBuffer picture(small(8, 8));
  Journal journal(path, identity, picture);
  EXPECT_EQ(journal.found(), Journal::Found::kSame);
  journal.go_on();
  EXPECT_EQ(journal.load(1, picture), 0);
  EXPECT_EQ(journal.load(0, picture), 4);
  EXPECT_TRUE(picture.complete());
  expect_right(picture);
  journal.remove();
  EXPECT_FALSE(fs::exists(path));
}

TEST_F(JournalTest, CutAtAnyByteAllWholeBlocksAreUsedAndItGoesOn) {
  write_four();
  const std::string whole = bytes();
  std::int64_t most = 0;
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    set(whole.substr(0, size));
    FrameBuffer picture(small(8, 8));
    {
      Journal journal(path, identity, picture);
      if (journal.found() != Journal::Found::kSame) {
        EXPECT_EQ(journal.found(), size == 0 ? Journal::Found::kNothing : Journal::Found::kUnusable);
        EXPECT_EQ(most, 0);
        journal.begin();
      } else {
        journal.go_on();
      }
      const std::int64_t blocks = journal.load(0, picture);
      EXPECT_GE(blocks, most);
      most = blocks;
      EXPECT_EQ(picture.present(), 16 * blocks);
      expect_right(picture);
      for (const int y : {0, 4})
        for (const int x : {0, 4}) journal.record(0, picture, block_at(x, y, 4, 4));
    }
    FrameBuffer again(small(8, 8));
    Journal journal(path, identity, again);
    ASSERT_EQ(journal.found(), Journal::Found::kSame);
    EXPECT_EQ(journal.damaged_bytes(), 0U);
    journal.load(0, again);
    EXPECT_TRUE(again.complete());
    expect_right(again);
    EXPECT_EQ(fs::file_size(path), whole.size());  // every pixel once
  }
  EXPECT_EQ(most, 4);
}

TEST_F(JournalTest, AFlippedBitCostsAtMostTheBlockItIsIn) {
  write_four();
  std::string whole = bytes();
  const std::size_t first = open_record(whole)->size;
  FrameBuffer picture(small(8, 8));
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    whole[bit / 8] = static_cast<char>(whole[bit / 8] ^ 1 << bit % 8);
    set(whole);
    picture.clear();
    Journal journal(path, identity, picture);
    if (bit / 8 < first) {
      EXPECT_EQ(journal.found(), Journal::Found::kUnusable);
    } else {
      EXPECT_EQ(journal.found(), Journal::Found::kSame);
      EXPECT_EQ(journal.load(0, picture), 3);
      EXPECT_GT(journal.damaged_bytes(), 0U);
      expect_right(picture);
    }
    whole[bit / 8] = static_cast<char>(whole[bit / 8] ^ 1 << bit % 8);
  }
}

TEST_F(JournalTest, AnyRectanglesAreRecordedPixelByPixelOnce) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  FrameBuffer picture(small(40, 30));
  {
    Journal journal(path, identity, picture);
    journal.begin();
    for (int i = 0; i < 200; ++i) {
      const int x = static_cast<int>(random() % 40), y = static_cast<int>(random() % 30);
      const EncodedBlock block = block_at(x, y, 1 + random() % static_cast<unsigned>(40 - x),
                                          1 + random() % static_cast<unsigned>(30 - y));
      journal.record(0, picture, block);
      picture.put(block);
    }
  }
  std::uint64_t recorded = 0;
  const std::string content = bytes();
  for (std::string_view rest = content; const auto record = open_record(rest);) {
    if (record->kind == RecordKind::kBlock)
      recorded += 4 * static_cast<std::size_t>(pixels_of(record->payload));
    rest.remove_prefix(record->size);
  }
  EXPECT_EQ(recorded, 4U * static_cast<unsigned>(picture.present()));
  FrameBuffer back(small(40, 30));
  Journal journal(path, identity, back);
  journal.load(0, back);
  EXPECT_EQ(back.present(), picture.present());
  EXPECT_EQ(back.statistics(), picture.statistics());
  EXPECT_GT(back.statistics().negative, 0U);
  expect_right(back);
}

TEST_F(JournalTest, ASecondOneOnTheSameFileIsRefused) {
  FrameBuffer picture(small(8, 8));
  const Journal journal(path, identity, picture);
  EXPECT_THROW(Journal(path, identity, picture), JournalError);
}

TEST_F(JournalTest, TellsWhatChanged) {
  const auto changed = [&](auto change) {
    JournalIdentity now = identity;
    change(now);
    return first_difference(identity, now);
  };
  EXPECT_EQ(first_difference(identity, identity), "");
  EXPECT_EQ(changed([](auto& now) { now.values[0].second = "4"; }), "samples was 2, is now 4");
  EXPECT_EQ(changed([](auto& now) { now.values.pop_back(); }), "seed was 0, is now not set");
}

TEST_F(JournalTest, TellsWhatChangedInTheScene) {
  const FrameBuffer picture(small(8, 8));
  JournalIdentity other = identity;
  other.scene_hash = "x";
  other.scene_text = [] { return std::string("screen 8 8\nsphere 2 0 0 0\n"); };
  {
    Journal journal(path, identity, picture);
    journal.begin();
  }
  EXPECT_EQ(Journal(path, other, picture).found(), Journal::Found::kAnother);
  EXPECT_EQ(Journal(path, other, picture).difference(), "the scene has changed");
  {
    Journal journal(path, identity, picture);
    journal.go_on();
    journal.record_scene();
    journal.record_scene();  // once is enough
  }
  const auto size = fs::file_size(path);
  EXPECT_EQ(Journal(path, other, picture).difference(),
            "the scene has changed: 'sphere 1 0 0 0' is now 'sphere 2 0 0 0'");
  {
    // The text is not asked for where it is recorded already.
    JournalIdentity same = identity;
    same.scene_text = [] { return std::string("not this"); };
    Journal journal(path, same, picture);
    EXPECT_EQ(journal.found(), Journal::Found::kSame);
    journal.go_on();
    journal.record_scene();
  }
  EXPECT_EQ(fs::file_size(path), size);
}

TEST_F(JournalTest, LinesOfLargeScenesAreCompared) {
  // Above what is kept as text.
  std::vector<std::string> lines;
  for (int i = 0; i < 20'000; ++i) lines.push_back("sphere 1 0 0 " + std::to_string(i));
  const auto joined = [](const std::vector<std::string>& all) {
    std::string text;
    for (const std::string& line : all) text += line + "\n";
    return text;
  };
  identity.scene_text = [&] { return joined(lines); };
  const FrameBuffer picture(small(8, 8));
  {
    Journal journal(path, identity, picture);
    journal.begin();
    journal.record_scene();
  }
  EXPECT_LT(fs::file_size(path), 8U * 20'000 + 1000);
  const auto changed = [&](auto change) {
    std::vector<std::string> now = lines;
    change(now);
    JournalIdentity other = identity;
    other.scene_text = [&] { return joined(now); };
    other.scene_hash = "x";
    return Journal(path, other, picture).difference();
  };
  EXPECT_EQ(Journal(path, identity, picture).found(), Journal::Found::kSame);
  EXPECT_EQ(changed([](auto& now) { now[12'344] = "box"; }),
            "the scene has changed, first in its line 12345 that is now 'box'");
  EXPECT_EQ(changed([](auto& now) { now.emplace_back("box"); }), "the scene has changed: 'box' is new");
  EXPECT_EQ(changed([](auto& now) { now.resize(19'990); }),
            "the scene has changed: the last 10 of its 20000 lines are gone");
  EXPECT_EQ(changed([](auto& now) { now.clear(); }), "the scene has changed");
}

TEST_F(JournalTest, ItsNameIsOnTheDiskToo) {
  const auto synced_by = [](auto&& what) {
    const int before = folders_synced;
    what();
    return folders_synced - before;
  };
  FrameBuffer picture(small(512, 512));
  {
    Journal journal(path, identity, picture);
    journal.begin();
    EXPECT_EQ(synced_by([&] { journal.sync(); }), 1);
    journal.record(0, picture, block_at(0, 0, 512, 512));
    EXPECT_EQ(synced_by([&] { journal.sync(); }), 0);
    journal.finish_frame(0, 1);  // a new file
    EXPECT_EQ(synced_by([&] { journal.sync(); }), 1);
    EXPECT_EQ(synced_by([&] { journal.sync(); }), 0);
  }
  Journal journal(path, identity, picture);
  journal.go_on();
  EXPECT_EQ(synced_by([&] { journal.sync(); }), 1);
}

TEST_F(JournalTest, TheNewFileOfAKilledProcessIsRemoved) {
  const FrameBuffer picture(small(8, 8));
  const std::string half = path.string() + ".new";
  for (const bool first : {true, false}) {
    std::ofstream(half) << "half";
    Journal journal(path, identity, picture);
    EXPECT_TRUE(fs::exists(half));
    if (first)
      journal.begin();
    else
      journal.go_on();
    EXPECT_FALSE(fs::exists(half));
  }
}

TEST_F(JournalTest, BlocksOfFinishedFramesAreDropped) {
  FrameBuffer picture(small(512, 512));
  {
    Journal journal(path, identity, picture);
    journal.begin();
    for (int frame = 0; frame < 5; ++frame) {
      picture.clear();
      journal.record(frame, picture, block_at(0, 0, 512, 512));
      if (frame < 4) journal.finish_frame(frame, 1000);
      EXPECT_LT(fs::file_size(path), 3U << 20);
    }
    EXPECT_THROW(Journal(path, identity, picture), JournalError);  // the new file is locked too
  }
  EXPECT_FALSE(fs::exists(path.string() + ".new"));
  picture.clear();
  Journal journal(path, identity, picture);
  ASSERT_EQ(journal.found(), Journal::Found::kSame);
  EXPECT_EQ(journal.finished(3), 1000U);
  EXPECT_FALSE(journal.finished(4));
  EXPECT_EQ(journal.load(3, picture), 0);
  EXPECT_EQ(journal.load(4, picture), 1);
}

}  // namespace
}  // namespace rayshade
