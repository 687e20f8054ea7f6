// SPDX-License-Identifier: MIT
// Picture file formats by name and by suffix, and the names of numbered and of partial files.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "rayshade/image/frame_buffer.h"

namespace rayshade {

enum class FileFormat : std::uint8_t {
  kPng8,
  kPng16,
  kPpm,             ///< P6, 8 bits
  kPfm,             ///< 32-bit floats, linear
  kExr,             ///< half or float, linear, with layers
  kRle,             ///< Utah raster toolkit
  kRleExponential,  ///< the same with a shared exponent
  kRaw,             ///< the original's plain format: "width height", newline, RGB bytes, rows from the top
};

/// A format that is unknown or not built in, or a pattern for numbered files that is not one.
struct FormatError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// By option value: png (8 bits), png8, png16, ppm, pfm, exr, rle, rle-exponential, raw. Throws FormatError,
/// which lists the choices, or says that OpenEXR was left out of this build.
FileFormat format_by_name(std::string_view name);

/// By suffix, in either case: .png .ppm .pfm .exr .rle .raw .img. Nothing where the suffix tells nothing;
/// throws FormatError for .exr in a build without OpenEXR.
std::optional<FileFormat> format_by_suffix(std::string_view path);

/// "png", "rle-exponential" ...: what format_by_name accepts.
std::string_view format_name(FileFormat format);

/// What the frame buffer of such a file has to store.
PixelStorage storage_of(FileFormat format);

/// Whether several frames may stand one after the other in one file (RLE, raw, PPM, PFM).
bool can_append(FileFormat format);

/// Whether the format has a place for alpha (all but PPM, PFM and raw).
bool has_alpha(FileFormat format);

/// Whether colours are stored linear, whatever the ColorEncoding says (PFM, EXR).
bool is_linear(FileFormat format);

/// Whether `pattern` has a place for the frame number. Throws FormatError for a broken pattern.
bool is_numbered(std::string_view pattern);

/// Replaces the one `%d` or `%0Nd` (N from 1 to 9) of `pattern` by `frame`, and `%%` by `%`. A pattern
/// without a place for the number is returned as it is, with `%%` replaced. Throws FormatError for any other
/// use of `%`.
std::string numbered_name(std::string_view pattern, std::int64_t frame);

/// "a/b.png" -> "a/b.partial.png"; a name without suffix gets ".partial" at its end.
std::string partial_name(std::string_view path);

}  // namespace rayshade
