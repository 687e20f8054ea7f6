// SPDX-License-Identifier: MIT
#include "rayshade/image/reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "rayshade/image/readers.h"

namespace rayshade {

ImageKind detect_image(std::string_view bytes) {
  if (bytes.starts_with("\x52\xcc")) return ImageKind::kRle;
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return ImageKind::kPng;
  if (bytes.size() > 2 && bytes[0] == 'P') {
    switch (bytes[1]) {
      case '2':
      case '3':
      case '5':
      case '6':
        return ImageKind::kPnm;
      case 'F':
      case 'f':
        return ImageKind::kPfm;
      default:
        break;
    }
  }
  return ImageKind::kRaw;
}

Image read_image(std::string_view bytes) {
  switch (detect_image(bytes)) {
    case ImageKind::kPng:
      return detail::read_png(bytes);
    case ImageKind::kPnm:
      return detail::read_pnm(bytes);
    case ImageKind::kPfm:
      return detail::read_pfm(bytes);
    case ImageKind::kRle:
      return detail::read_rle(bytes);
    case ImageKind::kRaw:
      break;
  }
  return detail::read_raw(bytes);
}

namespace detail {

void check_size(std::int64_t width, std::int64_t height, std::int64_t most) {
  if (width < 1 || height < 1) throw ImageError(fmt::format("a picture of {} x {} pixels", width, height));
  if (width > kMaxImagePixels / height)
    throw ImageError(fmt::format("{} x {} pixels are more than can be read", width, height));
  if (width * height > most)
    throw ImageError(fmt::format("the file is too short for {} x {} pixels", width, height));
}

void flip_rows(Image& image) {
  const auto flip = [&](auto& samples) {
    const std::ptrdiff_t row = image.width * image.samples_per_pixel();
    for (std::int64_t y = 0; y < image.height / 2; ++y)
      std::swap_ranges(samples.begin() + y * row, samples.begin() + (y + 1) * row,
                       samples.begin() + (image.height - 1 - y) * row);
  };
  if (image.depth == 8) flip(image.bytes);
  if (image.depth == 16) flip(image.words);
  if (image.depth == 32) flip(image.floats);
}

}  // namespace detail
}  // namespace rayshade
