// SPDX-License-Identifier: MIT
// See diagnostic.h.
#include "rayshade/lang/diagnostic.h"

#include <fmt/format.h>

#include <algorithm>

namespace rayshade {
namespace {

struct Style {
  const char* word;
  const char* color;
};

Style style_of(Severity severity) {
  switch (severity) {
    case Severity::kNote:
      return {"note", "\033[1;36m"};
    case Severity::kAdvice:
      return {"advice", "\033[1;34m"};
    case Severity::kWarning:
      return {"warning", "\033[1;35m"};
    case Severity::kError:
      break;
  }
  return {"error", "\033[1;31m"};
}

/// Control characters would confuse the terminal (or command it): each becomes one '?', tabs one blank.
std::string printable(std::string_view text) {
  std::string out(text);
  for (char& c : out) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\t') c = ' ';
    if (byte < 0x20 || byte == 0x7f) c = c == ' ' ? ' ' : '?';
  }
  return out;
}

/// Columns of a terminal taken by UTF-8 text: continuation bytes take none.
std::size_t width(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

}  // namespace

std::string format_diagnostic(const Diagnostic& d, bool color) {
  const Style style = style_of(d.severity);
  const char* bold = color ? "\033[1m" : "";
  const char* tint = color ? style.color : "";
  const char* plain = color ? "\033[0m" : "";
  std::string out;
  for (const Diagnostic::Inclusion& i : d.included_from) {
    out += fmt::format("included from {}:{}:\n", printable(i.file), i.line);
  }
  std::string where = printable(d.file);
  if (d.location.line != 0) where += fmt::format(":{}:{}", d.location.line, d.location.column);
  if (!where.empty()) where += ": ";
  out += fmt::format("{}{}{}{}: {}{}{}{}\n", bold, where, tint, style.word, plain, bold, printable(d.text),
                     plain);
  if (!d.source_line.empty()) {
    const std::string line = printable(d.source_line);
    const std::size_t begin = std::min<std::size_t>(d.caret_begin, line.size());
    const std::size_t end = std::clamp<std::size_t>(d.caret_end, begin, line.size());
    const std::size_t marks =
        std::max<std::size_t>(width(std::string_view(line).substr(begin, end - begin)), 1);
    out += fmt::format("  {}\n  {}{}^{}{}\n", line,
                       std::string(width(std::string_view(line).substr(0, begin)), ' '), tint,
                       std::string(marks - 1, '~'), plain);
  }
  if (!d.suggestion.empty()) out += fmt::format("  {}\n", printable(d.suggestion));
  return out;
}

}  // namespace rayshade
