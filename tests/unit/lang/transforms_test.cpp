// SPDX-License-Identifier: MIT
// Transforms and textures (language.md 3.8, 3.9; objects.md 1.4 to 1.7; textures.md 5).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "parse_text.h"

namespace rayshade {
namespace {

using test::all_messages;
using test::count;
using test::parse_text;
using testing::HasSubstr;

/// The point (1, 2, 3) moved by transforms written after a sphere.
Vec3 moved(const std::string& transforms, const Moment& moment = {}) {
  const ParseResult result = parse_text("sphere 1 0 0 0 " + transforms);
  EXPECT_TRUE(result.ok) << all_messages(result);
  return result.scene.transforms.at(0).at(moment).point({1, 2, 3});
}

void expect_near(const Vec3& a, const Vec3& b) {
  EXPECT_NEAR(a.x, b.x, 1e-12);
  EXPECT_NEAR(a.y, b.y, 1e-12);
  EXPECT_NEAR(a.z, b.z, 1e-12);
}

TEST(Transforms, ApplyInTheOrderWritten) {
  expect_near(moved("translate 1 1 1"), {2, 3, 4});
  expect_near(moved("scale 2 -3 4"), {2, -6, 12});
  expect_near(moved("rotate 0 0 9 90"), {-2, 1, 3});
  expect_near(moved("translate 1 0 0 rotate 0 0 1 90"), {-2, 2, 3});
  expect_near(moved("rotate 0 0 1 90 translate 1 0 0"), {-1, 1, 3});
  expect_near(moved("transform 1 2 3 4 5 6 7 8 10"), {30, 36, 45});
  expect_near(moved("transform 1 2 3 4 5 6 7 8 10 1 1 1"), {31, 37, 46});
}

TEST(Transforms, ThatVaryStaySeparate) {
  const ParseResult result =
      parse_text("sphere 1 0 0 0 scale 2 2 2 translate 1 0 0 rotate 0 0 1 (time) scale 3 3 3");
  ASSERT_TRUE(result.ok);
  const TransformList& list = result.scene.transforms[0];
  EXPECT_EQ(list.elements().size(), 3u);
  EXPECT_TRUE(list.animated());
  expect_near(moved("translate (time) 0 0 transform (frame) 0 0 0 1 0 0 0 1 0 0 (time)", {2, 5}), {15, 2, 5});
}

TEST(Transforms, ThatFlattenSpaceAreErrors) {
  for (const char* text :
       {"scale 0 1 1", "scale 1 1 0", "scale 9e-6 1 1", "scale 1 -9e-6 1", "scale (time) 0 1",
        "scale 1e-320 1 1", "transform 1 0 0 0 1 0 0 0 0", "transform 1 2 3 2 4 6 0 0 1",
        "transform 1e-200 0 0 0 1 0 0 0 1 transform 1e-200 0 0 0 1 0 0 0 1", "transform 0 0 0 0 0 0 0 0 0"}) {
    const ParseResult result = parse_text(std::string("sphere 1 0 0 0\n ") + text);
    EXPECT_EQ(count(result, Severity::kError), 1) << text;
    EXPECT_EQ(result.diagnostics[0].location.line, 2u) << text;
  }
  EXPECT_THAT(all_messages(parse_text("sphere 1 0 0 0 scale 1 0 1")), HasSubstr("factor y is 0"));
  // Small is not flat.
  for (const char* text : {"scale 1.1e-5 1.1e-5 1.1e-5", "scale 1e-5 1 1", "scale 1e-3 1 1 scale 1e-3 1 1",
                           "transform 1e-9 0 0 0 1e-9 0 0 0 1e-9", "transform 1e-30 0 0 0 1 0 0 0 1e30"}) {
    EXPECT_TRUE(parse_text(std::string("sphere 1 0 0 0 ") + text).ok) << text;
  }
}

TEST(Transforms, WithoutAnAxisAreLeftOut) {
  const ParseResult result = parse_text("sphere 1 0 0 0 rotate 0 0 0 90 sphere 2 0 0 0 rotate 0 0 0 (time)");
  EXPECT_TRUE(result.ok);
  EXPECT_EQ(count(result, Severity::kWarning), 2);
  EXPECT_EQ(result.scene.transforms.size(), 0u);
}

TEST(Transforms, HaveNineOrTwelveNumbersAndComeBeforeTextures) {
  for (const char* text :
       {"transform 1 0 0 0 1 0 0 0", "transform 1 0 0 0 1 0 0 0 1 5", "transform 1 0 0 0 1 0 0 0 1 5 5 5 5",
        "scale 1 1", "rotate 0 0 1", "texture wood texture"}) {
    EXPECT_FALSE(parse_text(std::string("sphere 1 0 0 0 ") + text).ok) << text;
  }
  const ParseResult result =
      parse_text("sphere 1 0 0 0 scale 2 2 2 texture wood translate 1 0 0 texture marble");
  ASSERT_TRUE(result.ok);
  const Scene& s = result.scene;
  EXPECT_EQ(s.transforms.size(), 1u);
  ASSERT_EQ(s.texture_lists[0].size(), 2u);
  EXPECT_FALSE(s.texture_lists[0][0].transform.empty());
  EXPECT_TRUE(s.texture_lists[0][1].transform.empty());
}

Texture texture(const std::string& text) {
  ParseResult result = parse_text("surface red diffuse 1 0 0 sphere 1 0 0 0 texture " + text);
  EXPECT_TRUE(result.ok) << text << "\n" << all_messages(result);
  return result.scene.texture_lists.empty() ? Texture() : result.scene.texture_lists[0].at(0);
}

TEST(Textures, HoldTheirArguments) {
  struct Case {
    const char* text;
    TextureKind kind;
    std::vector<double> arguments;
    int octaves;
    const char* file;
  };
  const Case cases[] = {{"checker red", TextureKind::kChecker, {}, 0, ""},
                        {"blotch .5 red", TextureKind::kBlotch, {.5}, 0, ""},
                        {"bump -2", TextureKind::kBump, {-2}, 0, ""},
                        {"marble", TextureKind::kMarble, {}, 0, ""},
                        {"marble map.x", TextureKind::kMarble, {}, 0, "map.x"},
                        {"fbm 1 2 3 4 5.9 6", TextureKind::kFbm, {1, 2, 3, 4, 6}, 5, ""},
                        {"fbm 1 2 3 4 5 6 dir/map", TextureKind::kFbm, {1, 2, 3, 4, 6}, 5, "dir/map"},
                        {"fbmbump 1 2 3 4 5", TextureKind::kFbmBump, {1, 2, 3, 4}, 5, ""},
                        {"wood", TextureKind::kWood, {}, 0, ""},
                        {"gloss .9", TextureKind::kGloss, {.9}, 0, ""},
                        {"cloud 1 2 3 4 5 6 7", TextureKind::kCloud, {1, 2, 3, 5, 6, 7}, 4, ""},
                        {"sky 1 2 3 4 5 6", TextureKind::kSky, {1, 2, 3, 5, 6}, 4, ""},
                        {"stripe red 1 2", TextureKind::kStripe, {1, 2}, 0, ""},
                        {"windy 1 2 3 4 5 6 7 8", TextureKind::kWindy, {1, 2, 3, 4, 6, 7, 8}, 5, ""},
                        {"mount map.x 1 2", TextureKind::kMount, {1, 2}, 0, "map.x"},
                        {"image ./a.png", TextureKind::kImage, {}, 0, "./a.png"},
                        {"windy 1 2 3 4 -5 6 7 8", TextureKind::kWindy, {1, 2, 3, 4, 6, 7, 8}, 0, ""}};
  for (const Case& c : cases) {
    const Texture t = texture(c.text);
    EXPECT_EQ(t.kind, c.kind) << c.text;
    for (std::size_t i = 0; i < c.arguments.size(); ++i)
      EXPECT_EQ(t.arguments[i], c.arguments[i]) << c.text << " " << i;
    EXPECT_EQ(t.octaves, c.octaves) << c.text;
    EXPECT_EQ(t.file.name, c.file) << c.text;
  }
  EXPECT_EQ(texture("checker red").surface.diffuse, (Color{1, 0, 0}));
  EXPECT_EQ(texture("checker cursurf").surface, default_surface());
}

TEST(Textures, OfImagesTakeOptionsInAnyOrder) {
  const Texture plain = texture("image a");
  EXPECT_EQ(plain.image.component, ImageComponent::kColor);
  EXPECT_EQ(plain.image.range_high, 1);
  EXPECT_EQ(plain.image.range_low, 0);
  EXPECT_FALSE(plain.image.smooth || plain.image.has_surface);
  EXPECT_EQ(plain.mapping.kind, MappingKind::kUv);
  const Texture t = texture(
      "image a smooth range 1 2 component bump component index tile 3 4 textsurf red specpow 3 map planar "
      "range 5 6 "
      "map cylindrical 1 2 3 0 0 1 0 1 0");
  EXPECT_EQ(t.image.component, ImageComponent::kIndex);
  EXPECT_EQ(t.image.tile_u, 3);
  EXPECT_EQ(t.image.tile_v, 4);
  EXPECT_EQ(t.image.range_high, 5);
  EXPECT_EQ(t.image.range_low, 6);
  EXPECT_TRUE(t.image.smooth && t.image.has_surface);
  EXPECT_EQ(t.surface.specular_exponent, 3);
  EXPECT_EQ(t.mapping.kind, MappingKind::kCylindrical);
  EXPECT_TRUE(t.mapping.explicit_axes);
  EXPECT_EQ(t.mapping.origin, (Vec3{1, 2, 3}));
  EXPECT_EQ(t.mapping.up, (Vec3{0, 0, 1}));
  EXPECT_EQ(t.mapping.u_axis, (Vec3{0, 1, 0}));
  for (const char* c :
       {"ambient", "diffuse", "specular", "body", "reflect", "transp", "specpow", "bump", "index"}) {
    texture(std::string("image a component ") + c);
  }
}

TEST(Textures, RefuseWhatCannotBeMapped) {
  for (const char* text :
       {"image a map spherical 0 0 0 0 0 1 0 0 2", "image a map cylindrical 0 0 0 0 0 0 1 0 0",
        "image a map planar 0 0 0 1 1 1 1 1 1", "stripe red 1 1 map spherical 0 0 0 1 0 0 0 0 0",
        "fbm 1 2 3 4 2000000000 6", "image \"\"", "checker", "stripe 1 2", "image a component tile",
        "image a component specpow map foo", "gloss", "cloud 1 2 3 4 5 6", "wood 1"}) {
    EXPECT_EQ(count(parse_text(std::string("surface red\nsphere 1 0 0 0 texture ") + text), Severity::kError),
              1)
        << text;
  }
  texture("image a map planar 0 0 0 0 1e-9 0 1e-9 0 0");
}

}  // namespace
}  // namespace rayshade
