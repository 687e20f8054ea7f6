// SPDX-License-Identifier: MIT
// Messages: their form, several per run, suggestions, limits; and that parsing canonical text changes
// nothing.
#include "rayshade/lang/diagnostic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "parse_text.h"
#include "rayshade/lang/suggest.h"

namespace rayshade {
namespace {

using test::all_messages;
using test::brief;
using test::parse_text;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST(Messages, ShowTheLineAndACaret) {
  EXPECT_EQ(all_messages(parse_text("sphere 1 0 0 0\n\tshpere 1 0 0 0\n")),
            "scene.ray:2:2: error: unexpected 'shpere'; expected a new item, a transform or 'texture'\n"
            "   shpere 1 0 0 0\n"
            "   ^~~~~~\n"
            "  did you mean 'sphere'?\n");
  const std::string colored = format_diagnostic(parse_text("bad").diagnostics.at(0), true);
  EXPECT_THAT(colored, HasSubstr("\033[1;31merror"));
  EXPECT_THAT(colored, HasSubstr("\033[0m"));
}

TEST(Messages, NeverSendControlCharactersToTheTerminal) {
  const std::string text = all_messages(parse_text("sphere 1 0 0 0 \x1b[2J\x07 x"));
  EXPECT_THAT(text, Not(HasSubstr("\x1b")));
  EXPECT_THAT(text, Not(HasSubstr("\x07")));
}

TEST(Messages, CutLongLines) {
  const ParseResult result = parse_text(std::string(100000, ' ') + "bad" + std::string(100000, ' '));
  ASSERT_EQ(result.diagnostics.size(), 1u);
  const Diagnostic& d = result.diagnostics[0];
  EXPECT_LE(d.source_line.size(), 200u);
  EXPECT_EQ(d.source_line.substr(d.caret_begin, d.caret_end - d.caret_begin), "bad");
  EXPECT_EQ(d.location.column, 65535);  // the largest that is kept
}

TEST(Recovery, ReportsEveryMistakeOnce) {
  EXPECT_THAT(
      brief(parse_text("screen 10\n"                                // misses a number
                       "light 1 pont 0 0 0\n"                       // misspelt
                       "sphere 1 0 0 0 texture imge a.png\n"        // misspelt
                       "list sphere 1 0 0 box 0 0 0 1 1 1 end\n"    // inside a list
                       "object nothing\n"                           // not defined
                       "grid 2 2 sphere 1 0 0 0 end\n"              // head of a grid
                       "sphere 1 0 0 0 scale 0 1 1 shadowtransp\n"  // value
                       "end\n"                                      // nothing open
                       "sphere 1 0 0 0\n")),
      ElementsAre(
          "2:1 error unexpected 'light'; expected a number",
          "2:9 error unexpected 'pont'; expected a number, 'ambient', 'area', 'directional', 'extended', "
          "'point' or 'spot'",
          testing::StartsWith("3:24 error unexpected 'imge'"),
          "4:19 error unexpected 'box'; expected a number", "5:8 error there is no object named 'nothing'",
          "6:10 error unexpected 'sphere'; expected a number", "7:16 error degenerate scale: factor x is 0",
          "8:1 error this 'end' closes nothing: no list, grid or CSG object is open"));
}

TEST(Recovery, StopsAfterTwentyErrors) {
  std::string text;
  for (int i = 0; i < 100; ++i) text += "object missing\n";
  const ParseResult result = parse_text(text);
  ASSERT_EQ(result.diagnostics.size(), 21u);
  EXPECT_EQ(result.diagnostics.back().text, "too many errors");
  ParseOptions five;
  five.max_errors = 5;
  EXPECT_EQ(parse_text(text, five).diagnostics.size(), 6u);
}

TEST(Recovery, DoesNotComplainAboutWhatAMistakeTookAway) {
  EXPECT_THAT(
      brief(parse_text(
          "union object missing sphere 1 0 0 0 end name a object missing object a\nlist object missing end")),
      ElementsAre("1:14 error there is no object named 'missing'",
                  "1:55 error there is no object named 'missing'",
                  "2:13 error there is no object named 'missing'"));
}

TEST(Warnings, AreNotRepeatedWithoutEnd) {
  std::string text;
  for (int i = 0; i < 5000; ++i) text += "sphere 0 0 0 0\n";
  const ParseResult result = parse_text(text);
  EXPECT_TRUE(result.ok);
  ASSERT_EQ(result.diagnostics.size(), 11u);
  EXPECT_THAT(result.diagnostics.back().text, HasSubstr("4990 more like this: degenerate sphere"));
}

TEST(Suggestions, AreNear) {
  EXPECT_EQ(lang::edit_distance("kitten", "sitting", 9), 3u);
  EXPECT_EQ(lang::edit_distance("ab", "ba", 9), 1u);
  EXPECT_EQ(lang::edit_distance("", "abc", 9), 3u);
  EXPECT_EQ(lang::edit_distance("abcdef", "uvwxyz", 2), 3u);
  const std::pair<const char*, const char*> table[] = {{"shpere 1 0 0 0", "sphere"},
                                                       {"surface a difuse 1 0 0", "diffuse"},
                                                       {"sphere 1 0 0 0 texture woood", "wood"},
                                                       {"backgroud 0 0 0", "background"},
                                                       {"light 1 directonal 0 0 1", "directional"},
                                                       {"report verbos verbose", "verbose"}};
  for (const auto& [text, word] : table) {
    EXPECT_THAT(all_messages(parse_text(text)), HasSubstr(std::string("did you mean '") + word + "'?"))
        << text;
  }
  EXPECT_THAT(all_messages(parse_text("qwertz 1 0 0 0")), Not(HasSubstr("did you mean")));
}

TEST(Scenes, ThatCannotBeReadAreErrors) {
  MemoryProvider provider;
  const ParseResult result = parse_scene(provider, "missing.ray");
  EXPECT_FALSE(result.ok);
  EXPECT_THAT(all_messages(result), testing::StartsWith("missing.ray: error: cannot read the scene"));
  provider.add("-", "oops");
  EXPECT_THAT(all_messages(parse_scene(provider, "-")), testing::StartsWith("stdin:1:1: error"));
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

TEST(CanonicalText, ParsesToItself) {
  int scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SOURCE_DIR "/tests/fuzz/corpus")) {
    const ParseResult first = parse_text(read_file(entry.path()));
    if (!first.ok) continue;
    ++scenes;
    const std::string text = canonical_text(first.scene);
    const ParseResult second = parse_text(text);
    ASSERT_TRUE(second.ok) << entry.path() << "\n" << all_messages(second) << text;
    EXPECT_EQ(canonical_text(second.scene), text) << entry.path();
    EXPECT_EQ(first.scene.world.size(), second.scene.world.size()) << entry.path();
  }
  EXPECT_GE(scenes, 20);
}

}  // namespace
}  // namespace rayshade
