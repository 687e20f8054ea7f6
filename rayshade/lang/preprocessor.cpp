// SPDX-License-Identifier: MIT
// See preprocessor.h. This file turns lines into output; directives.cpp does what the directives say.
#include "rayshade/lang/preprocessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "rayshade/lang/scanner_state.h"

namespace rayshade::lang {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

/// The length of a backslash and the line end behind it at `at`, or 0.
std::size_t splice_length(std::string_view text, std::size_t at) {
  if (text.substr(at, 2) == "\\\n") return 2;
  return text.substr(at, 3) == "\\\r\n" ? 3 : 0;
}

/// What ends a run of text that is copied as it is. \x01 is in it because the expander uses it as a mark.
struct Stops {
  bool is[256] = {};
  Stops() {
    for (int c = 0; c < 256; ++c) {
      const char letter = static_cast<char>(c);
      is[c] = is_identifier_start(letter) || (c >= '0' && c <= '9') || c == '.' || c == '/' || c == '\n' ||
              c == '\\' || c == '"' || letter == kPainted;
    }
  }
};
const Stops kStops;

}  // namespace

bool has_directive(std::string_view text) {
  for (std::size_t at = text.find('#'); at != std::string_view::npos; at = text.find('#', at + 1)) {
    std::size_t start = at;
    while (start > 0 && is_blank(text[start - 1])) --start;
    if (start > 0 && text[start - 1] != '\n') {
      // Not the first on its line: neither is any other one of that line.
      at = std::min(text.find('\n', at), text.size() - 1);
      continue;
    }
    LineMarker marker;
    const std::string_view line = text.substr(at, std::min(text.find('\n', at), text.size()) - at);
    if (start != at || !parse_line_marker(line, &marker)) return true;
    at = std::min(at + line.size(), text.size() - 1);
  }
  return false;
}

Preprocessor::Preprocessor(Provider& provider, SourceMap& sources, Messages& messages)
    : provider_(provider), sources_(sources), messages_(messages), expander_(macros_) {
  macros_["__LINE__"].kind = Macro::Kind::kLine;
  macros_["__FILE__"].kind = Macro::Kind::kFile;
  expander_.add_name("__LINE__");
}

std::string Preprocessor::run(const std::string& name) {
  out_.reserve(sources_.text(0).size() + 2);
  process(0, name);
  return std::move(out_);
}

void Preprocessor::process(std::uint32_t source, const std::string& name) {
  File file;
  file.source = source;
  const std::size_t slash = name.rfind('/');
  if (slash != std::string::npos) file.directory = name.substr(0, slash + 1);
  file.text = sources_.text(source);
  while (file.at < file.text.size() && !messages_.stopped()) {
    // A directive may be indented; comments in front of it are not looked for.
    std::size_t first = file.at;
    while (first < file.text.size() && is_blank(file.text[first])) ++first;
    if (first < file.text.size() && file.text[first] == '#') {
      file.at = first;
      directive(file);
    } else if (file.live()) {
      text_line(file);
    } else {
      skip_line(file);
    }
  }
  if (!messages_.stopped() && !file.conditionals.empty()) {
    messages_.error(file.conditionals.back().place, "this condition has no '#endif'");
  }
}

/// Copies [at, end) to the output.
void Preprocessor::copy(File& file, std::size_t end) {
  if (end == file.at) return;
  const std::string_view piece = file.text.substr(file.at, end - file.at);
  if (after_expansion_) {
    const std::size_t before = out_.size();
    Expander::append_apart(&out_, piece);
    sources_.add_verbatim(before + (out_.size() - before - piece.size()), file.source, file.at);
    after_expansion_ = false;
  } else {
    sources_.add_verbatim(out_.size(), file.source, file.at);
    out_ += piece;
  }
  file.at = end;
}

