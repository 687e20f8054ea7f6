// SPDX-License-Identifier: MIT
// Image look-up, tiling and components (textures.md 6, 8.3).
#include "rayshade/texture/image_texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rayshade {
namespace {

/// 5 x 4 colour, the picture of the check scenes.
Image color_image() {
  Image image;
  image.width = 5;
  image.height = 4;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 5; ++x) {
      for (const int code : {40 * x + 10, 60 * y + 5, std::min(255, 30 * x * y + 7)}) {
        image.bytes.push_back(static_cast<std::uint8_t>(code));
      }
    }
  }
  return image;
}

Image grey_image(bool alpha) {
  Image image;
  image.width = 3;
  image.height = 2;
  image.channels = 1;
  image.has_alpha = alpha;
  for (int i = 0; i < 6; ++i) {
    image.bytes.push_back(static_cast<std::uint8_t>(10 * i));
    if (alpha) image.bytes.push_back(static_cast<std::uint8_t>(51 * i));
  }
  return image;
}

TEST(Texel, IsTheCellWithoutSmoothing) {
  const Image image = color_image();
  const auto red_green = [&](double u, double v) {
    const Texel t = texel_at(image, locate_texel(image, u, v), false);
    return std::pair<int, int>(static_cast<int>(t.color.r * 255 + 0.5),
                               static_cast<int>(t.color.g * 255 + 0.5));
  };
  EXPECT_EQ(red_green(0, 0), std::pair(10, 5));
  EXPECT_EQ(red_green(0.39, 0.76), std::pair(50, 185));
  EXPECT_EQ(red_green(0.99, 0.99), std::pair(170, 185));
  EXPECT_EQ(red_green(-0.01, -0.26), std::pair(170, 125));
  EXPECT_EQ(red_green(7.25, -3.75), std::pair(50, 65));
}

TEST(Texel, SmoothInterpolatesFromTheLowerLeftCornersAndWraps) {
  const Image image = color_image();
  const auto value = [&](int x, int y, int c) { return image.value((x + 5) % 5, (y + 4) % 4, c); };
  for (double u = -1.03; u < 1.2; u += 0.071) {
    for (double v = -0.47; v < 1.2; v += 0.083) {
      const double su = (u - std::floor(u)) * 5, sv = (v - std::floor(v)) * 4;
      const int x = static_cast<int>(su), y = static_cast<int>(sv);
      const double fx = su - x, fy = sv - y;
      const Texel t = texel_at(image, locate_texel(image, u, v), true);
      const auto expected = [&](int c) {
        const double low = value(x, y, c) + fx * (value(x + 1, y, c) - value(x, y, c));
        const double high = value(x, y + 1, c) + fx * (value(x + 1, y + 1, c) - value(x, y + 1, c));
        return low + fy * (high - low);
      };
      ASSERT_NEAR(t.color.r, expected(0), 1e-14);
      ASSERT_NEAR(t.color.g, expected(1), 1e-14);
      ASSERT_NEAR(t.color.b, expected(2), 1e-14);
      ASSERT_NEAR(t.alpha, 1, 1e-14);
    }
  }
}

TEST(Texel, NeverLeavesThePicture) {
  const Image image = color_image();
  const double inf = std::numeric_limits<double>::infinity();
  // -1e-17 wraps to exactly 1, where the original read beyond the row (textures.md D13).
  for (const double u : {-1e-17, -1e-300, 1e300, inf, -inf, std::nan("")}) {
    const TexelPosition p = locate_texel(image, u, u);
    EXPECT_EQ(p.x, 0) << u;
    EXPECT_EQ(p.y, 0) << u;
    EXPECT_EQ(p.fx, 0) << u;
    EXPECT_EQ(p.fy, 0) << u;
  }
}

TEST(Texel, GreyFillsAllChannelsAndCarriesAlpha) {
  const Image image = grey_image(true);
  const Texel t = texel_at(image, locate_texel(image, 0.5, 0.75), false);
  EXPECT_EQ(t.color, (Color{40 / 255.0, 40 / 255.0, 40 / 255.0}));
  EXPECT_EQ(t.alpha, 204 / 255.0);
  EXPECT_EQ(texel_at(grey_image(false), {}, false).alpha, 1);
}

