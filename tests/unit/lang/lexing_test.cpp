// SPDX-License-Identifier: MIT
// Words, numbers, file names, comments and line markers (language.md 1).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "parse_text.h"
#include "rayshade/lang/keywords.h"
#include "rayshade/lang/preprocessor.h"

namespace rayshade {
namespace {

using test::all_messages;
using test::parse_text;
using testing::HasSubstr;

TEST(Keywords, AreTheTableOfTheLanguage) {
  EXPECT_EQ(lang::keywords().size(), 108u);
  for (const lang::Keyword& keyword : lang::keywords()) {
    EXPECT_EQ(lang::keyword_token(keyword.name), keyword.token) << keyword.name;
    // None may name a surface, an object or a symbol.
    const std::string word(keyword.name);
    EXPECT_FALSE(parse_text("surface " + word + " diffuse 1 1 1").ok) << word;
    EXPECT_FALSE(parse_text("name " + word + " sphere 1 0 0 0").ok) << word;
    EXPECT_FALSE(parse_text("define " + word + " 1").ok) << word;
  }
  for (const char* word : {"samples", "gaussian", "jittered", "cyl", "thresh", "intersection", "fields",
                           "Sphere", "time", "frame", "linear", "pi", "sin"}) {
    EXPECT_EQ(lang::keyword_token(word), 0) << word;
    EXPECT_TRUE(
        parse_text(std::string("surface ") + word + " name " + word + " sphere " + word + " 1 0 0 0").ok)
        << word;
  }
}

TEST(Keywords, SynonymsShareTheirToken) {
  const std::pair<const char*, const char*> pairs[] = {{"polygon", "poly"},
                                                       {"reflective", "reflect"},
                                                       {"resolution", "screen"},
                                                       {"translucency", "translu"},
                                                       {"transparent", "transp"}};
  for (const auto& [a, b] : pairs) EXPECT_EQ(lang::keyword_token(a), lang::keyword_token(b));
}

TEST(Names, MayHoldDotsDashesAndUnderscores) {
  for (const char* name : {"a", "A", "column-base", "a.", "a-", "a.b_c-9", "Sphere"}) {
    EXPECT_TRUE(parse_text(std::string("surface ") + name).ok) << name;
  }
  for (const char* name : {"1a", "_a", ".a", "-a", "\"a\"", "a/b"}) {
    EXPECT_FALSE(parse_text(std::string("surface ") + name).ok) << name;
  }
}

double print_value(const std::string& expression) {
  const ParseResult result = parse_text("define a 6 define b 3 print " + expression);
  EXPECT_TRUE(result.ok) << expression << "\n" << all_messages(result);
  return result.prints.size() == 1 ? std::stod(result.prints[0]) : -12345;
}

TEST(Names, DecideWhatDashesAndSlashesMean) {
  EXPECT_EQ(print_value("(a -b)"), 3);
  EXPECT_EQ(print_value("(a - b)"), 3);
  EXPECT_EQ(print_value("(2-a)"), -4);
  EXPECT_EQ(print_value("(a+b)"), 9);
  EXPECT_EQ(print_value("(a*b)"), 18);
  EXPECT_EQ(print_value("(a/2)"), 3);
  EXPECT_EQ(print_value("(a / b)"), 2);
  EXPECT_EQ(print_value("(1/ cos(0))"), 1);
  for (const char* text : {"(a-b)", "(time-1)", "(a/b)", "(2/a)", "(1/cos(0))"}) {
    EXPECT_FALSE(parse_text(std::string("define a 6 define b 3 print ") + text).ok) << text;
  }
  EXPECT_THAT(all_messages(parse_text("define a 6 print (a-b)")), HasSubstr("write blanks: 'a - b'"));
  EXPECT_THAT(all_messages(parse_text("define a 6 print (2/a)")), HasSubstr("write blanks around it"));
}

TEST(Numbers, HaveAllFormsOfTheLanguage) {
  const std::pair<const char*, double> forms[] = {
      {"12", 12},  {"12.", 12},   {"1.e2", 100}, {"1.5", 1.5}, {"1.5e-1", 0.15},
      {".5", 0.5}, {".5E+1", 5},  {"1e2", 100},  {"- 5", -5},  {"+ 5", 5},
      {"+5", 5},   {"-.5", -0.5}, {"1e-999", 0}, {"0e999", 0}, {"1e-400", 0}};
  for (const auto& [text, value] : forms) EXPECT_DOUBLE_EQ(print_value(text), value) << text;
  EXPECT_EQ(parse_text("lookp 4.9406564584124654e-324 1.7976931348623157e308 0.1").scene.settings.look,
            (Vec3{4.9406564584124654e-324, 1.7976931348623157e308, 0.1}));
}

TEST(Numbers, BreakOffWhereTheFormEnds) {
  // 1e is a number and a name, 3abc too.
  EXPECT_TRUE(parse_text("surface e name abc sphere 1 0 0 1 object e abc").ok);
  const ParseResult result = parse_text("name e sphere 1 0 0 1e");
  EXPECT_THAT(all_messages(result), HasSubstr("1:22: error: unexpected 'e'"));
  EXPECT_FALSE(parse_text("sphere 0x10 0 0 0").ok);
}

TEST(Numbers, ThatOverflowAreErrorsInTheirPlace) {
  for (const char* text : {"1e999", "1e99999999999999999999", "123456789e400", ".001e400"}) {
    const ParseResult result = parse_text(std::string("sphere 1\n 0 0 ") + text);
    EXPECT_THAT(test::brief(result), testing::ElementsAre("2:6 error this number is too large")) << text;
  }
  EXPECT_FALSE(parse_text("sphere 1 0 0 " + std::string(400, '9')).ok);
}

std::string output_name(const std::string& text) {
  return parse_text("outfile " + text).scene.settings.output.value_or("(none)");
}

TEST(FileNames, AreUnquotedPathsOfNames) {
  for (const char* name :
       {"x.rle", "./x", "../t/x.rle", "a/../b", "/usr/lib/y", "//h/y", "sphere.bmp", "./scale", "x"}) {
    EXPECT_TRUE(parse_text(std::string("outfile ") + name).ok) << name;
    EXPECT_EQ(output_name(name), name);
  }
  for (const char* name : {"3d.rle", "./3d.rle", "a/1b", ".x", "~/x", "..", "a//b", "a+b", "scale"}) {
    EXPECT_FALSE(parse_text(std::string("outfile ") + name).ok) << name;
  }
  EXPECT_EQ(output_name("\"3d picture.png\""), "3d picture.png");
  EXPECT_FALSE(parse_text("outfile \"open\nsphere 1 0 0 0").ok);
}

TEST(Comments, SpanLinesAndTouchWords) {
  const ParseResult result = parse_text("sphere/**/1/* a\n*b**\n*/0 0/***/0/*/*/\nshpere");
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].location.line, 4u);
  EXPECT_EQ(parse_text("sphere/**/1/* a\n*b**\n*/0 0/***/0/*/*/").scene.spheres.size(), 1u);
}

