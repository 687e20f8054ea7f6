// SPDX-License-Identifier: MIT
// From bytes of the scanned text back to file, line and column. Without preprocessing the scanned text is the
// one source; the preprocessor describes its output in segments, each either a verbatim piece of a source or
// the expansion of one macro call. Line markers and #line change the name and number that people see, not the
// text that is shown.
//
// Invariants: segments are appended in the order of the output; a source is one inclusion of a file, so that
// every place knows its chain of inclusions; line tables grow only as far as somebody asked.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "rayshade/lang/span.h"
#include "rayshade/scene/location.h"
#include "rayshade/scene/provider.h"

namespace rayshade::lang {

class SourceMap {
 public:
  /// `file_names` receives every name that a Location may index (Scene::file_names); it is emptied first.
  explicit SourceMap(std::vector<std::string>& file_names) : file_names_(file_names) { file_names_.clear(); }

  /// Adds a source shown as `name`; gives its number. The text is set by set_text or keep.
  std::uint32_t add_source(const std::string& name, std::optional<Place> included_from = std::nullopt);
  /// The text of a source; the caller keeps it alive and unchanged.
  void set_text(std::uint32_t source, std::string_view text) { sources_[source].text = text; }
  /// The text of a source, kept alive here.
  void keep(std::uint32_t source, Bytes bytes);
  std::string_view text(std::uint32_t source) const { return sources_[source].text; }

  /// The output from `out` on is the text of `source` from `begin` on.
  void add_verbatim(std::uint64_t out, std::uint32_t source, std::uint64_t begin);
  /// The output from `out` on was made from the macro call at `place`.
  void add_expansion(std::uint64_t out, const Place& place);

  /// From the byte `offset` of a source on lines count from `line`, and the name is `name` if one is given;
  /// an empty name is standard input.
  void add_marker(std::uint32_t source, std::uint64_t offset, std::uint32_t line,
                  std::optional<std::string> name);

  Place place(const Span& span) const;
  Location locate(const Place& place);
  Location locate(const Span& span) { return locate(place(span)); }
  const std::string& file_name(const Location& where) const { return file_names_[where.file]; }
  /// The line of text that holds the place, without its end, and the column (from 0) where the place begins.
  std::string_view line_text(const Place& place, std::uint64_t* column);
  /// Where a source was included; nothing for the first one.
  const std::optional<Place>& included_from(std::uint32_t source) const {
    return sources_[source].included_from;
  }

 private:
  struct Marker {
    std::uint64_t offset;
    std::uint64_t physical_line;
    std::uint32_t line;
    std::uint16_t file;
  };
  struct Source {
    std::string_view text;
    Bytes kept;
    std::uint16_t file = 0;
    std::optional<Place> included_from;
    std::vector<std::uint64_t> line_starts{0};
    std::uint64_t scanned = 0;  ///< newlines before this byte are in line_starts
    std::uint64_t cursor = 0;   ///< the line that was asked for last
    std::vector<Marker> markers;
  };
  struct Segment {
    std::uint64_t out;
    std::uint64_t begin;
    std::uint32_t source;
    std::uint32_t length;  ///< of the macro call; 0 for verbatim text
  };

  std::uint16_t intern(const std::string& name);
  std::uint64_t line_index(Source& source, std::uint64_t offset);

  std::vector<std::string>& file_names_;
  std::unordered_map<std::string, std::uint16_t> file_numbers_;
  std::deque<Source> sources_;
  std::vector<Segment> segments_;
};

}  // namespace rayshade::lang
