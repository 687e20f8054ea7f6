// SPDX-License-Identifier: MIT
// The scanner of scene text (language.md 1): Flex runs over the text in place, and this class turns what it
// finds into tokens. No token allocates memory; names point into the text, which must outlive the parse.
#pragma once

#include <cstdint>
#include <string>

#include "rayshade/lang/messages.h"
#include "rayshade/lang/semantic.h"
#include "rayshade/lang/source_map.h"
#include "rayshade/lang/span.h"

namespace rayshade::lang {

/// The longest text that Flex can count.
inline constexpr std::size_t kMostScannedBytes = 0x7ffffff0;
/// Levels of parentheses that an expression may open.
inline constexpr int kMostParentheses = 10000;

class Scanner {
 public:
  /// `text` must end in two NUL bytes, which do not belong to it. Flex writes into it while it runs, but
  /// leaves it as it was whenever a token has been returned.
  Scanner(std::string& text, SourceMap& sources, Messages& messages);
  ~Scanner();
  Scanner(const Scanner&) = delete;
  Scanner& operator=(const Scanner&) = delete;

  /// The next token; end of file for good once the messages say that reading should stop.
  int next(SemanticValue* value, GrammarSpan* span);
  /// The text of a span.
  std::string_view text(const Span& span) const { return {base_ + span.begin, span.end - span.begin}; }
  /// The word before the current token, or an empty name where it was something else.
  std::string_view previous_word() const { return previous_word_; }
  /// Inside how many parentheses the scanner is.
  int parentheses() const { return parentheses_; }
  /// Forgets open parentheses, after a mistake.
  void leave_parentheses() { parentheses_ = 0; }

  // The rest is for the actions of scanner.l.

  const char* base() const { return base_; }
  int number(SemanticValue* value, const Span& span);
  int word(SemanticValue* value, const Span& span);
  int name(SemanticValue* value, const Span& span, int token);
  int parenthesis(char which, const Span& span);
  void marker_line(const Span& span);
  void unclosed_comment(const Span& span);

 private:
  const char* base_;
  SourceMap& sources_;
  Messages& messages_;
  void* flex_ = nullptr;
  std::string_view word_, previous_word_;
  int parentheses_ = 0;
};

/// A line marker (language.md 1.6): `#` [`line`] number ["name"] anything. `text` starts at the `#`.
struct LineMarker {
  std::uint32_t line = 0;
  bool named = false;
  std::string name;
};
/// False where the line is something else.
bool parse_line_marker(std::string_view text, LineMarker* marker);

}  // namespace rayshade::lang
