// SPDX-License-Identifier: MIT
#include "rayshade/image/height_field_file.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>

namespace rayshade {
namespace {

std::uint32_t word_at(std::string_view bytes, std::size_t index, bool little) {
  const auto byte = [&](std::size_t i) {
    return std::uint32_t{static_cast<std::uint8_t>(bytes[4 * index + i])};
  };
  return little ? byte(0) | byte(1) << 8 | byte(2) << 16 | byte(3) << 24
                : byte(3) | byte(2) << 8 | byte(1) << 16 | byte(0) << 24;
}

/// Whether a field of n x n points, n at least 2, fits into the bytes that follow the size word.
bool fits(std::int32_t n, std::string_view bytes) {
  const std::uint64_t floats = bytes.size() / 4 - 1;
  return n >= 2 && static_cast<std::uint64_t>(n) * static_cast<std::uint64_t>(n) <= floats;
}

}  // namespace

HeightFieldData read_height_field(std::string_view bytes) {
  if (bytes.size() < 4) throw HeightFieldError("the file is too short to hold its size");
  const auto little_size = static_cast<std::int32_t>(word_at(bytes, 0, true));
  const auto big_size = static_cast<std::int32_t>(word_at(bytes, 0, false));
  bool little = true;
  if (!fits(little_size, bytes)) {
    if (!fits(big_size, bytes)) {
      // Of the two readings the one nearer to zero is what somebody may have meant.
      const auto magnitude = [](std::int32_t n) { return n < 0 ? -static_cast<std::int64_t>(n) : n; };
      const std::int32_t size = magnitude(big_size) < magnitude(little_size) ? big_size : little_size;
      if (size < 2) throw HeightFieldError(fmt::format("{} points per side; at least 2 are needed", size));
      throw HeightFieldError(fmt::format("not enough data: {} x {} altitudes are announced, {} are there",
                                         size, size, bytes.size() / 4 - 1));
    }
    little = false;
  }
  HeightFieldData field;
  field.size = little ? little_size : big_size;
  const std::size_t count = static_cast<std::size_t>(field.size) * static_cast<std::size_t>(field.size);
  field.altitudes.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    float altitude = std::bit_cast<float>(word_at(bytes, i + 1, little));
    if (!(altitude > kUnsetAltitude)) altitude = kUnsetAltitude;
    if (std::isinf(altitude)) throw HeightFieldError(fmt::format("altitude number {} is infinite", i));
    field.altitudes.push_back(altitude);
  }
  return field;
}

}  // namespace rayshade
