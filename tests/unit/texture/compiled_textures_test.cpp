// SPDX-License-Identifier: MIT
// Textures are made ready once: files, constants, and what can be wrong with them.
#include "rayshade/texture/compiled_textures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/texture/textured_scene.h"

namespace rayshade {
namespace {

using test::TexturedScene;
using testing::HasSubstr;

const std::map<std::string, std::string> kFiles = {
    {"ok.map", "255 0 0\n0 255 0\n"},
    {"bad.map", "255 0 0\n0 blue 0\n"},
    {"grey.pgm", std::string("P5\n2 1\n255\n") + '\x40' + '\x80'},
    {"color.ppm", "P3\n1 1\n255\n10 20 30\n"},
    {"broken.png", "\x89PNG\r\n\x1a\nnothing"},
};

/// The error of a scene that cannot be made ready; its location is that of the texture's line.
std::string error_of(const std::string& texture) {
  try {
    TexturedScene scene("plane 0 0 0 0 0 1\n  " + texture, kFiles);
  } catch (const TextureError& error) {
    EXPECT_EQ(error.location.line, 2u) << texture;
    return error.what();
  }
  ADD_FAILURE() << "no error: " << texture;
  return "";
}

TEST(CompiledTextures, TellsWhatIsWrongWithAFile) {
  EXPECT_THAT(error_of("texture marble missing.map"), HasSubstr("Cannot open colormap file \"missing.map\""));
  EXPECT_THAT(error_of("texture fbm 0 1 .5 2 4 -1 bad.map"), HasSubstr("bad.map, line 2"));
  EXPECT_THAT(error_of("texture mount bad.map 1 1"), HasSubstr("bad.map, line 2"));
  EXPECT_THAT(error_of("texture image missing.ppm"), HasSubstr("missing.ppm"));
  EXPECT_THAT(error_of("texture image broken.png"), HasSubstr("broken.png"));
}

TEST(CompiledTextures, ChecksTheChannelsOfNamedComponents) {
  for (const char* component : {"reflect", "transp", "specpow", "bump", "index"}) {
    EXPECT_EQ(error_of(std::string("texture image color.ppm component ") + component),
              "Image color.ppm must have 1 channel");
    EXPECT_NO_THROW(TexturedScene(
        std::string("plane 0 0 0 0 0 1 texture image grey.pgm component ") + component, kFiles));
  }
  for (const char* component : {"ambient", "diffuse", "specular", "body"}) {
    EXPECT_NO_THROW(TexturedScene(
        std::string("plane 0 0 0 0 0 1 texture image color.ppm component ") + component, kFiles));
  }
}

TEST(CompiledTextures, ReadsAFileOnce) {
  const TexturedScene scene(
      "plane 0 0 0 0 0 1 texture marble ok.map texture mount ok.map 1 1 texture image grey.pgm\n"
      "sphere 1 0 0 0 texture fbm 0 1 .5 2 4 -1 ok.map texture image grey.pgm component bump",
      kFiles);
  EXPECT_EQ(scene.textures().files(), 2u);
  EXPECT_EQ(scene.textures().bytes(), 256 * sizeof(Color) + 2);
}

TEST(CompiledTextures, ForgetsWhatNobodyWears) {
  const TexturedScene scene("name unused sphere 1 0 0 0 texture marble missing.map\nplane 0 0 0 0 0 1");
  EXPECT_EQ(scene.textures().files(), 0u);
}

TEST(CompiledTextures, PreparesConstants) {
  const TexturedScene scene(
      "plane 0 0 0 0 0 1 texture fbm 0 1 .3 2.5 4 -1 scale 2 3 4 translate 1 2 3 texture wood translate "
      "(time) 0 0");
  const CompiledTextureList& list = scene.textures().list(scene.compiled().path_nodes.at(0).textures);
  ASSERT_EQ(list.textures.size(), 2u);
  const CompiledTexture& fbm = list.textures[0];
  EXPECT_NEAR(fbm.fbm.omega, std::exp(-0.8 * std::log(2.5)), 1e-15);
  EXPECT_EQ(fbm.fbm.lambda, 2.5);
  EXPECT_EQ(fbm.fbm.octaves, 4);
  EXPECT_TRUE(fbm.transformed);
  EXPECT_FALSE(fbm.animated);
  EXPECT_EQ(fbm.transform.forward.point({1, 1, 1}), (Vec3{3, 5, 7}));
  EXPECT_LT(length(fbm.transform.inverse.point({3, 5, 7}) - Vec3{1, 1, 1}), 1e-15);
  EXPECT_TRUE(list.textures[1].animated);
}

TEST(CompiledTextures, KnowsWhatChangesTransmission) {
  const auto changes = [](const std::string& texture) {
    const TexturedScene scene("plane 0 0 0 0 0 1 texture " + texture, kFiles);
    return scene.textures().list(scene.compiled().path_nodes.at(0).textures).changes_transmission;
  };
  for (const char* texture :
       {"checker ambient 1 1 1", "blotch 0 ambient 1 1 1", "sky 1 .5 2 4 .6 .3", "cloud 1 .5 2 4 .1 .3 .6",
        "stripe ambient 1 1 1 .1 .2", "image color.ppm component body", "image grey.pgm component transp",
        "image color.ppm textsurf transp .5"}) {
    EXPECT_TRUE(changes(texture)) << texture;
  }
  for (const char* texture :
       {"bump 1", "marble", "fbm 0 1 .5 2 4 -1", "fbmbump 0 1 .5 2 4", "wood", "gloss .5",
        "windy 1 1 1 1 3 2 .5 .1", "mount ok.map 1 1", "image color.ppm", "image grey.pgm component bump"}) {
    EXPECT_FALSE(changes(texture)) << texture;
  }
}

}  // namespace
}  // namespace rayshade