TEST(Comments, ThatAreNeverClosedAreReportedWhereTheyBegin) {
  EXPECT_THAT(test::brief(parse_text("sphere 1 0 0 0\n  /* open\n sphere\n")),
              testing::ElementsAre("2:3 error this comment is never closed"));
  EXPECT_THAT(test::brief(parse_text("#define A\nsphere 1 0 0 0\n  /* open\n sphere\n")),
              testing::ElementsAre("3:3 error this comment is never closed"));
}

TEST(Comments, DoNotStartWithTwoSlashes) {
  EXPECT_FALSE(parse_text("// sphere 1 0 0 0\n").ok);
  EXPECT_EQ(output_name("//host/file"), "//host/file");
}

TEST(WhiteSpace, IncludesCarriageReturnFormFeedAndVerticalTab) {
  const ParseResult result = parse_text("sphere\r\n1\f0\v0\t0\r\n\r\n");
  EXPECT_TRUE(result.ok) << all_messages(result);
  EXPECT_EQ(result.scene.spheres.size(), 1u);
}

TEST(OtherCharacters, AreErrorsWithAPlace) {
  for (const std::string text : {"@", "~", ";", ":", "=", "&", "\x80", "\x01", " #", "{"}) {
    const ParseResult result =
        parse_text("sphere 1 0 0 0\n " + text, {Preprocessing::kNever, {}, false, 20, false});
    EXPECT_FALSE(result.ok) << text;
    ASSERT_FALSE(result.diagnostics.empty()) << text;
    EXPECT_EQ(result.diagnostics[0].location.line, 2u) << text;
  }
  EXPECT_THAT(all_messages(parse_text(std::string("sphere 1 0 0\0 0", 15))),
              HasSubstr("1:13: error: unexpected byte 0x00"));
}

TEST(LineMarkers, SetNameAndNumberOfTheNextLine) {
  const ParseOptions never{Preprocessing::kNever, {}, false, 20, false};
  const auto place = [&](const std::string& text) {
    const ParseResult result = parse_text(text, never);
    return result.diagnostics.empty() ? std::string("none")
                                      : result.scene.describe(result.diagnostics.front().location);
  };
  EXPECT_EQ(place("# 7 \"a.ray\" 1 3\nbad"), "a.ray:7:1");
  EXPECT_EQ(place("#line 7 \"a.ray\"\n\n bad"), "a.ray:8:2");
  EXPECT_EQ(place("#7\nbad"), "scene.ray:7:1");
  EXPECT_EQ(place("# 7 \"\"\nbad"), "stdin:7:1");
  EXPECT_EQ(place("# 7 \"a\"\n# 9\nbad"), "a:9:1");
  EXPECT_EQ(place("sphere 1 0 0 0\n# 7"), "none");
  EXPECT_EQ(place("#pragma x\n"), "scene.ray:1:1");
  EXPECT_EQ(place("#if 0\n"), "scene.ray:1:1");
}

TEST(Preprocessing, IsNeededOnlyForDirectives) {
  EXPECT_FALSE(lang::has_directive(""));
  EXPECT_FALSE(lang::has_directive("sphere 1 0 0 0\n# 1 \"x\"\n"));
  EXPECT_FALSE(lang::has_directive("a # b\n#line 4\n"));
  EXPECT_TRUE(lang::has_directive("#define A\n"));
  EXPECT_TRUE(lang::has_directive("# 1\n\n  # if 1"));
  EXPECT_TRUE(lang::has_directive("x # y\n#include \"x\""));
  EXPECT_FALSE(parse_text("#define A 1\nsphere A 0 0 0", {Preprocessing::kNever, {}, false, 20, false}).ok);
  EXPECT_TRUE(parse_text("sphere A 0 0 0", {Preprocessing::kAlways, {"-DA=1"}, false, 20, false}).ok);
}

}  // namespace
}  // namespace rayshade
