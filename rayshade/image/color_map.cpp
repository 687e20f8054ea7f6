// SPDX-License-Identifier: MIT
#include "rayshade/image/color_map.h"

#include <charconv>

namespace rayshade {
namespace {

/// Takes a decimal integer, with an optional sign, from the front of `line`.
bool take_integer(std::string_view& line, int& value) {
  std::size_t start = 0;
  while (start < line.size() && (line[start] == ' ' || (line[start] >= '\t' && line[start] <= '\r'))) ++start;
  line.remove_prefix(start);
  if (line.starts_with('+') && line.size() > 1 && line[1] != '-') line.remove_prefix(1);
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
  if (error != std::errc{}) return false;
  line.remove_prefix(static_cast<std::size_t>(end - line.data()));
  return true;
}

}  // namespace

ColorMap read_color_map(std::string_view text) {
  ColorMap map{};
  for (int i = 0; i < 256 && !text.empty(); ++i) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    int r = 0, g = 0, b = 0;
    if (!take_integer(line, r) || !take_integer(line, g) || !take_integer(line, b))
      throw ColorMapError(i + 1, "three integers (red, green, blue) are expected");
    map[static_cast<std::size_t>(i)] = Color{1.0 / 255 * r, 1.0 / 255 * g, 1.0 / 255 * b};
  }
  return map;
}

}  // namespace rayshade
