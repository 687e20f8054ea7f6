// SPDX-License-Identifier: MIT
#include "rayshade/render/scene_change.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "rayshade/image/record.h"
#include "rayshade/scene/hash128.h"

namespace rayshade {
namespace {

/// Larger texts would be larger than many a picture.
constexpr std::size_t kLargestText = 256 << 10;

std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

std::uint64_t line_hash(std::string_view line) { return hash128(line).first; }

std::string quoted(std::string_view line) {
  constexpr std::size_t kLongest = 100;
  return line.size() <= kLongest ? fmt::format("'{}'", line)
                                 : fmt::format("'{} ...'", line.substr(0, kLongest));
}

std::string text_difference(std::string_view was, std::string_view now) {
  while (!was.empty() && !now.empty()) {
    const std::string_view before = take_line(was), after = take_line(now);
    if (before != after)
      return fmt::format("the scene has changed: {} is now {}", quoted(before), quoted(after));
  }
  if (!was.empty()) return fmt::format("the scene has changed: {} is gone", quoted(take_line(was)));
  if (!now.empty()) return fmt::format("the scene has changed: {} is new", quoted(take_line(now)));
  return "the scene has changed";
}

std::string line_difference(const std::vector<std::uint64_t>& was, std::string_view now) {
  std::size_t i = 0;
  for (; i < was.size() && !now.empty(); ++i)
    if (const std::string_view line = take_line(now); line_hash(line) != was[i])
      return fmt::format("the scene has changed, first in its line {} that is now {}", i + 1, quoted(line));
  if (i < was.size())
    return fmt::format("the scene has changed: the last {} of its {} lines are gone", was.size() - i,
                       was.size());
  if (!now.empty()) return fmt::format("the scene has changed: {} is new", quoted(take_line(now)));
  return "the scene has changed";
}

}  // namespace

std::string scene_record(std::string_view text) {
  RecordWriter out(RecordKind::kScene);
  if (text.size() <= kLargestText) {
    out.text(text);
    return out.seal();
  }
  out.text({});
  while (!text.empty()) out.number(line_hash(take_line(text)));
  return out.seal();
}

std::string scene_difference(std::string_view recorded, std::string_view now) {
  RecordReader in(recorded);
  const std::string_view text = in.text();
  std::vector<std::uint64_t> lines;
  while (in.ok() && !in.rest().empty()) lines.push_back(in.number<std::uint64_t>());
  if (!in.ok() || now.empty() || (text.empty() && lines.empty())) return "the scene has changed";
  return lines.empty() ? text_difference(text, now) : line_difference(lines, now);
}

}  // namespace rayshade