/// One line that is no directive; comments and calls of macros may draw in the lines after it.
void Preprocessor::text_line(File& file) {
  const std::string_view text = file.text;
  std::size_t at = file.at;
  bool quoted = false;
  while (at < text.size() && !messages_.stopped()) {
    const char c = text[at];
    if (!kStops.is[static_cast<unsigned char>(c)]) {
      ++at;
      continue;
    }
    if (c == '\n') {
      copy(file, at + 1);
      return;
    }
    if (is_identifier_start(c)) {
      const std::size_t length = identifier_length(text.substr(at));
      if (expander_.find(text.substr(at, length))) {
        copy(file, at);
        macro_call(file, length);
        at = file.at;
      } else {
        at += length;
      }
    } else if (const std::size_t number = number_length(text.substr(at))) {
      at += number;
    } else if (c == '"') {
      quoted = !quoted;
      ++at;
    } else if (c == '/' && text.substr(at, 2) == "/*") {
      copy(file, at);
      comment(file);
      at = file.at;
    } else if (c == '/' && !quoted && text.substr(at, 2) == "//") {
      copy(file, at);
      file.at = at = line_comment_end(text, at);
    } else if (const std::size_t splice = splice_length(text, at)) {
      copy(file, at);
      file.at = at += splice;
    } else if (c == kPainted) {
      messages_.error(Place{file.source, at, at + 1}, "unexpected byte 0x01");
      copy(file, at);
      file.at = ++at;
    } else {
      ++at;
    }
  }
  copy(file, at);
}

void Preprocessor::comment(File& file) {
  const std::size_t end = file.text.find("*/", file.at + 2);
  if (end == std::string_view::npos) {
    messages_.error(Place{file.source, file.at, file.at + 2}, "this comment is never closed");
    messages_.stop();
    file.at = file.text.size();
    return;
  }
  sources_.add_verbatim(out_.size(), file.source, file.at);
  out_ += ' ';
  after_expansion_ = false;
  file.at = end + 2;
}

void Preprocessor::set_position(const Place& place) {
  const Location where = sources_.locate(place);
  expander_.set_position(where.line, sources_.file_name(where));
}

void Preprocessor::macro_call(File& file, std::size_t length) {
  Place place{file.source, file.at, file.at + length};
  set_position(place);
  try {
    std::string expansion;
    const std::size_t end = expander_.expand_call(file.text, file.at, &expansion);
    const std::size_t before = out_.size();
    Expander::append_apart(&out_, expansion);
    if (out_.size() != before) {
      sources_.add_expansion(out_.size() - expansion.size(), place);
      after_expansion_ = true;
    }
    file.at = end;
  } catch (const ExpansionError& error) {
    messages_.error(place, error.what());
    if (error.fatal) messages_.stop();
    file.at += length;
  }
}

/// A line in a branch that does not count: only comments matter, because they can hide what looks like a
/// directive.
void Preprocessor::skip_line(File& file) {
  const std::string_view text = file.text;
  for (;;) {
    const std::size_t end = std::min(text.find('\n', file.at), text.size());
    std::size_t begin = file.at;
    for (bool quoted = false; begin < end; ++begin) {
      if (text[begin] == '"') quoted = !quoted;
      if (text[begin] != '/') continue;
      if (text.substr(begin, 2) == "/*") break;
      if (!quoted && text.substr(begin, 2) == "//") begin = end;
    }
    if (begin >= end) {
      file.at = std::min(end + 1, text.size());
      return;
    }
    const std::size_t close = text.find("*/", begin + 2);
    if (close == std::string_view::npos) {
      messages_.error(Place{file.source, begin, begin + 2}, "this comment is never closed");
      messages_.stop();
      file.at = text.size();
      return;
    }
    file.at = close + 2;
  }
}

/// The directive at the current place: the text behind its `#`, continued lines joined, each comment one
/// blank.
std::string Preprocessor::logical_line(File& file) {
  const std::string_view text = file.text;
  std::string line;
  std::size_t at = file.at + 1;
  bool quoted = false;
  while (at < text.size() && text[at] != '\n') {
    if (const std::size_t splice = splice_length(text, at)) {
      at += splice;
    } else if (text.substr(at, 2) == "/*") {
      const std::size_t close = text.find("*/", at + 2);
      if (close == std::string_view::npos) {
        messages_.error(Place{file.source, at, at + 2}, "this comment is never closed");
        messages_.stop();
        at = text.size();
        break;
      }
      line += ' ';
      at = close + 2;
    } else if (!quoted && text.substr(at, 2) == "//") {
      at = line_comment_end(text, at);
    } else {
      if (text[at] == '"') quoted = !quoted;
      if (text[at] != kPainted) line += text[at];
      ++at;
    }
  }
  file.at = std::min(at + 1, text.size());
  return line;
}

}  // namespace rayshade::lang
