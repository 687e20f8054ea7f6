// SPDX-License-Identifier: MIT
#include "rayshade/cli/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "rayshade/cli/json.h"
#include "rayshade/cli/pictures.h"
#include "rayshade/cli/progress.h"

namespace rayshade {
namespace {

using ::testing::HasSubstr;

Options parse(std::vector<std::string> arguments) { return parse_options(arguments); }

TEST(OptionTableTest, LettersAndNamesAreUniqueAndEveryLetterOfTheOriginalIsThere) {
  std::set<char> letters;
  std::set<std::string> names;
  for (const OptionSpec& spec : option_table()) {
    EXPECT_TRUE(!spec.letter || letters.insert(spec.letter).second) << spec.letter;
    EXPECT_TRUE(names.insert(spec.name).second) << spec.name;
    EXPECT_NE(std::string(spec.help), "");
  }
  for (const char letter : std::string("AaCcDEeFfGghjlmNnOoPpqRrSsTuVvWX"))
    EXPECT_TRUE(letters.contains(letter)) << letter;
}

TEST(OptionTableTest, HelpManualAndCompletionNameEveryOption) {
  const std::string help = help_text(), manual = man_options(), completion = bash_completion();
  for (const OptionSpec& spec : option_table()) {
    EXPECT_THAT(help, HasSubstr(std::string("--") + spec.name));
    EXPECT_THAT(completion, HasSubstr(std::string("--") + spec.name));
    std::string escaped;
    for (const char c : std::string(spec.name)) escaped += c == '-' ? std::string("\\-") : std::string(1, c);
    EXPECT_THAT(manual, HasSubstr("\\fB\\-\\-" + escaped + "\\fR"));
  }
}

TEST(ParseOptionsTest, ValuesFollowAsWordsAndMayBeNegative) {
  const Options o = parse({"-X", "-.5", ".5", "-1", "2", "scene.ray", "-R", "640", "480", "--seed=7"});
  EXPECT_EQ(o.settings.crop, (std::array<double, 4>{-.5, .5, -1, 2}));
  EXPECT_EQ(o.settings.screen, (std::array<int, 2>{640, 480}));
  EXPECT_EQ(o.settings.seed, 7u);
  EXPECT_EQ(o.input, "scene.ray");
}

TEST(ParseOptionsTest, MisuseIsAUsageError) {
  for (const std::vector<std::string>& bad : std::vector<std::vector<std::string>>{{"-S3"},
                                                                                   {"-Z"},
                                                                                   {"-"},
                                                                                   {"-R", "640"},
                                                                                   {"a.ray", "b.ray"},
                                                                                   {"-S", "three"},
                                                                                   {"-S", "65"},
                                                                                   {"--threads=-1"},
                                                                                   {"-V", "-x"},
                                                                                   {"--no-such"},
                                                                                   {"--seed=-1"},
                                                                                   {"--sampling", "halton"},
                                                                                   {"--tolerance", "x"},
                                                                                   {"--intersector", "magic"},
                                                                                   {"-G", "1x"},
                                                                                   {"--memory", "5Q"},
                                                                                   {"-S", "99999999999"}}) {
    EXPECT_THROW(parse(bad), UsageError) << bad[0];
  }
}

TEST(ParseOptionsTest, DashesEndTheOptions) { EXPECT_EQ(parse({"--", "-odd.ray"}).input, "-odd.ray"); }

TEST(ParseOptionsTest, TogglesToggle) {
  EXPECT_EQ(parse({"-j"}).settings.jitter, false);
  EXPECT_EQ(parse({"-j", "-j"}).settings.jitter, true);
  EXPECT_EQ(parse({}).settings.jitter, std::nullopt);
  EXPECT_TRUE(parse({"-n"}).settings.no_shadows);
  EXPECT_FALSE(parse({"-n", "-n"}).settings.no_shadows);
  EXPECT_EQ(parse({"-g"}).settings.filter, FilterKind::kGauss);
  EXPECT_EQ(parse({"-u"}).preprocess, Preprocess::kNever);
  EXPECT_EQ(parse({"-u", "-u"}).preprocess, Preprocess::kAuto);
  EXPECT_TRUE(parse({"-o"}).settings.toggle_transparent_shadows);
}

TEST(ParseOptionsTest, PreviewSetsFourThingsThatLaterOptionsMayChange) {
  const Options o = parse({"-p", "-S", "3"});
  EXPECT_TRUE(o.settings.no_shadows);
  EXPECT_EQ(o.settings.max_depth, 0);
  EXPECT_EQ(o.settings.samples, 3);
  EXPECT_EQ(o.settings.jitter, true);
}

TEST(ParseOptionsTest, SamplesBelowOneBecomeOne) { EXPECT_EQ(parse({"-S", "-4"}).settings.samples, 1); }

TEST(ParseOptionsTest, HelpEndsTheReading) {
  EXPECT_EQ(parse({"--help", "--nonsense"}).action, Action::kHelp);
}

TEST(ParseBytesTest, TakesSuffixes) {
  EXPECT_EQ(parse_bytes("512", "--memory"), 512u);
  EXPECT_EQ(parse_bytes("2K", "--memory"), 2048u);
  EXPECT_EQ(parse_bytes("1.5G", "--memory"), std::uint64_t{3} << 29);
}

TEST(ParseShareTest, TakesFractionsAndPercentages) {
  EXPECT_EQ(parse({}).verify, 0);
  EXPECT_EQ(parse({"--verify", ".25"}).verify, .25);
  EXPECT_EQ(parse({"--verify=5%"}).verify, .05);
  EXPECT_EQ(parse({"--verify", "100%"}).verify, 1);
  EXPECT_THROW(parse({"--verify", "2"}), UsageError);
}

TEST(JsonTest, IsReadBackByAnotherReader) {
  JsonWriter j;
  j.begin_object()
      .value("text", "a \"quoted\" \\ line\n")
      .value("number", 0.1)
      .value("count", std::uint64_t{1} << 63);
  j.value("nothing", std::nan("")).begin_array("list").value("", 1).value("", 2).end_array();
  j.begin_object("inner").end_object().value("yes", true).end_object();
  const auto read = nlohmann::json::parse(j.text());
  EXPECT_EQ(read["text"], "a \"quoted\" \\ line\n");
  EXPECT_EQ(read["number"], 0.1);
  EXPECT_EQ(read["count"], std::uint64_t{1} << 63);
  EXPECT_TRUE(read["nothing"].is_null());
  EXPECT_EQ(read["list"].size(), 2u);
  EXPECT_EQ(read["yes"], true);
}

TEST(DurationTest, ReadsWell) {
  EXPECT_EQ(duration_text(4.25), "4.2 s");
  EXPECT_EQ(duration_text(61), "1:01");
  EXPECT_EQ(duration_text(3723), "1:02:03");
}

TEST(WithInfixTest, KeepsTheSuffix) {
  EXPECT_EQ(with_infix("a/b.pfm", "depth"), "a/b.depth.pfm");
  EXPECT_EQ(with_infix("a.d/b", "depth"), "a.d/b.depth");
}

TEST(PictureOutputTest, RefusesWhatCannotBe) {
  RenderSettings settings;
  settings.frames = 3;
  EXPECT_THROW(PictureOutput(parse({}), settings, "a.png"), UsageError);
  EXPECT_NO_THROW(PictureOutput(parse({}), settings, "a.%03d.png"));
  EXPECT_NO_THROW(PictureOutput(parse({}), settings, "a.ppm"));
  EXPECT_THROW(PictureOutput(parse({"-e"}), settings, "a.ppm"), UsageError);
  EXPECT_THROW(PictureOutput(parse({"--format", "gif"}), settings, "a"), FormatError);
  settings.frames = 1;
  EXPECT_EQ(PictureOutput(parse({"-e"}), settings, "-").format(), FileFormat::kRleExponential);
  EXPECT_EQ(PictureOutput(parse({}), settings, "-").format(), FileFormat::kPng8);
}

}  // namespace
}  // namespace rayshade
