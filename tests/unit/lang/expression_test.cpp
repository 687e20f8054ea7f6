// SPDX-License-Identifier: MIT
// Numbers and expressions where the scene allows them (language.md 3.1, 3.2).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "parse_text.h"

namespace rayshade {
namespace {

using test::all_messages;
using test::parse_text;
using testing::HasSubstr;

std::string printed(const std::string& expression) {
  const ParseResult result = parse_text("print (" + expression + ")");
  return result.ok && result.prints.size() == 1 ? result.prints[0] : all_messages(result);
}

TEST(Expressions, HaveTheValuesOfTheLanguage) {
  const std::pair<const char*, const char*> table[] = {
      {"-2^2", "-4.000000\n"},   {"2^3^2", "512.000000\n"},   {"2^-1", "0.500000\n"},
      {"2^-1+1", "1.500000\n"},  {"2^-2^2", "0.062500\n"},    {"-2*3", "-6.000000\n"},
      {"2*-3", "-6.000000\n"},   {"--3", "3.000000\n"},       {"2-3-4", "-5.000000\n"},
      {"8/4/2", "1.000000\n"},   {"2*3%4", "2.000000\n"},     {"-2%3", "-2.000000\n"},
      {"-7%3", "-1.000000\n"},   {"7%-3", "1.000000\n"},      {"7.9%3.9", "1.000000\n"},
      {"5/0", "inf\n"},          {"pi", "3.141592\n"},        {"dtor", "0.017453\n"},
      {"rtod", "57.295780\n"},   {"sqrt(16)", "4.000000\n"},  {"hypot(3,4)", "5.000000\n"},
      {"cos(0)", "1.000000\n"},  {"asin(1)", "1.570796\n"},   {"acos(1)", "0.000000\n"},
      {"atan(0)", "0.000000\n"}, {"sin(0)", "0.000000\n"},    {"tan(0)", "0.000000\n"},
      {"+3 - +2", "1.000000\n"}, {"((2))*(3)", "6.000000\n"}, {"1/(5/0)", "0.000000\n"}};
  for (const auto& [text, value] : table) EXPECT_EQ(printed(text), value) << text;
  EXPECT_THAT(printed("sqrt(-1)"), HasSubstr("nan"));
}

TEST(Expressions, OfUnknownOrMisusedSymbolsAreErrors) {
  const std::pair<const char*, const char*> table[] = {{"foo", "there is no symbol 'foo'"},
                                                       {"sine(0)", "did you mean 'sin'?"},
                                                       {"sin", "is a function"},
                                                       {"pi(1)", "is not a function"},
                                                       {"sin()", "unexpected ')'"},
                                                       {"sin(1,2)", "takes 1 argument, not 2"},
                                                       {"hypot(1)", "takes 2 arguments, not 1"},
                                                       {"linear(1,2,3)", "takes 4 arguments, not 3"},
                                                       {"linear(1,2,3,4,5,6)", "not 6"},
                                                       {"exp(1)", "there is no symbol 'exp'"},
                                                       {"5%0", "division by zero"},
                                                       {"5%.5", "division by zero"},
                                                       {"1e300%3", "does not fit an integer"},
                                                       {"3%(0/0)", "does not fit an integer"},
                                                       {"rotd", "did you mean 'rtod'?"}};
  for (const auto& [text, message] : table) EXPECT_THAT(printed(text), HasSubstr(message)) << text;
}

TEST(Expressions, NeedParentheses) {
  for (const char* text : {"pi", "-pi", "-(5)", "sqrt(4)", "2+3"}) {
    EXPECT_FALSE(parse_text(std::string("print ") + text).ok) << text;
  }
  EXPECT_THAT(all_messages(parse_text("lookp pi 0 0")), HasSubstr("a symbol needs parentheses here: (pi)"));
}

TEST(Expressions, VaryOnlyInTransformsAndDefinitions) {
  EXPECT_TRUE(parse_text("define t (2*time) define u (t+1) sphere 1 0 0 0 scale (u) 1 1 rotate 0 0 (t) (u)"
                         " transform 1 0 (frame) 0 1 0 0 0 1 texture wood translate (time) 0 0")
                  .ok);
  for (const char* text :
       {"sphere (time) 0 0 0", "sphere (0*time) 0 0 0", "fov (frame)", "sample (1+time)", "print (time)",
        "surface a diffuse (linear(0,1,2,3)) 0 0", "light (time) point 0 0 0",
        "sphere 1 0 0 0 texture bump (time)", "define t (time) shutter (t)"}) {
    EXPECT_THAT(all_messages(parse_text(text)), HasSubstr("must not vary with time")) << text;
  }
}

TEST(Expressions, ThatVaryKeepTheirMeaning) {
  const ParseResult result =
      parse_text("define t (2*time+frame) sphere 1 0 0 0 translate (t^2) (linear(0,0,1,2)) (-t%3)");
  ASSERT_TRUE(result.ok) << all_messages(result);
  const Scene& scene = result.scene;
  ASSERT_EQ(scene.transforms.size(), 1u);
  const Vec3 moved = scene.transforms[0].at({0.5, 3}).translation;
  EXPECT_DOUBLE_EQ(moved.x, 16);
  EXPECT_DOUBLE_EQ(moved.y, 1);
  EXPECT_DOUBLE_EQ(moved.z, -1);
}

TEST(Expressions, MustBeFiniteWhereTheyAreUsed) {
  for (const char* text :
       {"sphere (1/0) 0 0 0", "lookp 0 (sqrt(-1)) 0", "sphere 1 0 0 0 scale (1/0) 1 1",
        "sphere 1 0 0 0 translate (time) (0/0) 0", "frames (1/0)", "light (1e200*1e200) point 0 0 0"}) {
    EXPECT_THAT(all_messages(parse_text(text)), HasSubstr("not a finite number")) << text;
  }
  EXPECT_TRUE(parse_text("define big (1/0) print (1/ big)").ok);
}

TEST(Integers, AreTruncatedTowardZeroAndChecked) {
  EXPECT_EQ(parse_text("maxdepth 2.9").scene.settings.max_depth, 2);
  EXPECT_EQ(parse_text("screen (2*50.6) 7.99").scene.settings.screen, (std::array<int, 2>{101, 7}));
  for (const char* text : {"maxdepth 1e10", "frames -3e9", "screen 1e300 1", "report 2147483648"}) {
    EXPECT_THAT(all_messages(parse_text(text)), HasSubstr("too large for an integer")) << text;
  }
}

TEST(Symbols, CannotBeDefinedAgain) {
  EXPECT_THAT(
      test::brief(parse_text("define a 1\ndefine a 2\n")),
      testing::ElementsAre("2:8 error symbol 'a' is already defined", "1:8 note it was defined here"));
  for (const char* name : {"pi", "time", "sin", "linear", "frame"}) {
    EXPECT_THAT(all_messages(parse_text(std::string("define ") + name + " 1")),
                HasSubstr("is a predefined symbol"));
  }
  EXPECT_FALSE(parse_text("list define a 1 sphere 1 0 0 0 end").ok);
  // Three separate name spaces.
  EXPECT_TRUE(parse_text("define a 1 surface a name a sphere a (a) 0 0 0 object a a").ok);
}

TEST(Limits, OfExpressionsAreErrorsNotCrashes) {
  const auto repeat = [](const std::string& text, int n) {
    std::string out;
    for (int i = 0; i < n; ++i) out += text;
    return out;
  };
  EXPECT_TRUE(parse_text("print " + repeat("(", 9000) + "1" + repeat(")", 9000)).ok);
  EXPECT_THAT(all_messages(parse_text("print " + repeat("(", 100000) + "1" + repeat(")", 100000))),
              HasSubstr("parentheses are open"));
  EXPECT_THAT(all_messages(parse_text("print (" + repeat("-", 1100000) + "1)")),
              HasSubstr("nested too deeply"));
  EXPECT_TRUE(parse_text("print (" + repeat("1+", 200000) + "1)").ok);
  EXPECT_THAT(all_messages(parse_text("define a (" + repeat("time+", 100000) + "1)")),
              HasSubstr("too large"));
  EXPECT_TRUE(parse_text("define a (" + repeat("time+", 1900) + "1)").ok);
  std::string doubling = "define a0 (time)\n";
  for (int i = 0; i < 60; ++i) {
    const std::string last = "a" + std::to_string(i);
    doubling += "define a" + std::to_string(i + 1) + " (" + last + "+" + last + ")\n";
  }
  EXPECT_THAT(all_messages(parse_text(doubling)), HasSubstr("too large"));
}

TEST(Print, WritesNothingOnceThereIsAnError) {
  for (const char* text : {"print (nosuch)", "print (5%0)", "print (sin(1,2))", "print (5%0) print 2",
                           "print (5%0) print (-time)"}) {
    const ParseResult result = parse_text(text);
    EXPECT_FALSE(result.ok) << text;
    EXPECT_TRUE(result.prints.empty()) << text;
  }
}

}  // namespace
}  // namespace rayshade
