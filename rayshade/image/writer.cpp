// SPDX-License-Identifier: MIT
#include "rayshade/image/writer.h"

#include <fmt/format.h>

#include <stdexcept>

#include "rayshade/image/writers.h"

namespace rayshade {

void write_picture(const FrameBuffer& picture, FileFormat format, const PictureInfo& info, Sink& sink) {
  if (picture.storage() != storage_of(format))
    throw std::invalid_argument(
        fmt::format("the frame buffer does not store what {} needs", format_name(format)));
  switch (format) {
    case FileFormat::kPng8:
    case FileFormat::kPng16:
      return detail::write_png(picture, info, sink);
    case FileFormat::kExr:
      return detail::write_exr(picture, info, sink);
    case FileFormat::kRle:
    case FileFormat::kRleExponential:
      return detail::write_rle(picture, info, sink);
    case FileFormat::kPpm:
      return detail::write_ppm(picture, sink);
    case FileFormat::kRaw:
      return detail::write_raw(picture, sink);
    case FileFormat::kPfm:
      return detail::write_pfm(picture, sink);
  }
}

}  // namespace rayshade
