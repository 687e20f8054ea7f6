// SPDX-License-Identifier: MIT
// Files, pipes, devices, standard input, and the reasons given where they cannot be read.
#include "rayshade/scene/provider.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

namespace rayshade {
namespace {

/// A directory of its own for each test, removed at the end.
class ProviderTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "provider-test-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    directory_ = pattern;
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  std::string path(const std::string& name) const { return (directory_ / name).string(); }
  std::string write(const std::string& name, const std::string& content) const {
    std::ofstream(path(name), std::ios::binary) << content;
    return path(name);
  }

  std::filesystem::path directory_;
};

std::string error_of(Provider& provider, const std::string& name) {
  try {
    provider.read(name);
  } catch (const ProviderError& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(ProviderTest, ReadsWholeFiles) {
  FileProvider files;
  std::string content(300000, 'x');
  content[7] = '\0';
  content[299999] = '\n';
  EXPECT_EQ(*files.read(write("large", content)), content);
  EXPECT_EQ(*files.read(write("empty", "")), "");
}

TEST_F(ProviderTest, SaysWhyNot) {
  FileProvider files(1000);
  EXPECT_EQ(error_of(files, path("none")), "No such file or directory");
  EXPECT_EQ(error_of(files, directory_.string()), "Is a directory");
  EXPECT_EQ(error_of(files, write("large", std::string(1001, 'x'))), "File too large");
  EXPECT_EQ(files.read(write("fits", std::string(1000, 'x')))->size(), 1000u);
  EXPECT_EQ(error_of(files, path("fits/below")), "Not a directory");
  EXPECT_EQ(error_of(files, std::string("a\0b", 3)), "Invalid argument");
  EXPECT_EQ(error_of(files, ""), "No such file or directory");
}

TEST_F(ProviderTest, ReadsPipes) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  const std::string content(200000, 'p');
  std::thread writer([&] { write("pipe", content); });
  FileProvider files;
  EXPECT_EQ(*files.read(path("pipe")), content);
  writer.join();
}

TEST_F(ProviderTest, StreamsWithoutEndStop) {
  FileProvider files(1 << 20);
  EXPECT_EQ(error_of(files, "/dev/zero"), "File too large");
}

TEST_F(ProviderTest, StandardInputIsReadOnce) {
  const std::string name = write("input", "eyep 0 0 0\n");
  const int saved = dup(STDIN_FILENO);
  const int file = open(name.c_str(), O_RDONLY);
  ASSERT_GE(file, 0);
  dup2(file, STDIN_FILENO);
  close(file);
  FileProvider files;
  EXPECT_EQ(*files.read("-"), "eyep 0 0 0\n");
  EXPECT_EQ(*files.read("-"), "eyep 0 0 0\n");
  EXPECT_EQ(files.read("-"), files.read("-"));
  dup2(saved, STDIN_FILENO);
  close(saved);
}

TEST(MemoryProviderTest, ServesWhatItWasGiven) {
  MemoryProvider memory;
  memory.add("a", "1");
  memory.add("a", "2");
  EXPECT_EQ(*memory.read("a"), "2");
  EXPECT_EQ(error_of(memory, "b"), "No such file or directory");
}

}  // namespace
}  // namespace rayshade
