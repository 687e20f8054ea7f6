// SPDX-License-Identifier: MIT
// The readers behind read_image(), one function per family of formats. Internal to the layer.
#pragma once

#include <cstdint>
#include <string_view>

#include "rayshade/image/image.h"

namespace rayshade::detail {

// Each takes the whole file, throws ImageError, and leaves row 0 at v = 0.
Image read_png(std::string_view bytes);
Image read_pnm(std::string_view bytes);
Image read_pfm(std::string_view bytes);
Image read_rle(std::string_view bytes);
Image read_raw(std::string_view bytes);

/// Throws ImageError unless both sides are positive and their product is at most `most` and kMaxImagePixels.
void check_size(std::int64_t width, std::int64_t height, std::int64_t most);

/// Turns the rows of an image upside down.
void flip_rows(Image& image);

}  // namespace rayshade::detail
