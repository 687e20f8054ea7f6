// SPDX-License-Identifier: MIT
// Layers as PFM and in false colours.
#include "rayshade/image/layer_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "rayshade/image/reader.h"
#include "tests/unit/image/pictures.h"

namespace rayshade {
namespace {

// CIE lightness of sRGB codes, from the definitions of both.
double lightness(const std::array<std::uint8_t, 3>& color) {
  const double weights[] = {0.2126, 0.7152, 0.0722};
  double luminance = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double v = color[c] / 255.0;
    luminance += weights[c] * (v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
  }
  return luminance > 216.0 / 24389 ? 116 * std::cbrt(luminance) - 16 : luminance * 24389 / 27;
}

TEST(FalseColor, LightnessIsLinear) {
  for (int i = 0; i <= 256; ++i) {
    const double t = i / 256.0;
    EXPECT_NEAR(lightness(false_color(t)), 12 + 82 * t, 1.0) << t;
  }
  EXPECT_EQ(false_color(-3), false_color(0));
  EXPECT_EQ(false_color(7), false_color(1));
  EXPECT_EQ(false_color(std::numeric_limits<double>::infinity()), false_color(1));
  const auto grey = false_color(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(grey[0], grey[1]);
  EXPECT_EQ(grey[1], grey[2]);
}

// A picture of 3 x 2 pixels whose layer 1 holds five values; the last pixel is missing.
struct Layered {
  explicit Layered(const std::vector<float>& values);
  FrameBuffer buffer = test::make_buffer(FileFormat::kPng8, 3, 2, {}, {"depth.Z", "cost"});
};

Layered::Layered(const std::vector<float>& values) {
  const std::vector<double> rgba(4 * 5, 0.5);
  const std::vector<float> zero(5);
  buffer.put(PixelBlock{0,
                        0,
                        3,
                        1,
                        std::span(rgba).subspan(0, 12),
                        {std::span(zero).subspan(0, 3), std::span(values).subspan(0, 3)}});
  buffer.put(PixelBlock{0,
                        1,
                        2,
                        1,
                        std::span(rgba).subspan(0, 8),
                        {std::span(zero).subspan(0, 2), std::span(values).subspan(3, 2)}});
}

TEST(LayerPicture, PfmHoldsTheNumbers) {
  const Layered layered({1, 2, 3, 4, -5});
  const FrameBuffer& buffer = layered.buffer;
  MemorySink sink;
  write_layer_pfm(buffer, 1, sink);
  const Image image = read_image(sink.bytes());
  EXPECT_EQ(image.channels, 1);
  EXPECT_EQ(image.value(0, 1, 0), 1);
  EXPECT_EQ(image.value(2, 1, 0), 3);
  EXPECT_EQ(image.value(1, 0, 0), -5);
}

std::array<std::uint8_t, 3> color_at(const Image& image, std::int64_t x, std::int64_t y) {
  const auto i = static_cast<std::size_t>((y * image.width + x) * 4);
  return {image.bytes[i], image.bytes[i + 1], image.bytes[i + 2]};
}

TEST(LayerPicture, PngSpansTheFiniteValuesThatArePresent) {
  const Layered layered({10, std::numeric_limits<float>::infinity(), 20, 30, 20});
  const FrameBuffer& buffer = layered.buffer;
  MemorySink sink;
  write_layer_png(buffer, 1, {}, sink);
  const Image image = read_image(sink.bytes());
  ASSERT_TRUE(image.has_alpha);
  EXPECT_EQ(color_at(image, 0, 1), false_color(0));
  EXPECT_EQ(color_at(image, 1, 1), false_color(1));  // infinite: the top of the scale
  EXPECT_EQ(color_at(image, 2, 1), false_color(0.5));
  EXPECT_EQ(color_at(image, 0, 0), false_color(1));
  EXPECT_EQ(image.alpha(0, 0), 1);
  EXPECT_EQ(image.alpha(2, 0), 0);  // missing
  EXPECT_NE(sink.bytes().find(std::string("High\0"
                                          "30",
                                          7)),
            std::string::npos);
}

TEST(LayerPicture, FixedAndLogarithmicScales) {
  const Layered layered({1, 10, 100, 0, -4});
  const FrameBuffer& buffer = layered.buffer;
  MemorySink sink;
  FalseColorScale scale;
  scale.logarithmic = true;
  write_layer_png(buffer, 1, scale, sink);
  const Image logarithmic = read_image(sink.bytes());
  EXPECT_EQ(color_at(logarithmic, 0, 1), false_color(0));
  EXPECT_EQ(color_at(logarithmic, 1, 1), false_color(0.5));
  EXPECT_EQ(color_at(logarithmic, 2, 1), false_color(1));
  EXPECT_EQ(color_at(logarithmic, 0, 0), false_color(0));
  MemorySink second;
  scale = {false, 0, 200, false};
  write_layer_png(buffer, 1, scale, second);
  EXPECT_EQ(color_at(read_image(second.bytes()), 2, 1), false_color(0.5));
}

TEST(LayerPicture, ConstantAndMissingLayers) {
  const Layered layered({4, 4, 4, 4, 4});
  const FrameBuffer& buffer = layered.buffer;
  MemorySink sink;
  write_layer_png(buffer, 1, {}, sink);
  EXPECT_EQ(color_at(read_image(sink.bytes()), 0, 0), false_color(0));
  EXPECT_THROW(write_layer_png(buffer, 2, {}, sink), std::out_of_range);
  EXPECT_THROW(write_layer_pfm(buffer, -1, sink), std::out_of_range);
}

}  // namespace
}  // namespace rayshade
