// SPDX-License-Identifier: MIT
// The manual cannot lie: every example in rayshade(5) is rendered, and both pages are clean.
#include <gtest/gtest.h>

#include "tests/program/run.h"

namespace rayshade::testing_tools {
namespace {

namespace fs = std::filesystem;

/// The plain text of a verbatim block of man source.
std::string plain(const std::string& roff) {
  std::string out;
  std::istringstream lines(roff);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(".") || line.starts_with("'\\\"")) continue;
    std::string text;
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (line[i] != '\\' || i + 1 >= line.size()) {
        text += line[i];
        continue;
      }
      const char next = line[++i];
      if (next == '-' || next == '\'' || next == '`')
        text += next;
      else if (next == 'e')
        text += '\\';
      else if (next == 'f')
        i += 1;
      else if (next != '&')
        ADD_FAILURE() << "unknown escape \\" << next << " in an example: " << line;
    }
    out += text + "\n";
  }
  return out;
}

TEST(ManualTest, ExamplesOfTheLanguageRender) {
  std::ifstream in(std::string(SOURCE_DIR) + "/man/rayshade.5");
  std::string name, example;
  int rendered = 0;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(".\\\" example: ")) {
      name = line.substr(13);
      example.clear();
    } else if (line.starts_with(".\\\" end") && !name.empty()) {
      SCOPED_TRACE(name);
      // Examples name files of the scenes folder.
      Folder folder;
      for (const auto& entry : fs::directory_iterator(std::string(SOURCE_DIR) + "/scenes")) {
        if (entry.is_regular_file())
          fs::create_symlink(entry.path(), folder.path() / entry.path().filename());
      }
      const Outcome done = run(folder.path(), "-q -R 24 24 -O example.%d.png", plain(example));
      EXPECT_EQ(done.status, 0) << done.err << "\n" << plain(example);
      EXPECT_TRUE(fs::exists(folder.path() / "example.0.png"));
      ++rendered;
      name.clear();
    } else if (!name.empty()) {
      example += line + "\n";
    }
  }
  EXPECT_GE(rendered, 10);
}

TEST(ManualTest, PagesAreClean) {
  for (const std::string& page :
       {std::string(SOURCE_DIR) + "/man/rayshade.5", std::string(SOURCE_DIR) + "/man/rayshade-spd.1",
        std::string(SOURCE_DIR) + "/man/fas.3", std::string(BINARY_DIR) + "/man/rayshade.1",
        std::string(BINARY_DIR) + "/man/pafas.1"}) {
    if (!fs::exists(page) && page.ends_with("pafas.1")) continue;  // built without MPI
    Folder folder;
    const std::string log = (folder.path() / "log").string();
    EXPECT_EQ(std::system(("LC_ALL=C.UTF-8 MANROFFSEQ= MANWIDTH=80 man --warnings -E UTF-8 -l '" + page +
                           "' >/dev/null 2>'" + log + "'")
                              .c_str()),
              0);
    EXPECT_EQ(read_file(log), "") << page;
  }
}

}  // namespace
}  // namespace rayshade::testing_tools
