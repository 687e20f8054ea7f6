// SPDX-License-Identifier: MIT
// Frame buffer to picture file, row by row. The same pixels and the same PictureInfo give the same bytes:
// nothing here asks for the date, the machine or the number of threads.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "rayshade/image/format.h"
#include "rayshade/image/frame_buffer.h"
#include "rayshade/image/sink.h"

namespace rayshade {

/// What a picture file tells besides its pixels.
struct PictureInfo {
  /// Position of the window's upper left pixel on the screen, and the screen's size (0: the picture itself).
  /// RLE headers count rows from the bottom, EXR has a display window.
  std::int64_t min_x = 0, min_y = 0, screen_width = 0, screen_height = 0;
  bool alpha = true;  ///< store alpha where the format can
  /// The encoding of the stored colours is the frame buffer's. Whether to say so in the file: PNG gAMA or
  /// sRGB.
  bool tag_encoding = true;
  /// Keys and values that determine the picture: "Software", "Scene-Hash", "Seed" ... Keys are 1 to 79
  /// Latin-1 characters. PNG text chunks, EXR attributes, RLE comments; the other formats carry none.
  std::vector<std::pair<std::string, std::string>> provenance;
  bool exr_half = true;  ///< EXR colours as 16-bit floats; layers are always 32 bits
};

/// Writes `picture` as `format`. The buffer must store what the format needs (storage_of). Missing pixels are
/// black with alpha 0. Blocks may still arrive meanwhile. Throws WriteError from the sink or where the format
/// cannot hold the picture (an RLE side beyond 65,535), std::invalid_argument for a storage that does not
/// fit, FormatError for EXR in a build without it.
void write_picture(const FrameBuffer& picture, FileFormat format, const PictureInfo& info, Sink& sink);

}  // namespace rayshade
