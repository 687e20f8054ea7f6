// SPDX-License-Identifier: MIT
// Viewing and rendering items, atmosphere and lights: what is stored, who wins, what is refused
// (language.md 3.4, 3.5, 3.10, 4, 9).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "parse_text.h"

namespace rayshade {
namespace {

using test::all_messages;
using test::parse_text;
using testing::HasSubstr;

SceneSettings settings(const std::string& text) {
  ParseResult result = parse_text(text);
  EXPECT_TRUE(result.ok) << text << "\n" << all_messages(result);
  return result.scene.settings;
}

TEST(Settings, AreUnsetByDefault) {
  const SceneSettings s = settings("sphere 1 0 0 0");
  EXPECT_FALSE(s.eye || s.look || s.up || s.horizontal_fov || s.vertical_fov || s.aperture ||
               s.focal_distance || s.eye_separation || s.screen || s.window || s.crop || s.samples ||
               s.jitter || s.filter || s.filter_width || s.contrast || s.cutoff || s.max_depth ||
               s.background || s.output || s.report_frequency || s.report_file || s.shutter || s.start_time ||
               s.frame_length || s.frames || s.ambient_light || s.atmosphere_index ||
               s.toggle_transparent_shadows || s.verbose || s.quiet);
  EXPECT_TRUE(s.effects.empty());
}

TEST(Settings, KeepTheLastValue) {
  const SceneSettings s = settings(
      "eyep 1 2 3 eyep 4 5 6 lookp 1 1 1 lookp 2 2 2 up 0 1 0 up 1 0 0 aperture 1 aperture 2 crop 0 1 0 1 "
      "crop .1 .2 .3 .4 sample 2 sample 4 filter box filter gauss contrast .1 .1 .1 contrast .4 .5 .6 cutoff "
      "1 cutoff .5 "
      "maxdepth 3 maxdepth 7 background 1 1 1 background .1 .2 .3 shutter 1 shutter 2 frames 2 frames 9 "
      "starttime 1 "
      "starttime 3 framelength 1 framelength 4 screen 10 10 resolution 20 30 report 5 report 6 light 1 "
      "ambient "
      "light .1 .2 .3 ambient");
  EXPECT_EQ(s.eye, (Vec3{4, 5, 6}));
  EXPECT_EQ(s.look, (Vec3{2, 2, 2}));
  EXPECT_EQ(s.up, (Vec3{1, 0, 0}));
  EXPECT_EQ(s.aperture, 2);
  EXPECT_EQ(s.crop, (std::array<double, 4>{.1, .2, .3, .4}));
  EXPECT_EQ(s.samples, 4);
  EXPECT_EQ(s.filter, FilterKind::kGauss);
  EXPECT_EQ(s.contrast, (Color{.4, .5, .6}));
  EXPECT_EQ(s.cutoff, (Color{.5, .5, .5}));
  EXPECT_EQ(s.max_depth, 7);
  EXPECT_EQ(s.background, (Color{.1, .2, .3}));
  EXPECT_EQ(s.shutter, 2);
  EXPECT_EQ(s.frames, 9);
  EXPECT_EQ(s.start_time, 3);
  EXPECT_EQ(s.frame_length, 4);
  EXPECT_EQ(s.screen, (std::array<int, 2>{20, 30}));
  EXPECT_EQ(s.report_frequency, 6);
  EXPECT_EQ(s.ambient_light, (Color{.1, .2, .3}));
}

TEST(Settings, KeepTheFirstWindowOutputAndReportFile) {
  const ParseResult result = parse_text(
      "window 1 2 3 4 window 5 6 7 8 outfile a outfile b\noutfile c report r1 report verbose quiet 3 r2");
  EXPECT_TRUE(result.ok);
  const SceneSettings& s = result.scene.settings;
  EXPECT_EQ(s.window, (std::array<int, 4>{1, 2, 3, 4}));
  EXPECT_EQ(s.output, "a");
  EXPECT_EQ(s.report_file, "r1");
  EXPECT_TRUE(s.verbose && s.quiet);
  EXPECT_EQ(test::count(result, Severity::kWarning), 2);
  EXPECT_THAT(all_messages(result), HasSubstr("2:9: warning: outfile 'c' is ignored"));
}

TEST(Settings, TreatMinusOneAsUnset) {
  EXPECT_EQ(settings("fov 30 -1").vertical_fov, std::nullopt);
  EXPECT_EQ(settings("focaldist 3 focaldist -1").focal_distance, std::nullopt);
  EXPECT_EQ(settings("eyesep 3 eyesep -1").eye_separation, std::nullopt);
  EXPECT_EQ(settings("screen -1 -1").screen, std::nullopt);
  EXPECT_EQ(settings("screen -1 99").screen, (std::array<int, 2>{512, 99}));
  EXPECT_EQ(settings("sample 2 sample -1").samples, std::nullopt);
  EXPECT_EQ(settings("filter box -1").filter_width, std::nullopt);
  EXPECT_EQ(settings("contrast -1 .5 .5").contrast, std::nullopt);
  EXPECT_EQ(settings("cutoff -1").cutoff, std::nullopt);
}

TEST(Settings, HaveTheSpecialRulesOfTheirKind) {
  EXPECT_EQ(settings("fov 40 30 fov 50").vertical_fov, std::nullopt);
  EXPECT_EQ(settings("fov 40 30").vertical_fov, 30);
  EXPECT_EQ(settings("filter gauss 3 filter box").filter_width, 3);
  EXPECT_EQ(settings("sample 2 nojitter sample 3").jitter, false);
  EXPECT_EQ(settings("sample 2 nojitter sample 3 jitter").jitter, true);
  EXPECT_EQ(settings("maxdepth -4").max_depth, 0);
  EXPECT_EQ(settings("report 0").report_frequency, 1);
  EXPECT_EQ(settings("report -7").report_frequency, 7);
  EXPECT_EQ(settings("frames -7").frames, 1);
  EXPECT_TRUE(settings("shadowtransp").toggle_transparent_shadows);
  EXPECT_FALSE(settings("shadowtransp shadowtransp").toggle_transparent_shadows);
  EXPECT_EQ(settings("sample 64").samples, 64);
}

TEST(Settings, RefuseBadSampleCountsAtTheStatement) {
  for (const char* text : {"sample 0", "sample -2", "sample 65", "sample .9"}) {
    EXPECT_THAT(test::brief(parse_text(std::string("\n ") + text))[0],
                testing::StartsWith("2:2 error 'sample' must be"));
  }
}

TEST(Settings, RefuseWrongNumbersOfValuesAndOrders) {
  for (const char* text :
       {"light 1 1 point 0 0 0", "light point 0 0 0", "report quiet verbose", "report file 5", "cutoff 1 2",
        "screen 1", "window 1 2 3", "fov", "contrast .2", "light 1 ambient noshadow", "fog 1 1 1 2 2 2",
        "light 1 spot 0 0 0 1 1 1 2 3", "outfile scale", "sample 2 jitter nojitter"}) {
    EXPECT_FALSE(parse_text(text).ok) << text;
  }
}

TEST(Settings, IgnoreTransformsOfTheEyeWithAdvice) {
  const ParseResult result = parse_text("eyep 1 2 3 translate 5 5 5 rotate 0 0 1 (time)\nsphere 1 0 0 0");
  EXPECT_TRUE(result.ok);
  EXPECT_EQ(result.scene.settings.eye, (Vec3{1, 2, 3}));
  EXPECT_EQ(test::count(result, Severity::kAdvice), 1);
  EXPECT_EQ(result.scene.transforms.size(), 0u);
}

TEST(Atmosphere, IsReplacedButKeepsItsIndex) {
  const SceneSettings s = settings(
      "atmosphere 1.5 fog 1 0 0 1 1 1 atmosphere mist 0 1 0 2 2 2 3 4 fogdeck 1 2 3 4 5 6 7.9 .1 .2 .3 8 8 "
      "8");
  EXPECT_EQ(s.atmosphere_index, 1.5);
  ASSERT_EQ(s.effects.size(), 2u);
  EXPECT_EQ(s.effects[0].kind, EffectKind::kMist);
  EXPECT_EQ(s.effects[0].zero, 3);
  EXPECT_EQ(s.effects[0].scale, 4);
  const AtmosphereEffect& deck = s.effects[1];
  EXPECT_EQ(deck.altitude, 1);
  EXPECT_EQ(deck.offset, 2);
  EXPECT_EQ(deck.noise_scale, (Vec3{3, 4, 5}));
  EXPECT_EQ(deck.chaos_scale, 6);
  EXPECT_EQ(deck.octaves, 7);
  EXPECT_EQ(deck.color, (Color{.1, .2, .3}));
  EXPECT_EQ(deck.thickness, (Color{8, 8, 8}));
  EXPECT_TRUE(settings("atmosphere fog 1 0 0 1 1 1 atmosphere").effects.empty());
  EXPECT_EQ(settings("atmosphere 0.5").atmosphere_index, 0.5);
  EXPECT_FALSE(parse_text("atmosphere 0").ok);
  EXPECT_FALSE(parse_text("atmosphere -1").ok);
}

std::vector<Light> lights(const std::string& text) {
  ParseResult result = parse_text(text);
  EXPECT_TRUE(result.ok) << text << "\n" << all_messages(result);
  return result.scene.lights;
}

TEST(Lights, HoldWhatWasWritten) {
  const std::vector<Light> l = lights(
      "light 1 ambient light 2 point 1 2 3 light .1 .2 .3 directional 1 0 0 noshadow light 1 extended .5 1 2 "
      "3 "
      "light 1 spot 1 2 3 4 5 6 7 light 1 spot 1 2 3 4 5 6 7 8 9 light 1 area 0 0 0 1 0 0 3 0 1 0 4");
  ASSERT_EQ(l.size(), 6u);
  EXPECT_EQ(l[0].kind, LightKind::kPoint);
  EXPECT_EQ(l[0].intensity, (Color{2, 2, 2}));
  EXPECT_EQ(l[0].position, (Vec3{1, 2, 3}));
  EXPECT_FALSE(l[0].no_shadow);
  EXPECT_EQ(l[1].kind, LightKind::kDirectional);
  EXPECT_EQ(l[1].intensity, (Color{.1, .2, .3}));
  EXPECT_TRUE(l[1].no_shadow);
  EXPECT_EQ(l[2].radius, .5);
  EXPECT_EQ(l[3].inner, 180);
  EXPECT_EQ(l[3].outer, 180);
  EXPECT_EQ(l[3].exponent, 7);
  EXPECT_EQ(l[4].target, (Vec3{4, 5, 6}));
  EXPECT_EQ(l[4].inner, 8);
  EXPECT_EQ(l[4].outer, 9);
  EXPECT_EQ(l[5].u_end, (Vec3{1, 0, 0}));
  EXPECT_EQ(l[5].u_samples, 3);
  EXPECT_EQ(l[5].v_end, (Vec3{0, 1, 0}));
  EXPECT_EQ(l[5].v_samples, 4);
  EXPECT_FALSE(l[5].no_shadow);
}

TEST(Lights, AreRefusedWhereTheyCannotShine) {
  for (const char* text :
       {"directional 0 0 0", "spot 1 2 3 1 2 3 1", "spot 0 0 0 1 0 0 1 20 10", "area 0 0 0 1 0 0 0 0 1 0 1",
        "area 0 0 0 0 0 0 1 0 1 0 1", "area 0 0 0 1 0 0 1 0 0 0 1", "area 0 0 0 1 0 0 100000 0 1 0 100000"}) {
    EXPECT_EQ(test::count(parse_text(std::string("light 1 ") + text), Severity::kError), 1) << text;
  }
  EXPECT_TRUE(parse_text("light 1 directional 0 0 1e-200 light 1 area 0 0 0 1e-8 0 0 1 0 1e-8 0 1").ok);
}

}  // namespace
}  // namespace rayshade
