// SPDX-License-Identifier: MIT
// Every broken scene of tests/broken ends as its line in EXPECT says: no crash, no hang, no picture, a
// message with a place. Lines: NAME EXIT-CODE REGULAR-EXPRESSION (searched in standard error).
#include <gtest/gtest.h>

#include <regex>

#include "tests/program/run.h"

namespace rayshade::testing_tools {
namespace {

namespace fs = std::filesystem;

struct Expectation {
  std::string name;
  int status = 0;
  std::string pattern;
};

std::vector<Expectation> expectations() {
  std::vector<Expectation> out;
  std::ifstream in(std::string(SOURCE_DIR) + "/tests/broken/EXPECT");
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    Expectation e;
    words >> e.name >> e.status;
    std::getline(words >> std::ws, e.pattern);
    out.push_back(e);
  }
  return out;
}

TEST(BrokenScenesTest, EachEndsAsExpected) {
  const std::vector<Expectation> all = expectations();
  EXPECT_GE(all.size(), 60u);
  Folder folder;
  fs::copy(std::string(SOURCE_DIR) + "/tests/broken", folder.path(), fs::copy_options::recursive);
  for (const Expectation& e : all) {
    SCOPED_TRACE(e.name);
    const fs::path picture = folder.path() / "picture.png";
    // Address space is limited so that eating the machine is a failure here.
    const Outcome done = run(folder.path(), "-q -S 1 -O picture.png " + e.name, {}, 30,
                             kSanitized ? "" : "ulimit -v 4000000;");
    EXPECT_EQ(done.status, e.status) << done.err;
    EXPECT_TRUE(std::regex_search(done.err, std::regex(e.pattern))) << "expected: " << e.pattern << "\n"
                                                                    << done.err;
    EXPECT_EQ(fs::exists(picture), e.status == 0);
    fs::remove(picture);
  }
}

}  // namespace
}  // namespace rayshade::testing_tools
