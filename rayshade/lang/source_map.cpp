// SPDX-License-Identifier: MIT
// See source_map.h.
#include "rayshade/lang/source_map.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace rayshade::lang {

std::uint16_t SourceMap::intern(const std::string& name) {
  const auto known = file_numbers_.find(name);
  if (known != file_numbers_.end()) return known->second;
  // Line markers can invent any number of names; the last one is shared by all that do not fit.
  constexpr std::size_t kMost = std::numeric_limits<std::uint16_t>::max();
  if (file_names_.size() > kMost) return static_cast<std::uint16_t>(kMost);
  const auto number = static_cast<std::uint16_t>(file_names_.size());
  file_names_.push_back(name);
  file_numbers_.emplace(name, number);
  return number;
}

std::uint32_t SourceMap::add_source(const std::string& name, std::optional<Place> included_from) {
  Source& source = sources_.emplace_back();
  source.file = intern(name);
  source.included_from = included_from;
  return static_cast<std::uint32_t>(sources_.size() - 1);
}

void SourceMap::keep(std::uint32_t source, Bytes bytes) {
  sources_[source].text = *bytes;
  sources_[source].kept = std::move(bytes);
}

void SourceMap::add_verbatim(std::uint64_t out, std::uint32_t source, std::uint64_t begin) {
  if (!segments_.empty()) {
    const Segment& last = segments_.back();
    if (last.length == 0 && last.source == source && last.begin + (out - last.out) == begin) return;
  }
  segments_.push_back({out, begin, source, 0});
}

void SourceMap::add_expansion(std::uint64_t out, const Place& place) {
  const std::uint64_t length = std::clamp<std::uint64_t>(place.end - place.begin, 1, 0xffffffffu);
  segments_.push_back({out, place.begin, place.source, static_cast<std::uint32_t>(length)});
}

void SourceMap::add_marker(std::uint32_t number, std::uint64_t offset, std::uint32_t line,
                           std::optional<std::string> name) {
  Source& source = sources_[number];
  std::uint16_t file = source.markers.empty() ? source.file : source.markers.back().file;
  if (name) file = intern(name->empty() ? "stdin" : *name);
  source.markers.push_back({offset, line_index(source, offset), line, file});
}

Place SourceMap::place(const Span& span) const {
  if (segments_.empty()) return {0, span.begin, span.end};
  auto after = std::upper_bound(segments_.begin(), segments_.end(), span.begin,
                                [](std::uint64_t offset, const Segment& s) { return offset < s.out; });
  if (after == segments_.begin())
    return {segments_.front().source, segments_.front().begin, segments_.front().begin};
  const Segment& segment = *(after - 1);
  if (segment.length != 0) return {segment.source, segment.begin, segment.begin + segment.length};
  const std::uint64_t begin = segment.begin + (span.begin - segment.out);
  // What lies beyond the segment comes from elsewhere: the range ends with it.
  const std::uint64_t limit = after == segments_.end() ? span.end : std::min(span.end, after->out);
  return {segment.source, begin, begin + (limit - span.begin)};
}

std::uint64_t SourceMap::line_index(Source& source, std::uint64_t offset) {
  // Find the newlines up to the offset, but not beyond: text ahead of the scanner need not be looked at.
  while (source.scanned < offset) {
    const char* from = source.text.data() + source.scanned;
    const std::uint64_t end = std::min<std::uint64_t>(offset, source.text.size());
    if (end <= source.scanned) break;
    const void* newline = std::memchr(from, '\n', end - source.scanned);
    if (!newline) {
      source.scanned = end;
      break;
    }
    source.scanned += static_cast<std::uint64_t>(static_cast<const char*>(newline) - from) + 1;
    source.line_starts.push_back(source.scanned);
  }
  // Questions mostly come in order: try the last line and a few that follow before searching.
  const std::vector<std::uint64_t>& starts = source.line_starts;
  std::uint64_t& line = source.cursor;
  if (line < starts.size() && starts[line] <= offset) {
    for (int step = 0; step < 8; ++step, ++line) {
      if (line + 1 >= starts.size() || starts[line + 1] > offset) return line;
    }
  }
  line =
      static_cast<std::uint64_t>(std::upper_bound(starts.begin(), starts.end(), offset) - starts.begin()) - 1;
  return line;
}

Location SourceMap::locate(const Place& place) {
  if (place.source >= sources_.size()) return {};
  Source& source = sources_[place.source];
  const std::uint64_t line = line_index(source, place.begin);
  const std::uint64_t column = place.begin - source.line_starts[line] + 1;
  Location where;
  where.file = source.file;
  where.column = static_cast<std::uint16_t>(std::min<std::uint64_t>(column, 0xffff));
  std::uint64_t shown = line + 1;
  const auto after =
      std::upper_bound(source.markers.begin(), source.markers.end(), place.begin,
                       [](std::uint64_t offset, const Marker& m) { return offset < m.offset; });
  if (after != source.markers.begin()) {
    const Marker& marker = *(after - 1);
    where.file = marker.file;
    shown = marker.line + (line - marker.physical_line);
  }
  where.line = static_cast<std::uint32_t>(std::min<std::uint64_t>(shown, 0xffffffffu));
  return where;
}

std::string_view SourceMap::line_text(const Place& place, std::uint64_t* column) {
  *column = 0;
  if (place.source >= sources_.size()) return {};
  Source& source = sources_[place.source];
  const std::uint64_t start = source.line_starts[line_index(source, place.begin)];
  *column = place.begin - start;
  const std::string_view rest = source.text.substr(std::min<std::uint64_t>(start, source.text.size()));
  return rest.substr(0, rest.find('\n'));
}

}  // namespace rayshade::lang
