// SPDX-License-Identifier: MIT
// PPM, PFM and the original's raw format (shading.md 8.3): a line of text, then the samples.
#include <fmt/format.h>

#include <bit>
#include <cstring>

#include "rayshade/image/writers.h"

namespace rayshade::detail {
namespace {

void write_rgb_rows(const FrameBuffer& picture, Sink& sink) {
  const std::size_t width = static_cast<std::size_t>(picture.width());
  std::vector<std::uint8_t> row(picture.row_bytes());
  for (std::int64_t y = 0; y < picture.height(); ++y) {
    picture.read_row(y, row.data());
    // Alpha is squeezed out in place: the target never overtakes the source.
    for (std::size_t x = 0; x < width; ++x)
      for (std::size_t c = 0; c < 3; ++c) row[3 * x + c] = row[4 * x + c];
    sink.write(row.data(), 3 * width);
  }
}

}  // namespace

void write_ppm(const FrameBuffer& picture, Sink& sink) {
  sink.write(fmt::format("P6\n{} {}\n255\n", picture.width(), picture.height()));
  write_rgb_rows(picture, sink);
}

void write_raw(const FrameBuffer& picture, Sink& sink) {
  sink.write(fmt::format("{} {}\n", picture.width(), picture.height()));
  write_rgb_rows(picture, sink);
}

void write_pfm(const FrameBuffer& picture, Sink& sink) {
  // The sign of the scale tells the byte order of the machine that writes.
  const char* const scale = std::endian::native == std::endian::little ? "-1.0" : "1.0";
  sink.write(fmt::format("PF\n{} {}\n{}\n", picture.width(), picture.height(), scale));
  const std::size_t width = static_cast<std::size_t>(picture.width());
  std::vector<float> row(4 * width);
  for (std::int64_t y = picture.height() - 1; y >= 0; --y) {
    picture.read_row(y, reinterpret_cast<std::uint8_t*>(row.data()));
    for (std::size_t x = 0; x < width; ++x)
      for (std::size_t c = 0; c < 3; ++c) row[3 * x + c] = row[4 * x + c];
    sink.write(row.data(), 3 * width * sizeof(float));
  }
}

}  // namespace rayshade::detail
