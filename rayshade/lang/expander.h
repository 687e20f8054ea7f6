// SPDX-License-Identifier: MIT
// Macro expansion over text, in the manner of C: arguments are expanded first, the result is scanned again
// together with the text that follows, and a macro is never expanded inside its own expansion. Unlike C no
// blanks appear around an expansion, because scene words and paths are glued together from macros; one is put
// only where a new number would arise.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "rayshade/lang/macro.h"

namespace rayshade::lang {

/// Bytes that all expansions of a run may copy. Beyond it a scene is a bomb, not a model.
inline constexpr std::uint64_t kMostExpandedBytes = std::uint64_t{256} << 20;
/// Levels of macro calls inside arguments of macro calls.
inline constexpr int kMostArgumentLevels = 200;

/// Thrown where an expansion cannot go on; what() is for the user.
struct ExpansionError : std::runtime_error {
  ExpansionError(const std::string& what, bool is_fatal) : std::runtime_error(what), fatal(is_fatal) {}
  bool fatal;
};

class Expander {
 public:
  explicit Expander(MacroTable& macros) : macros_(macros) {}

  /// The macro that a name stands for, or nullptr.
  Macro* find(std::string_view name);
  /// Told to the table's filter whenever a macro is defined.
  void add_name(std::string_view name);

  /// Values of __LINE__ and __FILE__ for the expansions that follow.
  void set_position(std::uint32_t line, const std::string& file) {
    line_ = line;
    file_ = &file;
  }

  /// Expands the call of a macro whose name starts at `begin` of `text`, appends what comes of it to `out`
  /// and gives the offset behind the call (behind the closing parenthesis of the last arguments that were
  /// used). Throws ExpansionError.
  std::size_t expand_call(std::string_view text, std::size_t begin, std::string* out);
  /// A whole text, expanded.
  std::string expand_all(std::string_view text);

  /// Appends `text` to `out`, with a blank between them if they would make one number of two tokens.
  static void append_apart(std::string* out, std::string_view text);

 private:
  struct Frame {
    std::string owned;
    std::string_view text;
    std::size_t at = 0;
    Macro* macro = nullptr;
  };
  using Frames = std::vector<Frame>;

  std::size_t run(Frames& frames, std::string* out, bool whole);
  void identifier(Frames& frames, std::string* out);
  bool find_arguments(Frames& frames, std::size_t* frame, std::size_t* at) const;
  std::vector<std::string> read_arguments(Frames& frames, const Macro& macro, std::string_view name);
  std::string substitute(const Macro& macro, const std::vector<std::string>& arguments);
  void push(Frames& frames, Macro* macro, std::string text);
  void spend(std::uint64_t bytes);
  static void pop(Frames& frames);

  MacroTable& macros_;
  bool filter_[256] = {};  ///< first letters of all names ever defined
  std::uint64_t spent_ = 0;
  int levels_ = 0;
  std::uint32_t line_ = 0;
  const std::string* file_ = nullptr;
};

/// Marks the identifier that follows as one that must not be expanded any more. Never part of a text.
inline constexpr char kPainted = '\x01';

/// Skips blanks, line ends and comments of both kinds.
std::size_t skip_blanks_and_comments(std::string_view text, std::size_t at);
/// The end of the line of a comment that starts with //: preprocessed scenes have these too, but not between
/// quotes.
std::size_t line_comment_end(std::string_view text, std::size_t at);

}  // namespace rayshade::lang
