// SPDX-License-Identifier: MIT
// The built-in preprocessor (language.md 2): #include, #define, #undef, #if and its kin, #line, #error and
// #warning, continued lines, comments. It reads through the provider, predefines nothing but __LINE__ and
// __FILE__, and describes every byte of its output to the source map, so that messages point into the file
// that somebody wrote.
//
// Limits keep hostile scenes from eating the machine: levels and number of inclusions, bytes read, bytes
// expanded.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "rayshade/lang/expander.h"
#include "rayshade/lang/messages.h"
#include "rayshade/lang/source_map.h"
#include "rayshade/scene/provider.h"

namespace rayshade::lang {

inline constexpr int kMostInclusionLevels = 200;
inline constexpr int kMostInclusions = 10000;
/// Bytes of all included files together, counted as often as they are included.
inline constexpr std::uint64_t kMostIncludedBytes = std::uint64_t{1} << 30;

/// Whether a text has a directive: a line whose first character besides blanks is `#` and that is no line
/// marker.
bool has_directive(std::string_view text);

class Preprocessor {
 public:
  Preprocessor(Provider& provider, SourceMap& sources, Messages& messages);

  /// Takes -D, -U and -I; reports what it does not know.
  void set_arguments(const std::vector<std::string>& arguments);
  /// The output for source 0, whose text is set and whose name is `name`.
  std::string run(const std::string& name);

 private:
  /// One #if ... #endif in a file.
  struct Conditional {
    Place place;
    bool outer_live;  ///< the lines around it count
    bool live;        ///< the lines of this branch count
    bool taken;       ///< a branch was live already
    bool else_seen = false;
  };
  /// A file being read.
  struct File {
    std::uint32_t source;
    std::string directory;  ///< with its slash, or empty
    std::string_view text;
    std::size_t at = 0;
    std::vector<Conditional> conditionals;
    bool live() const { return conditionals.empty() || conditionals.back().live; }
  };

  void process(std::uint32_t source, const std::string& name);
  void text_line(File& file);
  void copy(File& file, std::size_t end);
  void skip_line(File& file);
  void comment(File& file);
  void macro_call(File& file, std::size_t length);
  std::string logical_line(File& file);

  void directive(File& file);
  void conditional(File& file, const Place& place, std::string_view word, std::string_view rest);
  bool condition(const Place& place, std::string_view text);
  void define(const Place& place, std::string_view text);
  void undefine(const Place& place, std::string_view text);
  void include(File& file, const Place& place, std::string_view text);
  void line(File& file, const Place& place, std::string_view text);
  void include_file(File& file, const Place& place, const std::string& target, bool quoted);
  void predefine(const std::string& definition);
  std::string expand(const Place& place, std::string_view text);
  void set_position(const Place& place);

  Provider& provider_;
  SourceMap& sources_;
  Messages& messages_;
  MacroTable macros_;
  Expander expander_;
  std::vector<std::string> include_directories_;
  std::string out_;
  bool after_expansion_ = false;
  int level_ = 0;
  int inclusions_ = 0;
  std::uint64_t included_bytes_ = 0;
};

}  // namespace rayshade::lang
