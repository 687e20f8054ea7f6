// SPDX-License-Identifier: MIT
// Pictures that the tests of the image layer share.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "rayshade/image/format.h"
#include "rayshade/image/frame_buffer.h"
#include "rayshade/image/sink.h"
#include "rayshade/image/writer.h"

namespace rayshade::test {

inline const std::vector<FileFormat>& all_formats() {
  static const std::vector<FileFormat> formats = {
      FileFormat::kPng8, FileFormat::kPng16,          FileFormat::kPpm, FileFormat::kPfm,
#ifdef RAYSHADE_HAVE_OPENEXR
      FileFormat::kExr,
#endif
      FileFormat::kRle,  FileFormat::kRleExponential, FileFormat::kRaw,
  };
  return formats;
}

/// Linear colours with flat parts, ramps, noise, values out of range and empty rows: 4 doubles per pixel.
inline std::vector<double> mixed_pixels(std::int64_t width, std::int64_t height, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::vector<double> rgba(static_cast<std::size_t>(4 * width * height));
  for (std::int64_t y = 0; y < height; ++y) {
    const auto kind = y % 5;
    for (std::int64_t x = 0; x < width; ++x) {
      double* const p = &rgba[static_cast<std::size_t>(4 * (y * width + x))];
      if (kind == 0) continue;
      for (int c = 0; c < 3; ++c) {
        const double ramp = static_cast<double>(x + c) / static_cast<double>(width);
        if (kind == 1) p[c] = 0.25 * (c + 1);
        if (kind == 2) p[c] = ramp;
        if (kind == 3) p[c] = static_cast<double>(random() % 4096) / 2048 - 0.5;
        if (kind == 4) p[c] = x % 16 < 9 ? 0 : ramp;
      }
      p[3] = kind == 4 ? static_cast<double>(x % 16) / 15 : 1;
    }
  }
  return rgba;
}

inline FrameBuffer make_buffer(FileFormat format, std::int64_t width, std::int64_t height,
                               ColorEncoding encoding = {}, const std::vector<std::string>& layers = {}) {
  FrameBufferOptions options;
  options.width = width;
  options.height = height;
  options.storage = storage_of(format);
  options.encoding = encoding;
  options.layers = layers;
  return FrameBuffer(options);
}

inline void fill(FrameBuffer& buffer, const std::vector<double>& rgba) {
  buffer.put(PixelBlock{0, 0, buffer.width(), buffer.height(), rgba, {}});
}

inline std::string written(const FrameBuffer& buffer, FileFormat format, const PictureInfo& info = {}) {
  MemorySink sink;
  write_picture(buffer, format, info, sink);
  return sink.bytes();
}

inline std::string mixed_file(FileFormat format, std::int64_t width, std::int64_t height, bool alpha = true) {
  FrameBuffer buffer = make_buffer(format, width, height);
  fill(buffer, mixed_pixels(width, height));
  PictureInfo info;
  info.alpha = alpha;
  info.provenance = {{"Software", "rayshade"}, {"Seed", "7"}};
  return written(buffer, format, info);
}

}  // namespace rayshade::test
