// SPDX-License-Identifier: MIT
// The built-in preprocessor: expansion, conditions, inclusion, and that places survive it (language.md 2).
#include "rayshade/lang/preprocessor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "parse_text.h"
#include "rayshade/lang/condition.h"

namespace rayshade {
namespace {

using test::all_messages;
using test::parse_text;
using testing::ElementsAre;
using testing::HasSubstr;

/// The output for a text, without blanks at its ends.
std::string preprocess(const std::string& text, const std::vector<std::string>& arguments = {},
                       const std::map<std::string, std::string>& files = {}) {
  std::vector<std::string> names;
  lang::SourceMap sources(names);
  lang::Messages messages(sources, 20);
  MemoryProvider provider;
  for (const auto& [name, content] : files) provider.add(name, content);
  lang::Preprocessor preprocessor(provider, sources, messages);
  preprocessor.set_arguments(arguments);
  sources.add_source("dir/main");
  sources.set_text(0, text);
  const std::string out(lang::trim(preprocessor.run("dir/main")));
  std::string errors;
  for (const Diagnostic& d : messages.take()) errors += d.text + "\n";
  return errors.empty() ? out : errors + "|" + out;
}

TEST(Macros, AreReplacedInsideWordsAndPaths) {
  EXPECT_EQ(preprocess("#define IMAGES /img/lib\nIMAGES/a.rle"), "/img/lib/a.rle");
  EXPECT_EQ(preprocess("#define A x\nA-b a-A AA A_ A.A (A)"), "x-b a-x AA A_ x.x (x)");
  EXPECT_EQ(preprocess("#define D dir\n./D/f D/D"), "./dir/f dir/dir");
  EXPECT_EQ(preprocess("#define N 1\n2N N2 1e5 1eN"), "2N N2 1e5 1eN");
  EXPECT_EQ(preprocess("#define e 9\n1e5 1.e e"), "1e5 1.e 9");
  EXPECT_EQ(preprocess("#define A x\n\"A\" 'A' A's"), "\"x\" 'x' x's");
}

TEST(Macros, DoNotFuseIntoNumbers) {
  EXPECT_EQ(preprocess("#define N 5\nN.5 .N N(3) -N N-N xN N.x"), "5 .5 . 5 5(3) -5 5-5 xN 5 .x");
  EXPECT_EQ(preprocess("#define F(x) x\nF(1)F(2) F(1)F(a) F(a)F(1) F(1)F(e5)"), "1 2 1a a1 1 e5");
  EXPECT_EQ(preprocess("#define V pic\n#define N 2\nV.N img-N.png"), "pic.2 img-2.png");
}

TEST(Macros, TakeArguments) {
  EXPECT_EQ(preprocess("#define REP(x) scale x x x /* thrice */\nREP(2) REP ( (1, 2) ) REP\n(3\n)"),
            "scale 2 2 2 scale (1, 2) (1, 2) (1, 2) scale 3 3 3");
  EXPECT_EQ(preprocess("#define P(x,y) y x\nP(1,2) P( a b , c ) P(,) P"), "2 1 c a b   P");
  EXPECT_EQ(preprocess("#define Z() zero\nZ() Z( ) Z"), "zero zero Z");
  EXPECT_EQ(preprocess("#define G(x) a##x b ## x #x\nG(1)"), "a1 b1 \"1\"");
  EXPECT_EQ(preprocess("#define V(x, ...) x [__VA_ARGS__]\nV(1,2,3) V(1)"), "1 [2,3] 1 []");
  EXPECT_EQ(preprocess("#define OBJ (x) y\nOBJ"), "(x) y");
  EXPECT_EQ(preprocess("#define F(x) <x>\n#define G F\nG(1) G (2)"), "<1> <2>");
  EXPECT_EQ(preprocess("#define F(x) x x\nF(F(1)) F(/* c */ 2 /* , */)"), "1 1 1 1 2 2");
}

TEST(Macros, DoNotExpandInsideThemselves) {
  EXPECT_EQ(preprocess("#define A A+1\n#define ID(x) x\nA ID(A) ID(ID(A))"), "A+1 A+1 A+1");
  EXPECT_EQ(preprocess("#define A B\n#define B A\nA B"), "A B");
  EXPECT_EQ(preprocess("#define F(x) x F(x)\nF(1)"), "1 F(1)");
}

TEST(Macros, CanBeUndefinedAndRedefined) {
  EXPECT_EQ(preprocess("#define A 1\nA\n#undef A\nA\n#define A 2\nA\n#define A 2\n"), "1\nA\n2");
  EXPECT_THAT(preprocess("#define A 1\n#define A 2\nA"), HasSubstr("defined again, differently"));
  EXPECT_EQ(preprocess("#define A one \\\n  two /* x\n y */ three\nA"), "one two three");
}

TEST(Macros, WithMistakesAreReported) {
  for (const char* text :
       {"#define", "#define 1", "#define F(", "#define F(x,x) x", "#define F(1) x", "#define F(x) ##x",
        "#define F(x) #y", "#define F(x) x\nF(1,2)", "#define F(x) x\nF(1", "#define defined 1", "#undef",
        "#frob", "#define F(x,) x", "# !"}) {
    EXPECT_THAT(preprocess(text), HasSubstr("\n|")) << text;
  }
  EXPECT_THAT(preprocess("#defin A 1"), HasSubstr("unknown directive '#defin'"));
  EXPECT_THAT(preprocess("#error no way"), HasSubstr("#error no way"));
}

TEST(Macros, OfLineAndFile) {
  EXPECT_EQ(preprocess("__LINE__\n__LINE__ __FILE__\n#line 70 \"x\"\n__LINE__ __FILE__"),
            "1\n2 \"dir/main\"\n70 \"x\"");
  EXPECT_EQ(preprocess("unix linux __unix__ __STDC__"), "unix linux __unix__ __STDC__");
}

TEST(Text, StaysAsItIs) {
  EXPECT_EQ(preprocess("a / b\n\"c'd\nit's\n"), "a / b\n\"c'd\nit's");
  EXPECT_EQ(preprocess("a/*x*/b/* \n # if 0 \n */c"), "a b c");
  EXPECT_EQ(preprocess("ab\\\ncd e \\\r\nf"), "abcd e f");
  EXPECT_EQ(preprocess("  # define A 1\nA\n#\n# /* nothing */\nb"), "1\nb");
}

TEST(Text, CommentsReachToTheEndOfTheLine) {
  EXPECT_EQ(preprocess("a // b /* \nc// d\n//\ne"), "a \nc\n\ne");
  EXPECT_EQ(preprocess("#define A 1 // one\nA A// it's \"A\nA"), "1 1\n1");
  EXPECT_EQ(preprocess("#define F(a, b) b a\nF(1, // one, )\n2)"), "2 1");
  EXPECT_EQ(preprocess("#if 0\n// /*\n#else\nb\n#endif"), "b");
  EXPECT_EQ(preprocess("image \"http://a//b\" c\n"), "image \"http://a//b\" c");
  EXPECT_EQ(preprocess("#define A \"x//y\"\nA"), "\"x//y\"");
  EXPECT_EQ(preprocess("#define F(a) a\nF(\"x//y\")"), "\"x//y\"");
}

TEST(Conditions, ChooseBranches) {
  EXPECT_EQ(preprocess("#if 1\na\n#elif 1\nb\n#else\nc\n#endif"), "a");
  EXPECT_EQ(preprocess("#if 0\na\n#elif 1\nb\n#elif 1\nx\n#else\nc\n#endif"), "b");
  EXPECT_EQ(preprocess("#if 0\na\n#elif 0\nb\n#else\nc\n#endif d"), "c");
  EXPECT_EQ(preprocess("#define A\n#ifdef A\na\n#endif\n#ifndef A\nb\n#endif\n#ifdef B\nc\n#endif"), "a");
  EXPECT_EQ(preprocess("#if 0\n#if 1\na\n#else\nb\n#endif\n#include \"none\"\n#error x\n#frob\n/* "
                       "\n#endif\n*/ c\n#endif\nd"),
            "d");
  EXPECT_EQ(preprocess("#if 0\n#elif 1\n#define A 1\n#endif\nA"), "1");
  EXPECT_EQ(preprocess("#define T(x) (x > 2)\n#define N 3\n#if defined(N) && defined T && T(N) && !defined "
                       "M\nyes\n#endif"),
            "yes");
  for (const char* text : {"#if", "#if 1\n", "#endif", "#else", "#elif 1", "#if 1\n#else\n#else\n#endif",
                           "#if 1\n#else\n#elif 1\n#endif", "#ifdef\n#endif", "#if 1 +\n#endif",
                           "#if (1\n#endif", "#if 1/0\n#endif", "#if defined\n#endif", "#if 1 2\n#endif",
                           "#if 1.5\n#endif", "#if \"x\"\n#endif"}) {
    EXPECT_THAT(preprocess(text), HasSubstr("\n|")) << text;
  }
}

TEST(Conditions, HaveTheOperatorsOfC) {
  const std::pair<const char*, std::int64_t> table[] = {{"1 + 2 * 3", 7},
                                                        {"(1 + 2) * 3", 9},
                                                        {"7 / 2", 3},
                                                        {"-7 % 3", -1},
                                                        {"1 << 4 >> 2", 4},
                                                        {"5 & 3 | 8", 9},
                                                        {"6 ^ 3", 5},
                                                        {"~0", -1},
                                                        {"!0 + !5", 1},
                                                        {"1 < 2 == 1", 1},
                                                        {"3 >= 3 && 2 <= 1", 0},
                                                        {"0 || 2", 1},
                                                        {"1 ? 2 : 3", 2},
                                                        {"0 ? 2 : 1 ? 4 : 5", 4},
                                                        {"0x1F + 010 + 3UL", 42},
                                                        {"name + 1", 1},
                                                        {"0 && 1 / 0", 0},
                                                        {"1 || 1 / 0", 1},
                                                        {"1 ? 5 : 1 / 0", 5},
                                                        {"- - 3", 3},
                                                        {"10 - 4 - 3", 3},
                                                        {"1 != 2", 1},
                                                        {"-9223372036854775807 - 1", INT64_MIN},
                                                        {"(-9223372036854775807 - 1) / -1", INT64_MIN},
                                                        {"(-9223372036854775807 - 1) % -1", 0},
                                                        {"1 << 65", 2}};
  for (const auto& [text, value] : table) EXPECT_EQ(lang::evaluate_condition(text), value) << text;
}

TEST(Inclusion, LooksBesideTheFileAndInGivenDirectories) {
  const std::map<std::string, std::string> files = {{"dir/a", "#include \"sub/b\"\na"},
                                                    {"dir/sub/b", "#include \"c\"\nb"},
                                                    {"dir/sub/c", "c"},
                                                    {"lib/d", "d"},
                                                    {"/abs/e", "e"},
                                                    {"lib/a", "wrong"}};
  EXPECT_EQ(preprocess("#include \"a\"\nmain", {}, files), "c\nb\na\nmain");
  EXPECT_EQ(preprocess("#include <d>", {"-Ilib"}, files), "d");
  EXPECT_EQ(preprocess("#include \"d\"", {"-I", "none", "-I", "lib"}, files), "d");
  EXPECT_EQ(preprocess("#include \"/abs/e\"", {}, files), "e");
  EXPECT_EQ(preprocess("#define F \"a\"\n#include F", {}, files), "c\nb\na");
  EXPECT_THAT(preprocess("#include <a>", {}, files), HasSubstr("cannot read 'a'"));
  EXPECT_THAT(preprocess("#include \"zz\"", {}, files), HasSubstr("cannot read 'zz'"));
  EXPECT_THAT(preprocess("#include foo"), HasSubstr("needs \"file\""));
  EXPECT_THAT(preprocess("#include \"\""), HasSubstr("needs \"file\""));
}

TEST(Inclusion, OfAFileInItselfEnds) {
  const ParseResult self = parse_text("#include \"scene.ray\"\n");
  EXPECT_THAT(all_messages(self), HasSubstr("more than 200 levels deep"));
  const ParseResult twice = parse_text("#include \"scene.ray\"\n#include \"scene.ray\"\n");
  EXPECT_FALSE(twice.ok);
}

TEST(Arguments, DefineUndefineAndAddDirectories) {
  EXPECT_EQ(preprocess("A B C(1) D", {"-DA", "-D", "B=2", "-DC(x)=x x", "-DD=4", "-UD"}), "1 2 1 1 D");
  EXPECT_THAT(preprocess("", {"-Q"}), HasSubstr("unknown preprocessor argument '-Q'"));
  EXPECT_THAT(preprocess("", {"-D"}), HasSubstr("needs a value"));
  EXPECT_THAT(preprocess("", {"-D1"}), HasSubstr("-D 1"));
  EXPECT_THAT(split_arguments(" -DA=1  -I\"a b\" '-DX=\"y z\"' c\\ d '' "),
              ElementsAre("-DA=1", "-Ia b", "-DX=\"y z\"", "c d", ""));
  EXPECT_THAT(split_arguments(""), ElementsAre());
  EXPECT_THAT(split_arguments("'open end"), ElementsAre("open end"));
}

TEST(Bombs, AreDefused) {
  std::string text = "#define A0 x x\n";
  for (int i = 0; i < 60; ++i) {
    const std::string last = "A" + std::to_string(i);
    text += "#define A" + std::to_string(i + 1) + " " + last + " " + last + "\n";
  }
  EXPECT_THAT(preprocess(text + "A60").substr(0, 100), HasSubstr("macros expand to more than"));
  std::string calls = "#define F(x) x\n";
  for (int i = 0; i < 5000; ++i) calls += "F(";
  calls += "1" + std::string(5000, ')');
  EXPECT_THAT(preprocess(calls).substr(0, 100), HasSubstr("nested too deeply"));
  EXPECT_THAT(preprocess("#if " + std::string(100000, '(') + "1\n#endif").substr(0, 100),
              HasSubstr("nested too deeply"));
}

TEST(Places, SurviveInclusionAndExpansion) {
  const ParseResult result = parse_text(
      "/* two\nlines */\n#define BALL sphere rde\n#include \"inc/a.ray\"\n  BALL 1 0 0 0 sphere 1 0 0 oops\n"
      "sphere /* x */ 1 0 0 0 bad\n",
      {}, {{"inc/a.ray", "surface red\n\n sphere 1 0 0 wrong\n"}});
  EXPECT_EQ(all_messages(result),
            "included from scene.ray:4:\n"
            "inc/a.ray:3:15: error: unexpected 'wrong'; expected a number\n"
            "   sphere 1 0 0 wrong\n"
            "                ^~~~~\n"
            "scene.ray:5:3: error: there is no surface 'rde'\n"
            "    BALL 1 0 0 0 sphere 1 0 0 oops\n"
            "    ^~~~\n"
            "  did you mean 'red'?\n"
            "scene.ray:5:29: error: unexpected 'oops'; expected a number\n"
            "    BALL 1 0 0 0 sphere 1 0 0 oops\n"
            "                              ^~~~\n"
            "scene.ray:6:24: error: unexpected 'bad'; expected a new item, a transform or 'texture'\n"
            "  sphere /* x */ 1 0 0 0 bad\n"
            "                         ^~~\n");
}

TEST(Places, FollowLineDirectives) {
  const ParseResult result =
      parse_text("#line 100 \"gen.ray\"\nobject a\n#line 7\nobject b\n# 9 \"x\" 1\nobject c\n");
  std::vector<std::string> places;
  for (const Diagnostic& d : result.diagnostics)
    places.push_back(d.file + ":" + std::to_string(d.location.line));
  EXPECT_THAT(places, ElementsAre("gen.ray:100", "gen.ray:7", "x:9"));
}

}  // namespace
}  // namespace rayshade
