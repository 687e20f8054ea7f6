// SPDX-License-Identifier: MIT
// Macros of the preprocessor: definitions and their table. A body is kept as pieces, so that expanding it is
// copying.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "rayshade/lang/context.h"

namespace rayshade::lang {

struct Macro {
  enum class Kind : std::uint8_t { kDefined, kLine, kFile };  ///< kLine, kFile: __LINE__ and __FILE__
  /// A piece of a body: literal text, or a parameter.
  struct Piece {
    std::string text;     ///< of a literal
    int parameter = -1;   ///< number, or -1 for a literal
    bool quoted = false;  ///< #parameter
    bool pasted = false;  ///< ## stands in front of it: no blank, no expansion of a parameter
    bool raw = false;     ///< ## stands next to it: the argument is not expanded
    bool operator==(const Piece&) const = default;
  };

  Kind kind = Kind::kDefined;
  bool function_like = false;
  bool variadic = false;  ///< the last parameter takes all that is left
  std::vector<std::string> parameters;
  std::vector<Piece> body;
  int active = 0;  ///< how many expansions of it are being scanned; while any is, the name stands for itself
};

using MacroTable = NameMap<Macro>;

/// Parses what follows `#define`, without comments and line ends: `NAME body` or `NAME(parameters) body`.
/// Gives an error text, or an empty string.
std::string parse_macro(std::string_view text, std::string* name, Macro* macro);

bool is_identifier_start(char c);
bool is_identifier_part(char c);
/// The length of a preprocessing number (which hides macro names such as the e5 of 1e5) at the start of
/// `text`, or 0.
std::size_t number_length(std::string_view text);
/// The length of the identifier at the start of `text`, or 0.
std::size_t identifier_length(std::string_view text);
std::string_view trim(std::string_view text);

}  // namespace rayshade::lang
