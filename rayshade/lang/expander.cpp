// SPDX-License-Identifier: MIT
// See expander.h. The text under expansion is a stack of frames: the given text at the bottom, on it the
// bodies of the macros being expanded. Reading goes on in the frame below when one is used up.
#include "rayshade/lang/expander.h"

#include <fmt/format.h>

#include <algorithm>

namespace rayshade::lang {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
bool is_word_part(char c) { return is_identifier_part(c) || c == '.' || c == '-'; }

/// Leaves every macro of the stack, also when an error ends the expansion.
template <typename Frames>
struct Leave {
  Frames& frames;
  ~Leave() {
    for (auto& frame : frames) {
      if (frame.macro) --frame.macro->active;
    }
  }
};

struct Level {
  int& levels;
  explicit Level(int& l) : levels(l) { ++levels; }
  ~Level() { --levels; }
};

}  // namespace

std::size_t skip_blanks_and_comments(std::string_view text, std::size_t at) {
  while (at < text.size()) {
    if (is_space(text[at])) {
      ++at;
    } else if (text[at] == '\\' && at + 1 < text.size() && (text[at + 1] == '\n' || text[at + 1] == '\r')) {
      at += 2;
    } else if (text.substr(at, 2) == "/*") {
      const std::size_t end = text.find("*/", at + 2);
      if (end == std::string_view::npos) return text.size();
      at = end + 2;
    } else if (text.substr(at, 2) == "//") {
      at = line_comment_end(text, at);
    } else {
      break;
    }
  }
  return at;
}

std::size_t line_comment_end(std::string_view text, std::size_t at) {
  return std::min(text.find('\n', at), text.size());
}

Macro* Expander::find(std::string_view name) {
  if (!filter_[static_cast<unsigned char>(name.front())]) return nullptr;
  const auto found = macros_.find(name);
  return found == macros_.end() ? nullptr : &found->second;
}

void Expander::add_name(std::string_view name) { filter_[static_cast<unsigned char>(name.front())] = true; }

void Expander::spend(std::uint64_t bytes) {
  spent_ += bytes + 1;
  if (spent_ > kMostExpandedBytes) {
    throw ExpansionError(fmt::format("macros expand to more than {} MiB", kMostExpandedBytes >> 20), true);
  }
}

void Expander::append_apart(std::string* out, std::string_view text) {
  if (text.empty()) return;
  // The word at the end of the output; only one that begins like a number can become another number.
  std::size_t start = out->size();
  const std::size_t limit = out->size() > 64 ? out->size() - 64 : 0;
  while (start > limit && is_word_part((*out)[start - 1])) --start;
  std::string_view word = std::string_view(*out).substr(start);
  // Of "2-1" only the 1 counts; of "a-1" nothing, it is one name.
  for (std::size_t n = number_length(word); !word.empty() && n < word.size(); n = number_length(word)) {
    if (word[n] != '-') break;
    word.remove_prefix(n + 1);
  }
  const bool numeric = word == "." || (!word.empty() && number_length(word) == word.size());
  if (numeric) {
    const char next = text.front(), last = word.back();
    const bool digit = is_digit(next) || (next == '.' && word != ".");
    const bool exponent = (next == 'e' || next == 'E') && text.size() > 1 &&
                          (is_digit(text[1]) || text[1] == '+' || text[1] == '-');
    const bool sign = (next == '+' || next == '-') && (last == 'e' || last == 'E');
    if (digit || exponent || sign) out->push_back(' ');
  }
  *out += text;
}

void Expander::pop(Frames& frames) {
  if (frames.back().macro) --frames.back().macro->active;
  frames.pop_back();
}

void Expander::push(Frames& frames, Macro* macro, std::string text) {
  spend(text.size());
  Frame& frame = frames.emplace_back();
  frame.owned = std::move(text);
  frame.macro = macro;
  ++macro->active;
}

std::size_t Expander::expand_call(std::string_view text, std::size_t begin, std::string* out) {
  Frames frames(1);
  frames[0].text = text;
  frames[0].at = begin;
  const std::size_t from = out->size();
  const std::size_t end = run(frames, out, false);
  out->erase(std::remove(out->begin() + static_cast<std::ptrdiff_t>(from), out->end(), kPainted), out->end());
  return end;
}

std::string Expander::expand_all(std::string_view text) {
  Frames frames(1);
  frames[0].text = text;
  std::string out;
  run(frames, &out, true);
  return out;
}

/// Works until the bottom frame is used up, or, unless `whole`, until one call at its start is.
std::size_t Expander::run(Frames& frames, std::string* out, bool whole) {
  const Leave<Frames> leave{frames};
  bool started = false;
  bool seam = true;  // the next token comes from another frame than the one before
  for (;;) {
    Frame& frame = frames.back();
    // Texts of expansions move with their frames: look at them anew each time.
    const std::string_view text = frames.size() == 1 ? frame.text : std::string_view(frame.owned);
    if (frames.size() == 1 && started && !whole) return frame.at;
    if (frame.at >= text.size()) {
      if (frames.size() == 1) return frame.at;
      pop(frames);
      seam = true;
      continue;
    }
    started = true;
    const std::string_view rest = text.substr(frame.at);
    const bool painted = rest.front() == kPainted;
    if (painted || is_identifier_start(rest.front())) {
      const std::size_t before = frames.size();
      identifier(frames, out);
      seam = seam || frames.size() != before;
      continue;
    }
    const std::size_t n = std::max<std::size_t>(number_length(rest), 1);
    frame.at += n;
    spend(n);
    if (seam) {
      append_apart(out, rest.substr(0, n));
    } else {
      *out += rest.substr(0, n);
    }
    seam = false;
  }
}