TEST(Tile, HasTheOriginalsTable) {
  EXPECT_TRUE(tile_draws(5, -7, 0, 0));
  EXPECT_TRUE(tile_draws(0.5, 0.5, 1, 1));
  EXPECT_TRUE(tile_draws(1, 1, 1, 1));
  EXPECT_FALSE(tile_draws(1.01, 0.5, 1, 1));
  EXPECT_TRUE(tile_draws(1.5, 99, 2, 0));
  EXPECT_FALSE(tile_draws(-0.1, 0, 2, 0));
  EXPECT_FALSE(tile_draws(0.5, 0.5, -1, -1));
  EXPECT_TRUE(tile_draws(1.5, 0.5, -1, -1));
  EXPECT_FALSE(tile_draws(0, 0.5, -1, -1));
  EXPECT_FALSE(tile_draws(0.5, 9, -1, 0));
  EXPECT_TRUE(tile_draws(1, 9, -1, 0));
  EXPECT_FALSE(tile_draws(0.5, 0.5, 1, -1));
  EXPECT_TRUE(tile_draws(0.5, 1.5, 1, -1));
  EXPECT_FALSE(tile_draws(1.5, 1.5, 1, -1));
  EXPECT_TRUE(tile_draws(5, 5, 0.0005, 0));
}

TEST(Components, TakeTheirChannels) {
  using enum ImageComponent;
  for (const ImageComponent component : {kColor, kAmbient, kDiffuse, kSpecular, kBody}) {
    EXPECT_TRUE(component_takes(component, 1));
    EXPECT_TRUE(component_takes(component, 3));
    EXPECT_FALSE(component_takes(component, 2));
    EXPECT_FALSE(component_takes(component, 4));
  }
  for (const ImageComponent component : {kReflect, kTransp, kSpecpow, kBump, kIndex}) {
    EXPECT_TRUE(component_takes(component, 1));
    EXPECT_FALSE(component_takes(component, 3));
  }
}

Surface base_surface() {
  Surface s;
  s.ambient = {0.1, 0.2, 0.3};
  s.diffuse = {0.4, 0.5, 0.6};
  s.specular = {0.7, 0.8, 0.9};
  s.body = {0.9, 0.8, 0.7};
  s.reflectance = 0.5;
  s.transparency = 0.6;
  s.specular_exponent = 20;
  s.index = 1.5;
  return s;
}

TEST(ApplyTexel, WithoutComponentTintsThreeColoursIgnoringTheRange) {
  ImageOptions options;
  options.range_high = 7;
  options.range_low = 3;
  const Texel texel{{0.5, 0.25, 1}, 1};
  Surface s = base_surface(), expected = s;
  expected.ambient = expected.ambient * texel.color;
  expected.diffuse = expected.diffuse * texel.color;
  expected.specular = expected.specular * texel.color;
  apply_texel(texel, options, nullptr, s);
  EXPECT_EQ(s, expected);
}

TEST(ApplyTexel, NamedComponentsUseTheRange) {
  const Texel texel{{0.5, 0.25, 1}, 1};
  const Color ranged{2.5, 2.25, 3};  // 2 + x (3 - 2)
  const auto applied = [&](ImageComponent component) {
    ImageOptions options;
    options.component = component;
    options.range_high = 3;
    options.range_low = 2;
    Surface s = base_surface();
    apply_texel(texel, options, nullptr, s);
    return s;
  };
  const auto expect = [&](ImageComponent component, auto change) {
    Surface expected = base_surface();
    change(expected);
    EXPECT_EQ(applied(component), expected) << static_cast<int>(component);
  };
  using enum ImageComponent;
  expect(kAmbient, [&](Surface& s) { s.ambient *= ranged; });
  expect(kDiffuse, [&](Surface& s) { s.diffuse *= ranged; });
  expect(kSpecular, [&](Surface& s) { s.specular *= ranged; });
  expect(kBody, [&](Surface& s) { s.body *= ranged; });
  expect(kReflect, [&](Surface& s) { s.reflectance *= 2.5; });
  expect(kTransp, [&](Surface& s) { s.transparency *= 2.5; });
  expect(kSpecpow, [&](Surface& s) { s.specular_exponent *= 2.5; });
  expect(kIndex, [&](Surface& s) { s.index *= 2.5; });
  expect(kBump, [](Surface&) {});
}

TEST(ApplyTexel, ReplacementOnlyWithoutComponent) {
  Surface other = base_surface();
  other.index = 3;
  const Texel white{{1, 1, 1}, 1};
  Surface s;
  apply_texel(white, {}, &other, s);
  EXPECT_EQ(s, other);
  ImageOptions named;
  named.component = ImageComponent::kAmbient;
  Surface kept = base_surface();
  apply_texel(white, named, &other, kept);
  EXPECT_EQ(kept, base_surface());
}

TEST(ApplyTexel, AlphaMixes) {
  Surface other = base_surface();
  Surface s;
  apply_texel({{1, 1, 1}, 0.25}, {}, &other, s);
  EXPECT_DOUBLE_EQ(s.ambient.r, 0.025);
  EXPECT_DOUBLE_EQ(s.index, 0.75 + 0.25 * 1.5);
  Surface nearly;
  apply_texel({{1, 1, 1}, 0.9995}, {}, &other, nearly);
  EXPECT_EQ(nearly, other);
}

}  // namespace
}  // namespace rayshade
