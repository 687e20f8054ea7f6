// SPDX-License-Identifier: MIT
// See builder.h.
#include "rayshade/lang/builder.h"

#include <fmt/format.h>

#include <algorithm>

#include "rayshade/lang/expected.h"
#include "rayshade/lang/keywords.h"
#include "rayshade/lang/scanner_state.h"
#include "rayshade/lang/suggest.h"

namespace rayshade::lang {
namespace {

/// The token that is wrong, in words.
std::string describe_token(std::string_view token, std::string_view text) {
  if (token == "end of file") return std::string(token);
  if (token == "a number") return fmt::format("number {}", text);
  if (token != "a character") return fmt::format("'{}'", text);
  const auto byte = static_cast<unsigned char>(text.empty() ? 0 : text.front());
  if (text.size() > 1) return fmt::format("path '{}', which does not end in a name", text);
  if (byte >= 0x20 && byte < 0x7f) return fmt::format("character '{}'", text);
  return fmt::format("byte 0x{:02x}", byte);
}

}  // namespace

void SceneBuilder::recover() {
  lights.recover();
  surfaces.recover();
  transforms.recover();
  textures.recover();
  shapes.recover();
  objects.recover();
}

void SceneBuilder::syntax_error(const Span& span, std::string_view token,
                                const std::vector<std::string_view>& expected, Scanner& scanner) {
  Messages& messages = context_.messages;
  if (messages.stopped()) return;
  const auto open = objects.innermost();
  const std::string_view word = scanner.text(span);
  if (token == "end" && !open) {
    messages.error(span, "this 'end' closes nothing: no list, grid or CSG object is open");
  } else if (token == "end of file" && open) {
    messages.error(span, fmt::format("end of file, but this '{}' has no 'end' yet", open->keyword));
    messages.note(open->span, fmt::format("the '{}' begins here", open->keyword));
  } else {
    const std::string wanted = describe_expected(expected, open.has_value());
    std::string text = "unexpected " + describe_token(token, word.substr(0, 80));
    if (!wanted.empty()) text += "; expected " + wanted;
    messages.error(span, std::move(text), syntax_suggestion(token, word, expected, scanner));
  }
  scanner.leave_parentheses();
}

std::string SceneBuilder::syntax_suggestion(std::string_view token, std::string_view word,
                                            const std::vector<std::string_view>& expected,
                                            const Scanner& scanner) const {
  const auto is_expected = [&](std::string_view name) {
    return std::find(expected.begin(), expected.end(), name) != expected.end();
  };
  // A misspelt keyword: first among those that would be right here, then among all.
  const auto nearest = [&](std::string_view wrong) {
    Suggestion likely(wrong), any(wrong);
    for (const Keyword& keyword : keywords()) {
      if (is_expected(keyword.name)) likely.offer(keyword.name);
      any.offer(keyword.name);
    }
    return likely.found() ? likely : any;
  };
  if (token == "a name") {
    if (is_expected("a number") && expressions.defined(word)) {
      return fmt::format("a symbol needs parentheses here: ({})", word);
    }
    const Suggestion suggestion = nearest(word);
    if (suggestion.found()) return suggestion.text();
  }
  if (token == "a file name" && scanner.parentheses() > 0) {
    return "'/' between names makes a file name: for a division write blanks around it";
  }
  // A misspelt keyword where a name is possible is taken for the name, and only the next word is wrong.
  if (!scanner.previous_word().empty()) {
    const Suggestion suggestion = nearest(scanner.previous_word());
    if (suggestion.found())
      return fmt::format("in place of '{}' {}", scanner.previous_word(), suggestion.text());
  }
  return {};
}

void SceneBuilder::exhausted(const Span& span) {
  context_.messages.error(span, "the scene is nested too deeply here");
  context_.messages.stop();
}

}  // namespace rayshade::lang