void Expander::identifier(Frames& frames, std::string* out) {
  Frame& frame = frames.back();
  const std::string_view text = frames.size() == 1 ? frame.text : std::string_view(frame.owned);
  const bool painted = text[frame.at] == kPainted;
  const std::size_t begin = frame.at + (painted ? 1 : 0);
  const std::string name(text.substr(begin, identifier_length(text.substr(begin))));
  frame.at = begin + name.size();
  spend(name.size());
  Macro* macro = painted || name.empty() ? nullptr : find(name);
  if (!macro) {
    if (painted) out->push_back(kPainted);
    append_apart(out, name);
    return;
  }
  if (macro->active > 0) {
    out->push_back(kPainted);
    append_apart(out, name);
    return;
  }
  if (macro->kind == Macro::Kind::kLine) return append_apart(out, std::to_string(line_));
  if (macro->kind == Macro::Kind::kFile)
    return append_apart(out, '"' + (file_ ? *file_ : std::string()) + '"');
  if (!macro->function_like) return push(frames, macro, substitute(*macro, {}));
  std::size_t in_frame = 0, at = 0;
  if (!find_arguments(frames, &in_frame, &at)) return append_apart(out, name);
  while (frames.size() - 1 > in_frame) pop(frames);
  frames.back().at = at + 1;
  const std::vector<std::string> arguments = read_arguments(frames, *macro, name);
  push(frames, macro, substitute(*macro, arguments));
}

/// Looks for '(' as the next token, through the ends of frames, without moving.
bool Expander::find_arguments(Frames& frames, std::size_t* frame, std::size_t* at) const {
  for (std::size_t i = frames.size(); i-- > 0;) {
    const std::string_view text = i == 0 ? frames[i].text : std::string_view(frames[i].owned);
    const std::size_t next = skip_blanks_and_comments(text, frames[i].at);
    if (next >= text.size()) continue;
    *frame = i;
    *at = next;
    return text[next] == '(';
  }
  return false;
}

std::vector<std::string> Expander::read_arguments(Frames& frames, const Macro& macro, std::string_view name) {
  std::vector<std::string> arguments(1);
  bool quoted = false;  // there // is none, as in the names of files
  for (int depth = 0;;) {
    Frame& frame = frames.back();
    const std::string_view text = frames.size() == 1 ? frame.text : std::string_view(frame.owned);
    if (frame.at >= text.size()) {
      if (frames.size() == 1)
        throw ExpansionError(fmt::format("the call of macro '{}' has no ')'", name), false);
      pop(frames);
      continue;
    }
    const std::size_t blanks = quoted ? frame.at : skip_blanks_and_comments(text, frame.at);
    if (blanks != frame.at) {
      frame.at = blanks;
      arguments.back() += ' ';
      continue;
    }
    const char c = text[frame.at++];
    spend(1);
    if (c == '"') quoted = !quoted;
    if (c == ')' && depth-- == 0) break;
    if (c == '(') ++depth;
    const bool rest = macro.variadic && arguments.size() == macro.parameters.size();
    if (c == ',' && depth == 0 && !rest) {
      arguments.emplace_back();
    } else {
      arguments.back() += c;
    }
  }
  for (std::string& argument : arguments) argument = std::string(trim(argument));
  const std::size_t wanted = macro.parameters.size();
  if (wanted == 0 && arguments.size() == 1 && arguments[0].empty()) arguments.clear();
  if (macro.variadic && arguments.size() + 1 == wanted) arguments.emplace_back();
  if (arguments.size() != wanted) {
    throw ExpansionError(fmt::format("macro '{}' takes {} argument{}, not {}", name, wanted,
                                     wanted == 1 ? "" : "s", arguments.size()),
                         false);
  }
  return arguments;
}

std::string Expander::substitute(const Macro& macro, const std::vector<std::string>& arguments) {
  const Level level(levels_);
  if (levels_ > kMostArgumentLevels) throw ExpansionError("macro calls are nested too deeply", true);
  std::vector<std::string> expanded(arguments.size());
  std::vector<bool> ready(arguments.size(), false);
  std::string out;
  for (const Macro::Piece& piece : macro.body) {
    std::string quoted;
    std::string_view text = piece.text;
    if (piece.parameter >= 0) {
      const auto number = static_cast<std::size_t>(piece.parameter);
      if (piece.quoted) {
        quoted = '"' + arguments[number] + '"';
        text = quoted;
      } else if (piece.raw) {
        text = arguments[number];
      } else {
        if (!ready[number]) expanded[number] = expand_all(arguments[number]);
        ready[number] = true;
        text = expanded[number];
      }
    }
    spend(text.size());
    if (piece.pasted) {
      out += text;
    } else {
      append_apart(&out, text);
    }
  }
  return out;
}

}  // namespace rayshade::lang
