// SPDX-License-Identifier: MIT
// The options of the programs: one table, from which come parsing, --help, the OPTIONS section of the manual
// page and the completion of the shell. Every letter of Rayshade 4.0 keeps its meaning (language.md 6).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "rayshade/cli/cluster_options.h"
#include "rayshade/lang/parse.h"
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
/// The program of one machine, and that of a cluster, which has all its options and some more.
enum class Program : std::uint8_t { kRayshade, kPafas };
const char* program_name(Program program);

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
  bool resume = false;  ///< -c
  bool no_journal = false, partial = false;
  double partial_interval = 30;  ///< seconds
  bool shadow_cache = true;      ///< -s; accepted, changes nothing
  Preprocess preprocess = Preprocess::kAuto;
  std::optional<std::string> preprocessor_arguments;
  bool quiet = false, verbose = false;
  std::optional<int> report_frequency;
  std::optional<std::string> report_file;
  int threads = 0;  ///< 0: what the process may use
  int block = 0;    ///< side of a block; 0: chosen
  IntersectorKind intersector = IntersectorKind::kFas;
  std::optional<std::string> stats_file, cost_map, layers, fas_dump, block_costs;
  std::uint64_t fas_memory = 0;  ///< bytes; 0: a quarter of what the process may use
  fas::Split fas_split = fas::Split::kAdaptive;
  double verify = 0;                          ///< share of queries that brute force is asked again
  std::optional<std::uint64_t> memory_limit;  ///< bytes; unset: what the machine has
  int explain_x = 0, explain_y = 0;
  ClusterOptions cluster;

  /// The name by which the scene is read: "-" is standard input.
  std::string scene() const { return input.empty() ? "-" : input; }
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

const std::vector<OptionSpec>& option_table(Program program = Program::kRayshade);

/// Those that only the program for a cluster has.
std::vector<OptionSpec> cluster_option_table();

/// Reads the command line left to right. Throws UsageError. An action that ends the run at once (--help,
/// --version) stops the reading.
Options parse_options(std::span<const std::string> arguments, Program program = Program::kRayshade);

/// What they say to the parser of scenes.
ParseOptions parsing_options(const Options& options);
/// What they say to the renderer; `share`: processes of this job on this machine, by which threads and memory
/// are divided.
RenderOptions rendering_options(const Options& options, int share);

std::string usage_line(Program program = Program::kRayshade);
std::string help_text(Program program = Program::kRayshade);
/// The OPTIONS section of rayshade(1) in man(7).
std::string man_options(Program program = Program::kRayshade);
/// A bash completion script.
std::string bash_completion(Program program = Program::kRayshade);

/// A whole decimal integer or real; throws UsageError naming the option where it is none or out of range.
int parse_int(const std::string& text, const std::string& option, int lowest, int highest);
double parse_real(const std::string& text, const std::string& option);
/// A share from 0 to 1, written so or as a percentage with %.
double parse_share(const std::string& text, const std::string& option);
/// Bytes with an optional suffix K, M, G or T (powers of 1024).
std::uint64_t parse_bytes(const std::string& text, const std::string& option);

}  // namespace rayshade
