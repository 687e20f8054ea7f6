// SPDX-License-Identifier: MIT
// The writers behind write_picture(), one function per family of formats. Internal to the layer.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "rayshade/image/frame_buffer.h"
#include "rayshade/image/sink.h"
#include "rayshade/image/writer.h"

namespace rayshade::detail {

/// Gives the rows of a PNG from the top, as bytes in PNG's order (16-bit words big-endian).
class PngRows {
 public:
  virtual ~PngRows() = default;
  virtual void read(std::int64_t y, std::uint8_t* out) = 0;
};

struct PngHeader {
  std::int64_t width = 0, height = 0;
  int depth = 8;     ///< 8 or 16
  int channels = 3;  ///< 3 or 4
  bool srgb = false;
  double file_gamma = 0;  ///< gAMA, 0 for none
  std::vector<std::pair<std::string, std::string>> text;
};

void write_png(const PngHeader& header, PngRows& rows, Sink& sink);

void write_png(const FrameBuffer& picture, const PictureInfo& info, Sink& sink);
void write_exr(const FrameBuffer& picture, const PictureInfo& info, Sink& sink);
void write_rle(const FrameBuffer& picture, const PictureInfo& info, Sink& sink);
void write_ppm(const FrameBuffer& picture, Sink& sink);
void write_raw(const FrameBuffer& picture, Sink& sink);
void write_pfm(const FrameBuffer& picture, Sink& sink);

}  // namespace rayshade::detail
