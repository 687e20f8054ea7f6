// SPDX-License-Identifier: MIT
// The entry of the language layer: the text of a scene becomes a Scene and a list of messages.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rayshade/lang/diagnostic.h"
#include "rayshade/scene/provider.h"
#include "rayshade/scene/scene.h"

namespace rayshade {

/// When the built-in preprocessor runs over the scene (language.md 2).
enum class Preprocessing : std::uint8_t {
  kAuto,    ///< if the scene has a `#` line that is not a line marker
  kAlways,  ///< -P was given
  kNever,   ///< -u was given
};

struct ParseOptions {
  Preprocessing preprocessing = Preprocessing::kAuto;
  std::vector<std::string> preprocessor_arguments;  ///< -D, -U and -I, values glued or following
  bool flip_normals = false;  ///< -f: the normals of smooth triangles are not compared with their face
  int max_errors = 20;        ///< reading stops after that many
  bool verbose = false;       ///< tell about `name` statements (as does `report verbose`)
  bool output_named = false;  ///< -O: every `outfile` is ignored
};

struct ParseResult {
  Scene scene;                          ///< usable only if `ok`
  std::vector<Diagnostic> diagnostics;  ///< in the order of the text
  std::vector<std::string> prints;      ///< what `print` statements write, in order
  std::vector<std::string> notes;       ///< what verbose `name` statements write, in order
  bool ok = false;                      ///< no diagnostic is an error
};

/// Reads the scene `name` ("-" is standard input) and everything it includes through `provider`. Never throws
/// for anything that the text contains.
ParseResult parse_scene(Provider& provider, const std::string& name, const ParseOptions& options = {});

/// Splits the one argument of -P at blanks, without a shell: '...' and "..." keep blanks, a backslash outside
/// '...' keeps the next character. An unclosed quote reaches to the end.
std::vector<std::string> split_arguments(std::string_view text);

}  // namespace rayshade
