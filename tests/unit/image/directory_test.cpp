// SPDX-License-Identifier: MIT
// Hidden files of killed processes go, all others stay.
#include "rayshade/image/directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "rayshade/image/output_file.h"

namespace rayshade {
namespace {

namespace fs = std::filesystem;
using testing::UnorderedElementsAre;

class DirectoryTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "/directory-XXXXXX";
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    directory_ = pattern;
  }
  void TearDown() override { fs::remove_all(directory_); }

  std::string path(const std::string& name) const { return (directory_ / name).string(); }
  void create(const std::string& name) const { std::ofstream(path(name)) << "x"; }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(directory_))
      all.push_back(entry.path().filename().string());
    return all;
  }
  /// The hidden name of another process for a target.
  static std::string hidden(const std::string& target, pid_t process, const std::string& attempt = "0") {
    std::string name = temporary_name(target, 0);
    const std::string own = std::to_string(getpid()) + ".0.tmp";
    return name.replace(name.size() - own.size(), own.size(),
                        std::to_string(process) + "." + attempt + ".tmp");
  }
  /// The number of a process that has just died.
  static pid_t dead() {
    const pid_t child = fork();
    if (child == 0) _exit(0);
    waitpid(child, nullptr, 0);
    return child;
  }

  fs::path directory_;
};

TEST_F(DirectoryTest, OnlyLeftoversOfTheDeadAreRemoved) {
  const pid_t gone = dead(), living = getppid();
  const std::vector<std::string> leftovers = {hidden("a.png", gone), hidden("a.png", gone, "12"),
                                              hidden("b.c.png", gone)};
  const std::string mark = hidden("", gone).substr(2, 8);
  std::string elsewhere = hidden("a.png", gone);
  elsewhere.replace(elsewhere.find(mark), 8, mark == "00000000" ? "00000001" : "00000000");
  const std::string dead_number = std::to_string(gone);
  const std::vector<std::string> stay = {
      "a.png",
      hidden("a.png", living),
      elsewhere,
      hidden("other.png", gone),
      hidden("a.png", gone, "01"),
      hidden("a.png", gone, ""),
      hidden("a.png", gone, "-1"),
      hidden("a.png", gone).substr(1),
      hidden("a.png", gone) + "x",
      ".a.png." + dead_number + ".0.tmp",
      ".a.png." + mark + ".0" + dead_number + ".0.tmp",
      ".a.png." + mark + ".0.0.tmp",
      ".a.png." + mark + ".99999999999999999999.0.tmp",
  };
  for (const std::string& name : leftovers) create(name);
  for (const std::string& name : stay) create(name);
  const std::string folder = hidden("a.png", gone, "2"), link = hidden("a.png", gone, "3");
  fs::create_directory(path(folder));
  fs::create_symlink("a.png", path(link));

  EXPECT_EQ(remove_leftovers({path("a.png"), path("b.c.png"), path("none/x.png")}), 3);
  std::vector<std::string> expected = stay;
  expected.push_back(folder);
  expected.push_back(link);
  EXPECT_THAT(names(), testing::UnorderedElementsAreArray(expected));
}

TEST_F(DirectoryTest, WhatAKilledProcessWasWritingIsRemoved) {
  fs::create_symlink("target.png", path("link.png"));
  const std::string long_name(250, 'n');
  for (const std::string& name : {std::string("a.png"), std::string("link.png"), long_name}) {
    const pid_t child = fork();
    if (child == 0) {
      OutputFile file(path(name));
      file.write("half");
      kill(getpid(), SIGKILL);
    }
    waitpid(child, nullptr, 0);
    EXPECT_EQ(names().size(), 2U);  // the link and the hidden file
    EXPECT_EQ(remove_leftovers({path(name)}), 1);
    EXPECT_THAT(names(), UnorderedElementsAre("link.png"));
  }
}

TEST_F(DirectoryTest, AnEarlierProcessOfOurNumberIsDead) {
  create(temporary_name("a.png", 0));
  EXPECT_EQ(remove_leftovers({path("a.png")}), 1);
}

TEST_F(DirectoryTest, FoldersCanBeSynced) {
  EXPECT_TRUE(sync_directory_of(path("any")));
  EXPECT_TRUE(sync_directory_of("here"));
  EXPECT_FALSE(sync_directory_of(path("none/any")));
}

}  // namespace
}  // namespace rayshade
