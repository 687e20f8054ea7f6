// SPDX-License-Identifier: MIT
// The reserved words of language.md 1.4: one table for the scanner, for suggestions and for the tests.
#pragma once

#include <span>
#include <string_view>

namespace rayshade::lang {

struct Keyword {
  std::string_view name;
  int token;  ///< of the grammar; synonyms share it
};

/// All 108 spellings, sorted.
std::span<const Keyword> keywords();

/// The token of a keyword, or 0 for any other word. Called for every word of a scene.
int keyword_token(std::string_view word);

}  // namespace rayshade::lang
