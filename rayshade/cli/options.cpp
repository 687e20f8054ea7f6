// SPDX-License-Identifier: MIT
#include "rayshade/cli/options.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace rayshade {
namespace {

const OptionSpec* find_letter(Program program, char letter) {
  for (const OptionSpec& spec : option_table(program)) {
    if (spec.letter == letter) return &spec;
  }
  return nullptr;
}

const OptionSpec* find_name(Program program, const std::string& name) {
  for (const OptionSpec& spec : option_table(program)) {
    if (spec.name == name) return &spec;
  }
  return nullptr;
}

bool ends_run(Action action) {
  return action == Action::kHelp || action == Action::kVersion || action == Action::kManOptions ||
         action == Action::kCompletion;
}

std::string placeholders(const OptionSpec& spec) {
  std::string out;
  for (const char* value : spec.values) out += fmt::format(" {}", value);
  return out;
}

/// Breaks `text` into lines of at most `width` characters.
std::vector<std::string> wrapped(const std::string& text, std::size_t width) {
  std::vector<std::string> lines(1);
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (!lines.back().empty() && lines.back().size() + 1 + word.size() > width) lines.emplace_back();
    if (!lines.back().empty()) lines.back() += ' ';
    lines.back() += word;
    at = end + 1;
  }
  return lines;
}

/// Escapes what man(7) would take for markup.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out;
}

/// Options in the order of their groups, as (group, members).
std::vector<std::pair<std::string, std::vector<const OptionSpec*>>> grouped(Program program) {
  std::vector<std::pair<std::string, std::vector<const OptionSpec*>>> groups;
  for (const OptionSpec& spec : option_table(program)) {
    if (groups.empty() || groups.back().first != spec.group) groups.push_back({spec.group, {}});
    groups.back().second.push_back(&spec);
  }
  return groups;
}

}  // namespace

const char* program_name(Program program) { return program == Program::kPafas ? "pafas" : "rayshade"; }

Options parse_options(std::span<const std::string> arguments, Program program) {
  Options options;
  bool only_files = false, have_input = false;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (only_files || argument.empty() || argument[0] != '-') {
      if (have_input)
        throw UsageError(fmt::format("more than one scene: '{}' and '{}'", options.input, argument));
      options.input = argument;
      have_input = true;
      continue;
    }
    if (argument == "--") {
      only_files = true;
      continue;
    }
    const OptionSpec* spec = nullptr;
    std::optional<std::string> attached;
    if (argument.starts_with("--")) {
      const std::size_t equals = argument.find('=');
      spec = find_name(program, argument.substr(2, equals == std::string::npos ? equals : equals - 2));
      if (equals != std::string::npos) attached = argument.substr(equals + 1);
    } else if (argument.size() >= 2) {
      spec = find_letter(program, argument[1]);
      if (spec && argument.size() > 2) {
        throw UsageError(
            fmt::format("'{}': letters are not joined; values follow as words of their own", argument));
      }
    }
    if (!spec) throw UsageError(fmt::format("unknown option '{}'", argument));
    std::vector<std::string> values;
    if (attached) {
      if (spec->values.size() != 1)
        throw UsageError(fmt::format("'{}' takes {} values", argument, spec->values.size()));
      values.push_back(*attached);
    } else {
      if (arguments.size() - i - 1 < spec->values.size()) {
        throw UsageError(fmt::format("option '{}' needs{}", argument, placeholders(*spec)));
      }
      values.assign(arguments.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                    arguments.begin() + static_cast<std::ptrdiff_t>(i + 1 + spec->values.size()));
      i += spec->values.size();
    }
    spec->apply(options, values);
    if (ends_run(options.action)) return options;
  }
  return options;
}

std::string usage_line(Program program) {
  return fmt::format("usage: {} [OPTION...] [SCENE]", program_name(program));
}

std::string help_text(Program program) {
  const bool cluster = program == Program::kPafas;
  std::string out =
      usage_line(program) +
      (cluster
           ? "\n\nRender a Rayshade 4.0 scene (or standard input) to a picture, on all ranks of an MPI job.\n"
           : "\n\nRender a Rayshade 4.0 scene (or standard input) to a picture.\n") +
      "Values follow their option as words of their own; negative numbers are values.\n";
  constexpr std::size_t kIndent = 34, kWidth = 100;
  for (const auto& [group, members] : grouped(program)) {
    out += fmt::format("\n{}:\n", group);
    for (const OptionSpec* spec : members) {
      const std::string head =
          fmt::format("  {}--{}{}", spec->letter ? fmt::format("-{}, ", spec->letter) : "    ", spec->name,
                      placeholders(*spec));
      const std::vector<std::string> lines = wrapped(spec->help, kWidth - kIndent);
      if (head.size() + 2 > kIndent) {
        out += fmt::format("{}\n{:{}}{}\n", head, "", kIndent, lines[0]);
      } else {
        out += fmt::format("{:<{}}{}\n", head, kIndent, lines[0]);
      }
      for (std::size_t i = 1; i < lines.size(); ++i) out += fmt::format("{:{}}{}\n", "", kIndent, lines[i]);
    }
  }
  out +=
      "\nExit status: 0 picture complete, 1 error in the scene or while rendering, 2 wrong usage, 3 stopped "
      "before the\n"
      "end (the partial picture is kept as NAME.partial.EXT). See ";
  out += cluster ? "pafas(1), rayshade(1) and rayshade(5).\n" : "rayshade(1) and rayshade(5).\n";
  return out;
}

