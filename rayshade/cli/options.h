// SPDX-License-Identifier: MIT
// The options of the program: one table, from which come parsing, --help, the OPTIONS section of the manual
// page and the completion of the shell. Every letter of Rayshade 4.0 keeps its meaning (language.md 6).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "rayshade/render/renderer.h"
#include "rayshade/scene/settings.h"

namespace rayshade {

enum class Action : std::uint8_t {
  kRender,
  kCheck,
  kDumpScene,
  kExplain,
  kHelp,
  kVersion,
  kManOptions,
  kCompletion
};
enum class Preprocess : std::uint8_t { kAuto, kAlways, kNever };
struct Options {
  Action action = Action::kRender;
  std::string input;  ///< empty: standard input
  SettingsOverrides settings;
  std::optional<std::string> output;  ///< "-": standard output
  std::optional<std::string> format;
  double gamma = 1;
  bool srgb = false;
  bool alpha = true;  ///< -a toggles
  bool exponential = false;
  bool sample_map = false;
  bool resume = false;       ///< -c
  bool shadow_cache = true;  ///< -s; accepted, changes nothing
  Preprocess preprocess = Preprocess::kAuto;
  std::optional<std::string> preprocessor_arguments;
  bool quiet = false, verbose = false;
  std::optional<int> report_frequency;
  std::optional<std::string> report_file;
  int threads = 0;  ///< 0: what the process may use
  int block = 0;    ///< side of a block; 0: chosen
  IntersectorKind intersector = IntersectorKind::kFas;
  std::optional<std::string> stats_file, cost_map, layers, fas_dump;
  std::uint64_t fas_memory = 0;  ///< bytes; 0: a quarter of what the process may use
  fas::Split fas_split = fas::Split::kAdaptive;
  double verify = 0;                          ///< share of queries that brute force is asked again
  std::optional<std::uint64_t> memory_limit;  ///< bytes; unset: what the machine has
  int explain_x = 0, explain_y = 0;
};

/// Wrong usage: exit code 2 and one line.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One row of the table.
struct OptionSpec {
  char letter;                      ///< 0: has no letter
  const char* name;                 ///< long name without dashes
  std::vector<const char*> values;  ///< placeholders, one per value
  const char* group;                ///< heading in --help and the manual
  const char* help;                 ///< one sentence or two, plain text
  std::function<void(Options&, std::span<const std::string>)> apply;
  std::vector<const char*> choices = {};  ///< completion of the first value; "FILE" names stand for files
};

const std::vector<OptionSpec>& option_table();

/// Reads the command line left to right. Throws UsageError. An action that ends the run at once (--help,
/// --version) stops the reading.
Options parse_options(std::span<const std::string> arguments);

std::string usage_line();
std::string help_text();
/// The OPTIONS section of rayshade(1) in man(7).
std::string man_options();
/// A bash completion script.
std::string bash_completion();

/// A whole decimal integer or real; throws UsageError naming the option where it is none or out of range.
int parse_int(const std::string& text, const std::string& option, int lowest, int highest);
double parse_real(const std::string& text, const std::string& option);
/// A share from 0 to 1, written so or as a percentage with %.
double parse_share(const std::string& text, const std::string& option);
/// Bytes with an optional suffix K, M, G or T (powers of 1024).
std::uint64_t parse_bytes(const std::string& text, const std::string& option);

}  // namespace rayshade
