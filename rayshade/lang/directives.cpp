// SPDX-License-Identifier: MIT
// What the directives of the preprocessor do; see preprocessor.h.
#include <fmt/format.h>

#include <algorithm>

#include "rayshade/lang/condition.h"
#include "rayshade/lang/preprocessor.h"
#include "rayshade/lang/scanner_state.h"
#include "rayshade/lang/suggest.h"

namespace rayshade::lang {
namespace {

constexpr std::string_view kDirectives[] = {"define", "undef", "include", "if",    "ifdef", "ifndef",
                                            "elif",   "else",  "endif",   "error", "line",  "warning"};

bool is_conditional(std::string_view word) {
  return word == "if" || word == "ifdef" || word == "ifndef" || word == "elif" || word == "else" ||
         word == "endif";
}

}  // namespace

void Preprocessor::directive(File& file) {
  const std::size_t begin = file.at;
  const std::string text = logical_line(file);
  if (messages_.stopped()) return;
  // Messages point at the first line of the directive.
  const std::size_t line_end = std::min(file.text.find('\n', begin), file.text.size());
  const Place place{file.source, begin, begin + trim(file.text.substr(begin, line_end - begin)).size()};
  std::string_view rest = trim(text);
  const std::string_view word = rest.substr(0, identifier_length(rest));
  const bool live = file.live();
  if (is_conditional(word)) {
    rest.remove_prefix(word.size());
    conditional(file, place, word, trim(rest));
  } else if (live && (word == "line" || number_length(rest) != 0)) {
    line(file, place, rest);
  } else if (live && !rest.empty()) {
    rest = trim(rest.substr(word.size()));
    if (word == "define") {
      define(place, rest);
    } else if (word == "undef") {
      undefine(place, rest);
    } else if (word == "include") {
      include(file, place, rest);
    } else if (word == "error") {
      messages_.error(place, fmt::format("#error {}", rest));
    } else if (word == "warning") {
      messages_.warning(place, fmt::format("#warning {}", rest));
    } else {
      Suggestion suggestion(word);
      for (const std::string_view known : kDirectives) suggestion.offer(known);
      messages_.error(place, word.empty() ? "bad directive" : fmt::format("unknown directive '#{}'", word),
                      suggestion.text());
    }
  }
  // The line end stays, so that what stands before and after the directive does not touch.
  if (!out_.empty() && out_.back() != '\n') {
    sources_.add_verbatim(out_.size(), file.source, begin);
    out_ += '\n';
    after_expansion_ = false;
  }
}

void Preprocessor::conditional(File& file, const Place& place, std::string_view word, std::string_view rest) {
  std::vector<Conditional>& stack = file.conditionals;
  if (word == "if" || word == "ifdef" || word == "ifndef") {
    const bool outer = file.live();
    bool live = false;
    if (outer && word == "if") {
      live = condition(place, rest);
    } else if (outer) {
      const std::size_t n = identifier_length(rest);
      if (n == 0) messages_.error(place, fmt::format("'#{}' needs the name of a macro", word));
      live = n != 0 && (macros_.contains(rest.substr(0, n)) == (word == "ifdef"));
    }
    stack.push_back({place, outer, live, live});
    return;
  }
  if (stack.empty()) {
    messages_.error(place, fmt::format("'#{}' without '#if'", word));
    return;
  }
  Conditional& top = stack.back();
  if (word == "endif") {
    stack.pop_back();
  } else if (top.else_seen) {
    messages_.error(place, fmt::format("'#{}' after '#else'", word));
  } else if (word == "else") {
    top.else_seen = true;
    top.live = top.outer_live && !top.taken;
  } else {
    top.live = top.outer_live && !top.taken && condition(place, rest);
    top.taken = top.taken || top.live;
  }
}

bool Preprocessor::condition(const Place& place, std::string_view text) {
  // `defined X` and `defined(X)` come first: their macro must not be expanded.
  std::string replaced;
  while (!text.empty()) {
    std::size_t n = std::max<std::size_t>(number_length(text), 1);
    const std::size_t word = identifier_length(text);
    if (word != 0) n = word;
    if (text.substr(0, word) != "defined") {
      replaced += text.substr(0, n);
      text.remove_prefix(n);
      continue;
    }
    text = trim(text.substr(word));
    const bool closed = !text.empty() && text.front() == '(';
    if (closed) text = trim(text.substr(1));
    const std::size_t name = identifier_length(text);
    const bool known = name != 0 && macros_.contains(text.substr(0, name));
    text.remove_prefix(name);
    if (closed) text = trim(text);
    if (name == 0 || (closed && (text.empty() || text.front() != ')'))) {
      messages_.error(place, "'defined' needs the name of a macro");
      return false;
    }
    if (closed) text.remove_prefix(1);
    replaced += known ? " 1 " : " 0 ";
  }
  try {
    return evaluate_condition(expand(place, replaced)) != 0;
  } catch (const ConditionError& error) {
    messages_.error(place, error.what());
    return false;
  }
}

std::string Preprocessor::expand(const Place& place, std::string_view text) {
  set_position(place);
  std::string out;
  try {
    out = expander_.expand_all(text);
  } catch (const ExpansionError& error) {
    messages_.error(place, error.what());
    if (error.fatal) messages_.stop();
  }
  out.erase(std::remove(out.begin(), out.end(), kPainted), out.end());
  return out;
}

void Preprocessor::define(const Place& place, std::string_view text) {
  std::string name;
  Macro macro;
  if (const std::string wrong = parse_macro(text, &name, &macro); !wrong.empty()) {
    messages_.error(place, wrong);
    return;
  }
  expander_.add_name(name);
  const auto [known, fresh] = macros_.try_emplace(name, macro);
  if (fresh) return;
  const Macro& before = known->second;
  const bool same = before.kind == Macro::Kind::kDefined && before.function_like == macro.function_like &&
                    before.parameters == macro.parameters && before.body == macro.body;
  if (!same) messages_.warning(place, fmt::format("macro '{}' is defined again, differently", name));
  known->second = macro;
}

void Preprocessor::undefine(const Place& place, std::string_view text) {
  const std::size_t n = identifier_length(text);
  if (n == 0) {
    messages_.error(place, "'#undef' needs the name of a macro");
    return;
  }
  const auto known = macros_.find(text.substr(0, n));
  if (known != macros_.end()) macros_.erase(known);
}

void Preprocessor::line(File& file, const Place& place, std::string_view text) {
  LineMarker marker;
  const std::string expanded =
      "#" + (parse_line_marker("#" + std::string(text), &marker) ? std::string(text) : expand(place, text));
  if (!parse_line_marker(expanded, &marker)) {
    messages_.error(place, "'#line' needs a line number");
    return;
  }
  sources_.add_marker(file.source, file.at, marker.line,
                      marker.named ? std::optional<std::string>(marker.name) : std::nullopt);
}

void Preprocessor::include(File& file, const Place& place, std::string_view text) {
  std::string expanded;
  if (!text.empty() && text.front() != '"' && text.front() != '<') {
    expanded = expand(place, text);
    text = trim(expanded);
  }
  const char close = text.empty() ? '\0' : text.front() == '"' ? '"' : text.front() == '<' ? '>' : '\0';
  const std::size_t end = close == '\0' ? std::string_view::npos : text.find(close, 1);
  if (end == std::string_view::npos || end == 1) {
    messages_.error(place, "'#include' needs \"file\" or <file>");
    return;
  }
  include_file(file, place, std::string(text.substr(1, end - 1)), close == '"');
}

void Preprocessor::include_file(File& file, const Place& place, const std::string& target, bool quoted) {
  if (level_ >= kMostInclusionLevels) {
    messages_.error(place,
                    fmt::format("files are included more than {} levels deep; does one include itself?",
                                kMostInclusionLevels));
    messages_.stop();
    return;
  }
  std::vector<std::string> candidates;
  if (target.front() == '/') {
    candidates.push_back(target);
  } else {
    if (quoted) candidates.push_back(file.directory + target);
    for (const std::string& directory : include_directories_)
      candidates.emplace_back(directory).append("/").append(target);
  }
  Bytes bytes;
  std::string reason = "no directory to look in was given with -I";
  std::string found;
  for (const std::string& candidate : candidates) {
    try {
      bytes = provider_.read(candidate);
      found = candidate;
      break;
    } catch (const ProviderError& error) {
      if (&candidate == &candidates.front()) reason = error.what();
    }
  }
  if (!bytes) {
    messages_.error(place, fmt::format("cannot read '{}': {}", target, reason));
    messages_.stop();  // what it would have defined is missing everywhere
    return;
  }
  included_bytes_ += bytes->size();
  if (++inclusions_ > kMostInclusions || included_bytes_ > kMostIncludedBytes) {
    messages_.error(place, fmt::format("too much is included: more than {} files or {} MiB", kMostInclusions,
                                       kMostIncludedBytes >> 20));
    messages_.stop();
    return;
  }
  const std::uint32_t source = sources_.add_source(found, place);
  sources_.keep(source, std::move(bytes));
  ++level_;
  process(source, found);
  --level_;
}

void Preprocessor::predefine(const std::string& definition) {
  // NAME, NAME=value or NAME(parameters)=value.
  const std::size_t equals = definition.find('=');
  std::string text = definition + " 1";
  if (equals != std::string::npos) text = definition.substr(0, equals) + " " + definition.substr(equals + 1);
  std::string name;
  Macro macro;
  if (const std::string wrong = parse_macro(text, &name, &macro); !wrong.empty()) {
    messages_.error_in_file("", fmt::format("in preprocessor argument -D {}: {}", definition, wrong));
    return;
  }
  expander_.add_name(name);
  macros_.insert_or_assign(name, macro);
}

void Preprocessor::set_arguments(const std::vector<std::string>& arguments) {
  // Switches of external preprocessors that change nothing here.
  constexpr std::string_view kHarmless[] = {
      "-", "-E", "-P", "-C", "-w", "-traditional", "-traditional-cpp", "-nostdinc", "-undef"};
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (std::find(std::begin(kHarmless), std::end(kHarmless), argument) != std::end(kHarmless)) continue;
    const std::string_view option = std::string_view(argument).substr(0, 2);
    if (option != "-D" && option != "-U" && option != "-I") {
      messages_.error_in_file(
          "", fmt::format("unknown preprocessor argument '{}'; -D, -U and -I are possible", argument));
      continue;
    }
    std::string value = argument.substr(2);
    if (value.empty() && i + 1 < arguments.size()) value = arguments[++i];
    if (value.empty()) {
      messages_.error_in_file("", fmt::format("preprocessor argument {} needs a value", option));
    } else if (option == "-D") {
      predefine(value);
    } else if (option == "-I") {
      include_directories_.push_back(value);
    } else if (const auto known = macros_.find(value); known != macros_.end()) {
      macros_.erase(known);
    }
  }
}

}  // namespace rayshade::lang
