// SPDX-License-Identifier: MIT
// Files appear whole or not at all.
#include "rayshade/image/output_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <future>
#include <sstream>

#include "rayshade/image/format.h"

namespace rayshade {
namespace {

namespace fs = std::filesystem;

class OutputFileTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "/output-XXXXXX";
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    directory_ = pattern;
  }
  void TearDown() override { fs::remove_all(directory_); }

  std::string path(const std::string& name) const { return (directory_ / name).string(); }
  std::string content(const std::string& name) const {
    std::ifstream in(path(name), std::ios::binary);
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
  }
  void create(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
  }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(directory_))
      all.push_back(entry.path().filename().string());
    std::sort(all.begin(), all.end());
    return all;
  }

  fs::path directory_;
};

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(OutputFileTest, AppearsWithTheCommit) {
  create("a.png", "old");
  {
    OutputFile file(path("a.png"));
    file.write("new picture");
    EXPECT_FALSE(file.direct());
    EXPECT_EQ(content("a.png"), "old");
    file.commit();
    EXPECT_EQ(content("a.png"), "new picture");
    EXPECT_THROW(file.write("more"), WriteError);
    EXPECT_THROW(file.commit(), WriteError);
  }
  EXPECT_THAT(names(), ElementsAre("a.png"));
}

TEST_F(OutputFileTest, VanishesWithoutCommit) {
  create("a.png", "old");
  {
    OutputFile file(path("a.png")), second(path("a.png")), fresh(path("b.png"));
    file.write(std::string(1 << 20, 'x'));
    EXPECT_EQ(names().size(), 4U);  // three hidden ones beside the old one
  }
  EXPECT_THAT(names(), ElementsAre("a.png"));
  EXPECT_EQ(content("a.png"), "old");
}

TEST_F(OutputFileTest, LargeWritesArriveInOrder) {
  std::string expected;
  OutputFile file(path("a"));
  for (int i = 0; i < 300; ++i) {
    const std::string part(static_cast<std::size_t>(i * i * 7), static_cast<char>('a' + i % 26));
    file.write(part);
    expected += part;
  }
  EXPECT_EQ(file.written(), expected.size());
  file.overwrite(100, "XYZ", 3);
  expected.replace(100, 3, "XYZ");
  EXPECT_THROW(file.overwrite(expected.size() - 1, "ab", 2), WriteError);
  file.commit();
  EXPECT_EQ(content("a"), expected);
}

TEST_F(OutputFileTest, AppendsToWhatIsThere) {
  create("a.rle", "one.");
  {
    OutputFile file(path("a.rle"), OutputFile::Mode::kAppend);
    EXPECT_EQ(file.written(), 4U);
    file.write("two.");
    EXPECT_EQ(content("a.rle"), "one.");
    file.commit();
  }
  EXPECT_EQ(content("a.rle"), "one.two.");
  OutputFile fresh(path("b.rle"), OutputFile::Mode::kAppend);
  fresh.write("first");
  fresh.commit();
  EXPECT_EQ(content("b.rle"), "first");
}

TEST_F(OutputFileTest, MarkedContentIsWholeFrames) {
  {
    OutputFile file(path("a.rle"));
    file.write("frame1");
    EXPECT_FALSE(file.commit_marked(path("never.rle")));
  }
  {
    OutputFile file(path("a.rle"));
    file.write("frame1");
    file.mark();
    file.write("half of fra");
    EXPECT_TRUE(file.commit_marked(partial_name(path("a.rle"))));
  }
  EXPECT_THAT(names(), ElementsAre("a.partial.rle"));
  EXPECT_EQ(content("a.partial.rle"), "frame1");
}

TEST_F(OutputFileTest, KeepsPermissionsAndFollowsLinks) {
  create("target.png", "old");
  fs::permissions(path("target.png"), fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("target.png", path("link.png"));
  fs::create_symlink("later.png", path("dangling.png"));
  for (const char* name : {"link.png", "dangling.png"}) {
    OutputFile file(path(name));
    file.write("new");
    file.commit();
    EXPECT_TRUE(fs::is_symlink(path(name)));
  }
  EXPECT_EQ(content("target.png"), "new");
  EXPECT_EQ(content("later.png"), "new");
  EXPECT_EQ(fs::status(path("target.png")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(OutputFileTest, LongNamesHaveRoom) {
  const std::string name(250, 'n');
  OutputFile file(path(name));
  file.write("x");
  file.commit();
  EXPECT_THAT(names(), ElementsAre(name));
}

void expect_failure(const std::string& path, const std::string& reason) {
  try {
    OutputFile file(path);
    file.write("data");
    file.commit();
    ADD_FAILURE() << path;
  } catch (const WriteError& error) {
    EXPECT_THAT(error.what(), HasSubstr(reason));
  }
}

TEST_F(OutputFileTest, SaysWhyItCannotWrite) {
  expect_failure("", "No such file");
  expect_failure(path("missing/a.png"), "No such file or directory");
  expect_failure(path("missing/a.png"), "missing/a.png");
  expect_failure(directory_.string(), "Is a directory");
  expect_failure(path("new/"), "directory");
  expect_failure("/dev/full", "No space left on device");
  EXPECT_THAT(names(), IsEmpty());
  if (::geteuid() != 0) {
    create("read-only", "old");
    fs::permissions(path("read-only"), fs::perms::owner_read);
    expect_failure(path("read-only"), "Permission denied");
    EXPECT_EQ(content("read-only"), "old");
  }
}

TEST_F(OutputFileTest, FailsOnTheWayWithoutATrace) {
  create("a.png", "old");
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 1 << 20;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  std::string message;
  try {
    OutputFile file(path("a.png"));
    for (int i = 0; i < 64; ++i) file.write(std::string(1 << 17, 'x'));
    file.commit();
  } catch (const WriteError& error) {
    message = error.what();
  }
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_THAT(message, HasSubstr("File too large"));
  EXPECT_THAT(names(), ElementsAre("a.png"));
  EXPECT_EQ(content("a.png"), "old");
}

TEST_F(OutputFileTest, PipesAndDevicesAreWrittenDirectly) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  auto reader = std::async(std::launch::async, [this] { return content("pipe"); });
  OutputFile file(path("pipe"));
  EXPECT_TRUE(file.direct());
  EXPECT_FALSE(file.can_overwrite());
  file.write("through the pipe");
  file.commit();
  EXPECT_EQ(reader.get(), "through the pipe");
  EXPECT_TRUE(fs::is_fifo(path("pipe")));
  OutputFile null("/dev/null");
  null.write("nothing");
  null.commit();
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_THAT(names(), ElementsAre("pipe"));
}

TEST_F(OutputFileTest, StandardOutputStaysOpen) {
  for (const char* name : {"-", "/dev/stdout"}) {
    testing::internal::CaptureStdout();
    {
      OutputFile file(name);
      file.write("picture");
      file.commit();
    }
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "picture");
  }
  EXPECT_NE(::fcntl(STDOUT_FILENO, F_GETFD), -1);
}

}  // namespace
}  // namespace rayshade
