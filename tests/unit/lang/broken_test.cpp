// SPDX-License-Identifier: MIT
// The corpus of broken scenes, as far as parsing goes: no crash, and messages as its table says. What only a
// later stage can find (missing pictures, absurd screens) parses without errors here; the program's test runs
// those.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "parse_text.h"
#include "rayshade/lang/parse.h"

namespace rayshade {
namespace {

const std::filesystem::path kFolder = SOURCE_DIR "/tests/broken";

/// Reads only files of the corpus, by their names.
class CorpusProvider : public Provider {
 public:
  Bytes read(const std::string& name) override {
    std::ifstream in(kFolder / name, std::ios::binary);
    if (!in) throw ProviderError("No such file or directory");
    std::ostringstream out;
    out << in.rdbuf();
    return std::make_shared<const std::string>(out.str());
  }
};

TEST(BrokenScenes, GiveTheMessagesOfTheTable) {
  // Found when settings are resolved or files are loaded, not while parsing.
  const std::set<std::string> later = {"empty.ray",
                                       "only-comments.ray",
                                       "screen-huge.ray",
                                       "screen-negative.ray",
                                       "screen-zero.ray",
                                       "window-outside.ray",
                                       "window-reversed.ray",
                                       "eye-at-look.ray",
                                       "up-along-view.ray",
                                       "missing-image.ray",
                                       "missing-colormap.ray",
                                       "missing-heightfield.ray",
                                       "animated-zero-scale.ray",
                                       "only-dropped.ray"};
  std::ifstream table(kFolder / "EXPECT");
  std::set<std::string> listed;
  CorpusProvider provider;
  std::string line;
  while (std::getline(table, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string name, pattern;
    int code = -1;
    words >> name >> code;
    std::getline(words >> std::ws, pattern);
    listed.insert(name);
    const ParseResult result = parse_scene(provider, name);
    if (later.contains(name)) {
      EXPECT_TRUE(result.ok) << name << "\n" << test::all_messages(result);
      continue;
    }
    EXPECT_EQ(result.ok, code == 0) << name << "\n" << test::all_messages(result);
    EXPECT_TRUE(std::regex_search(test::all_messages(result), std::regex(pattern)))
        << name << ": " << pattern << "\n"
        << test::all_messages(result);
    for (const Diagnostic& d : result.diagnostics) {
      EXPECT_TRUE(d.severity != Severity::kError || d.location.line > 0) << name << ": " << d.text;
    }
  }
  EXPECT_GE(listed.size(), 60u);
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    EXPECT_TRUE(entry.path().filename() == "EXPECT" || listed.contains(entry.path().filename()))
        << entry.path();
  }
}

}  // namespace
}  // namespace rayshade
