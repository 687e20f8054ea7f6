// SPDX-License-Identifier: MIT
// A message to whoever wrote the scene: what is wrong, where, the line itself, and where it helps a
// suggestion.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rayshade/scene/location.h"

namespace rayshade {

/// kNote explains the message before it; kAdvice is silenced by -q.
enum class Severity : std::uint8_t { kNote, kAdvice, kWarning, kError };

struct Diagnostic {
  /// A line that includes the file of the message, innermost first.
  struct Inclusion {
    std::string file;
    std::uint32_t line = 0;
  };

  Severity severity = Severity::kError;
  Location location;        ///< line 0: the message is about the file as a whole
  std::string file;         ///< the name that `location` stands for
  std::string text;         ///< without place and severity
  std::string source_line;  ///< the line of text, empty where there is none; long lines are cut to a window
  std::uint32_t caret_begin = 0, caret_end = 0;  ///< bytes [begin, end) of source_line
  std::vector<Inclusion> included_from;
  std::string suggestion;  ///< "did you mean 'sphere'?", or empty
};

/// "file:line:column: error: text", then the source line, carets below it, the suggestion; before all that
/// the chain of inclusions. Ends with a newline. `color` adds terminal colours.
std::string format_diagnostic(const Diagnostic& diagnostic, bool color);

}  // namespace rayshade
