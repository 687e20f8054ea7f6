// SPDX-License-Identifier: MIT
// See scanner_state.h.
#include "rayshade/lang/scanner_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <new>

// parser.h first: scanner.h speaks of its types.
#include "parser.h"
#include "rayshade/lang/keywords.h"
#define YYSTYPE rayshade::lang::SemanticValue
#define YYLTYPE rayshade::lang::GrammarSpan
#include "scanner.h"

namespace rayshade::lang {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Whether a decimal number that no double can hold is too large, rather than too small. `text` has the form
/// NUMBER.
bool too_large(std::string_view text) {
  const std::size_t e = std::min(text.find_first_of("eE"), text.size());
  const std::string_view digits = text.substr(0, e);
  const std::size_t first = digits.find_first_of("123456789");
  if (first == std::string_view::npos) return false;
  const auto dot = static_cast<std::int64_t>(std::min(digits.find('.'), digits.size()));
  std::int64_t magnitude = dot - static_cast<std::int64_t>(first);
  if (e < text.size()) {
    const bool negative = text[e + 1] == '-';
    std::int64_t exponent = 0;
    for (const char c : text.substr(e + 1)) {
      if (is_digit(c)) exponent = std::min<std::int64_t>(exponent * 10 + (c - '0'), std::int64_t{1} << 40);
    }
    magnitude += negative ? -exponent : exponent;
  }
  return magnitude > 0;
}

}  // namespace

Scanner::Scanner(std::string& text, SourceMap& sources, Messages& messages)
    : base_(text.data()), sources_(sources), messages_(messages) {
  if (rayshade_lang_flex_lex_init_extra(this, &flex_) != 0) throw std::bad_alloc();
  if (!rayshade_lang_flex__scan_buffer(text.data(), text.size(), flex_)) throw std::bad_alloc();
}

Scanner::~Scanner() { rayshade_lang_flex_lex_destroy(flex_); }

int Scanner::next(SemanticValue* value, GrammarSpan* span) {
  if (messages_.stopped()) return TOKEN_END_OF_FILE;
  previous_word_ = word_;
  word_ = {};
  const int token = rayshade_lang_flex_lex(value, span, flex_);
  return messages_.stopped() ? TOKEN_END_OF_FILE : token;
}

int Scanner::number(SemanticValue* value, const Span& span) {
  const std::string_view digits = text(span);
  double number = 0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (code != std::errc()) {
    number = 0;
    if (too_large(digits)) {
      messages_.error(span, "this number is too large");
      number = 1;
    }
  }
  value->number = number;
  return TOKEN_FLOAT;
}

int Scanner::word(SemanticValue* value, const Span& span) {
  const std::string_view letters = text(span);
  if (const int token = keyword_token(letters)) return token;
  word_ = letters;
  value->name = {letters.data(), letters.size()};
  return TOKEN_WORD;
}

int Scanner::name(SemanticValue* value, const Span& span, int token) {
  std::string_view path = text(span);
  if (token == TOKEN_QUOTED) path = path.substr(1, path.size() - 2);
  value->name = {path.data(), path.size()};
  return token;
}

int Scanner::parenthesis(char which, const Span& span) {
  if (which == '(') {
    if (++parentheses_ > kMostParentheses) {
      messages_.error(span, fmt::format("more than {} parentheses are open", kMostParentheses));
      messages_.stop();
    }
  } else if (parentheses_ > 0) {
    --parentheses_;
  }
  return which;
}

void Scanner::unclosed_comment(const Span& span) {
  messages_.error(span, "this comment is never closed");
  messages_.stop();
}

void Scanner::marker_line(const Span& span) {
  LineMarker marker;
  if (parse_line_marker(text(span), &marker)) {
    std::optional<std::string> name;
    if (marker.named) name = marker.name;
    sources_.add_marker(0, span.end, marker.line, std::move(name));
    return;
  }
  Span line = span;
  while (line.end > line.begin + 1 && (base_[line.end - 1] == '\n' || base_[line.end - 1] == '\r'))
    --line.end;
  messages_.error(line,
                  "a line that begins with '#' must be a line marker when the scene is not preprocessed");
}

bool parse_line_marker(std::string_view text, LineMarker* marker) {
  std::size_t at = 1;
  const auto skip_blanks = [&] {
    while (at < text.size() && (text[at] == ' ' || text[at] == '\t')) ++at;
  };
  skip_blanks();
  if (text.substr(at, 4) == "line") {
    at += 4;
    skip_blanks();
  }
  if (at >= text.size() || !is_digit(text[at])) return false;
  std::uint64_t line = 0;
  for (; at < text.size() && is_digit(text[at]); ++at) {
    line = std::min<std::uint64_t>(line * 10 + static_cast<std::uint64_t>(text[at] - '0'), 0xffffffffu);
  }
  marker->line = static_cast<std::uint32_t>(line);
  skip_blanks();
  marker->named = at < text.size() && text[at] == '"';
  if (marker->named) {
    const std::size_t end = std::min(text.find('"', at + 1), text.size());
    marker->name = std::string(text.substr(at + 1, end - at - 1));
  }
  return true;
}

}  // namespace rayshade::lang