std::string man_options(Program program) {
  std::string out;
  for (const auto& [group, members] : grouped(program)) {
    out += fmt::format(".SS {}\n", group);
    for (const OptionSpec* spec : members) {
      out += ".TP\n";
      std::string values;
      for (const char* value : spec->values) values += fmt::format(" \\fI{}\\fR", escaped(value));
      if (spec->letter) out += fmt::format("\\fB\\-{}\\fR{}, ", spec->letter, values);
      out += fmt::format("\\fB\\-\\-{}\\fR{}\n{}\n", escaped(spec->name), values, escaped(spec->help));
    }
  }
  return out;
}

std::string bash_completion(Program program) {
  std::string words, cases;
  for (const OptionSpec& spec : option_table(program)) {
    std::string pattern = fmt::format("--{}", spec.name);
    words += (words.empty() ? "" : " ") + pattern;
    if (spec.letter) {
      words += fmt::format(" -{}", spec.letter);
      pattern += fmt::format("|-{}", spec.letter);
    }
    if (spec.values.empty()) continue;
    std::string action = "COMPREPLY=()";
    if (!spec.choices.empty() && std::string(spec.choices[0]) == "FILE") {
      action = "COMPREPLY=($(compgen -f -- \"$cur\"))";
    } else if (!spec.choices.empty()) {
      std::string choices;
      for (const char* choice : spec.choices) choices += (choices.empty() ? "" : " ") + std::string(choice);
      action = fmt::format("COMPREPLY=($(compgen -W '{}' -- \"$cur\"))", choices);
    }
    cases += fmt::format("    {}) {}; return ;;\n", pattern, action);
  }
  return fmt::format(
      "# bash completion for {0}; made from the program's own table of options\n"
      "_{0}() {{\n"
      "  local cur prev\n"
      "  cur=${{COMP_WORDS[COMP_CWORD]}}\n"
      "  prev=${{COMP_WORDS[COMP_CWORD-1]}}\n"
      "  case $prev in\n{1}  esac\n"
      "  if [[ $cur == -* ]]; then\n"
      "    COMPREPLY=($(compgen -W '{2}' -- \"$cur\"))\n"
      "  else\n"
      "    COMPREPLY=($(compgen -f -X '!*.ray' -- \"$cur\") $(compgen -d -- \"$cur\"))\n"
      "  fi\n"
      "}}\n"
      "complete -o filenames -F _{0} {0}\n",
      program_name(program), cases, words);
}

int parse_int(const std::string& text, const std::string& option, int lowest, int highest) {
  int value = 0;
  const char* first = text.data() + (text.starts_with("+") ? 1 : 0);
  const char* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(first, last, value);
  if (error != std::errc{} || end != last || first == last) {
    throw UsageError(fmt::format("{}: '{}' is not a whole number", option, text));
  }
  if (value < lowest || value > highest) {
    throw UsageError(fmt::format("{}: {} is not within {} to {}", option, value, lowest, highest));
  }
  return value;
}

double parse_real(const std::string& text, const std::string& option) {
  double value = 0;
  const char* first = text.data() + (text.starts_with("+") ? 1 : 0);
  const char* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(first, last, value);
  if (error != std::errc{} || end != last || first == last || !std::isfinite(value)) {
    throw UsageError(fmt::format("{}: '{}' is not a number", option, text));
  }
  return value;
}

double parse_share(const std::string& text, const std::string& option) {
  double value = 0;
  const char* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, value);
  const std::string suffix(end, last);
  if (suffix == "%") value /= 100;
  if (error != std::errc{} || !(suffix.empty() || suffix == "%") || !(value >= 0 && value <= 1)) {
    throw UsageError(fmt::format(
        "{}: '{}' is not a share from 0 to 1, such as .05, or from 0% to 100%, such as 5%", option, text));
  }
  return value;
}

std::uint64_t parse_bytes(const std::string& text, const std::string& option) {
  double value = 0;
  const char* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, value);
  double unit = 1;
  const std::string suffix(end, last);
  if (suffix == "K" || suffix == "k")
    unit = 1024.0;
  else if (suffix == "M")
    unit = 1024.0 * 1024;
  else if (suffix == "G")
    unit = 1024.0 * 1024 * 1024;
  else if (suffix == "T")
    unit = 1024.0 * 1024 * 1024 * 1024;
  else if (!suffix.empty())
    value = -1;
  if (error != std::errc{} || !(value > 0) || value * unit > 9e18) {
    throw UsageError(fmt::format("{}: '{}' is not a size such as 800M or 4G", option, text));
  }
  return static_cast<std::uint64_t>(value * unit);
}

}  // namespace rayshade
