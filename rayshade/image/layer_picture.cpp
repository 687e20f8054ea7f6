// SPDX-License-Identifier: MIT
#include "rayshade/image/layer_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "rayshade/image/writers.h"
#include "rayshade/math/functions.h"

namespace rayshade {
namespace {

// sRGB codes of colours whose CIE lightness goes from 12 to 94 in equal steps, while the hue goes from violet
// (310 degrees) to yellow (95 degrees), each as saturated as sRGB allows, but no more than a chroma of 62.
constexpr int kSteps = 16;
constexpr double kScale[kSteps + 1][3] = {
    {39, 3, 99},    {17, 28, 121},  {2, 48, 125},   {0, 64, 130},    {2, 78, 137},    {4, 94, 136},
    {3, 110, 139},  {2, 125, 143},  {9, 141, 143},  {6, 157, 137},   {3, 175, 114},   {88, 187, 93},
    {138, 197, 85}, {183, 205, 83}, {218, 214, 89}, {241, 226, 102}, {255, 237, 178},
};

void check_layer(const FrameBuffer& picture, int layer) {
  if (layer < 0 || layer >= static_cast<int>(picture.layers().size()))
    throw std::out_of_range(fmt::format("the picture has no layer {}", layer));
}

class Scale {
 public:
  Scale(const FrameBuffer& picture, int layer, const FalseColorScale& wanted)
      : low_(wanted.low), high_(wanted.high), logarithmic_(wanted.logarithmic) {
    if (wanted.automatic) find(picture, layer);
    from_ = coordinate(low_);
    const double range = coordinate(high_) - from_;
    factor_ = range > 0 ? 1 / range : 0;
  }

  double position(double value) const {
    if (logarithmic_ && value <= 0) return 0;
    return (coordinate(value) - from_) * factor_;
  }
  double low() const { return low_; }
  double high() const { return high_; }

 private:
  double coordinate(double value) const {
    return logarithmic_ ? fn::log(std::max(value, double{std::numeric_limits<float>::min()})) : value;
  }
  // The extremes of what has arrived; values without a logarithm do not count for a logarithmic scale.
  void find(const FrameBuffer& picture, int layer) {
    low_ = std::numeric_limits<double>::infinity();
    high_ = -low_;
    std::vector<float> row(static_cast<std::size_t>(picture.width()));
    for (std::int64_t y = 0; y < picture.height(); ++y) {
      picture.read_layer_row(layer, y, row.data());
      for (std::int64_t x = 0; x < picture.width(); ++x) {
        const double value = row[static_cast<std::size_t>(x)];
        if (!std::isfinite(value) || (logarithmic_ && value <= 0) || !picture.is_present(x, y)) continue;
        low_ = std::min(low_, value);
        high_ = std::max(high_, value);
      }
    }
    if (low_ > high_) low_ = high_ = 0;
  }

  double low_, high_;
  bool logarithmic_;
  double from_ = 0, factor_ = 0;
};

class FalseColorRows : public detail::PngRows {
 public:
  FalseColorRows(const FrameBuffer& picture, int layer, const Scale& scale)
      : picture_(picture), layer_(layer), scale_(scale), row_(static_cast<std::size_t>(picture.width())) {}

  void read(std::int64_t y, std::uint8_t* out) override {
    picture_.read_layer_row(layer_, y, row_.data());
    for (std::int64_t x = 0; x < picture_.width(); ++x, out += 4) {
      if (!picture_.is_present(x, y)) {
        std::fill_n(out, 4, std::uint8_t{0});
        continue;
      }
      const auto color = false_color(scale_.position(row_[static_cast<std::size_t>(x)]));
      std::copy(color.begin(), color.end(), out);
      out[3] = 255;
    }
  }

 private:
  const FrameBuffer& picture_;
  int layer_;
  const Scale& scale_;
  std::vector<float> row_;
};

}  // namespace

std::array<std::uint8_t, 3> false_color(double t) {
  if (std::isnan(t)) return {128, 128, 128};
  const double at = std::clamp(t, 0.0, 1.0) * kSteps;
  const int step = std::min(static_cast<int>(at), kSteps - 1);
  const double part = at - step;
  std::array<std::uint8_t, 3> color{};
  for (std::size_t c = 0; c < 3; ++c)
    color[c] = static_cast<std::uint8_t>(
        std::lround(kScale[step][c] + part * (kScale[step + 1][c] - kScale[step][c])));
  return color;
}

void write_layer_pfm(const FrameBuffer& picture, int layer, Sink& sink) {
  check_layer(picture, layer);
  const char* const order = std::endian::native == std::endian::little ? "-1.0" : "1.0";
  sink.write(fmt::format("Pf\n{} {}\n{}\n", picture.width(), picture.height(), order));
  std::vector<float> row(static_cast<std::size_t>(picture.width()));
  for (std::int64_t y = picture.height() - 1; y >= 0; --y) {
    picture.read_layer_row(layer, y, row.data());
    sink.write(row.data(), row.size() * sizeof(float));
  }
}

void write_layer_png(const FrameBuffer& picture, int layer, const FalseColorScale& wanted, Sink& sink) {
  check_layer(picture, layer);
  const Scale scale(picture, layer, wanted);
  FalseColorRows rows(picture, layer, scale);
  detail::PngHeader header;
  header.width = picture.width();
  header.height = picture.height();
  header.channels = 4;
  header.text = {{"Layer", picture.layers()[static_cast<std::size_t>(layer)]},
                 {"Low", fmt::format("{}", scale.low())},
                 {"High", fmt::format("{}", scale.high())},
                 {"Scale", wanted.logarithmic ? "logarithmic" : "linear"}};
  detail::write_png(header, rows, sink);
}

}  // namespace rayshade
