// SPDX-License-Identifier: MIT
// See macro.h.
#include "rayshade/lang/macro.h"

#include <fmt/format.h>

#include <algorithm>

namespace rayshade::lang {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v' || c == '\n'; }

std::string parse_parameters(std::string_view& text, Macro* macro) {
  macro->function_like = true;
  text.remove_prefix(1);
  const std::size_t end = text.find(')');
  if (end == std::string_view::npos) return "the parameters of this macro have no ')'";
  std::string_view list = trim(text.substr(0, end));
  text.remove_prefix(end + 1);
  while (!list.empty()) {
    if (macro->variadic) return "'...' must be the last parameter of a macro";
    const std::size_t comma = std::min(list.find(','), list.size());
    std::string_view parameter = trim(list.substr(0, comma));
    const bool more = comma < list.size();
    list.remove_prefix(more ? comma + 1 : comma);
    if (parameter == "...") {
      macro->variadic = true;
      parameter = "__VA_ARGS__";
    }
    if (parameter.empty() || identifier_length(parameter) != parameter.size())
      return "bad parameter of a macro";
    if (std::find(macro->parameters.begin(), macro->parameters.end(), parameter) != macro->parameters.end()) {
      return fmt::format("parameter '{}' occurs twice", parameter);
    }
    macro->parameters.emplace_back(parameter);
    if (more && trim(list).empty()) return "bad parameter of a macro";
  }
  return {};
}

/// Cuts a body into pieces.
class BodyReader {
 public:
  BodyReader(std::string_view text, Macro* macro) : text_(trim(text)), macro_(macro) {}

  std::string read() {
    while (!text_.empty()) {
      if (const std::size_t n = number_length(text_)) {
        literal(n);
      } else if (const std::size_t word = identifier_length(text_)) {
        identifier(word);
      } else if (is_blank(text_.front())) {
        blanks();
      } else if (text_.substr(0, 2) == "##") {
        if (macro_->body.empty() || trim(text_.substr(2)).empty())
          return "'##' cannot stand at an end of a macro";
        paste();
      } else if (text_.front() == '#' && macro_->function_like) {
        if (!quote()) return "'#' must be followed by a parameter of the macro";
      } else {
        literal(1);
      }
    }
    return {};
  }

 private:
  int parameter(std::string_view name) const {
    const auto found = std::find(macro_->parameters.begin(), macro_->parameters.end(), name);
    return found == macro_->parameters.end() ? -1 : static_cast<int>(found - macro_->parameters.begin());
  }
  void append(Macro::Piece piece) {
    piece.pasted = pasting_;
    piece.raw = pasting_;
    pasting_ = false;
    macro_->body.push_back(std::move(piece));
  }
  void literal(std::size_t n) {
    const std::string_view text = text_.substr(0, n);
    text_.remove_prefix(n);
    std::vector<Macro::Piece>& body = macro_->body;
    if (!pasting_ && !body.empty() && body.back().parameter < 0) {
      body.back().text += text;
    } else {
      append({std::string(text), -1, false, false, false});
    }
  }
  void identifier(std::size_t n) {
    const int number = parameter(text_.substr(0, n));
    if (number < 0) return literal(n);
    text_.remove_prefix(n);
    append({{}, number, false, false, false});
  }
  void blanks() {
    const std::string_view rest = trim(text_);
    const bool before_paste = rest.substr(0, 2) == "##";
    text_ = rest;
    if (before_paste || pasting_) return;
    std::vector<Macro::Piece>& body = macro_->body;
    if (!body.empty() && body.back().parameter < 0) {
      body.back().text += ' ';
    } else {
      append({" ", -1, false, false, false});
    }
  }
  void paste() {
    text_.remove_prefix(2);
    macro_->body.back().raw = true;
    pasting_ = true;
  }
  bool quote() {
    text_ = trim(text_.substr(1));
    const std::size_t n = identifier_length(text_);
    const int number = n ? parameter(text_.substr(0, n)) : -1;
    if (number < 0) return false;
    text_.remove_prefix(n);
    append({{}, number, true, false, false});
    return true;
  }

  std::string_view text_;
  Macro* macro_;
  bool pasting_ = false;
};

}  // namespace

bool is_identifier_start(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_identifier_part(char c) { return is_identifier_start(c) || is_digit(c); }

std::size_t number_length(std::string_view text) {
  if (text.empty()) return 0;
  const bool starts = is_digit(text[0]) || (text[0] == '.' && text.size() > 1 && is_digit(text[1]));
  if (!starts) return 0;
  std::size_t n = 1;
  while (n < text.size()) {
    const char c = text[n], before = text[n - 1];
    const bool exponent_sign = (c == '+' || c == '-') && (before == 'e' || before == 'E');
    if (!is_identifier_part(c) && c != '.' && !exponent_sign) break;
    ++n;
  }
  return n;
}

std::size_t identifier_length(std::string_view text) {
  if (text.empty() || !is_identifier_start(text[0])) return 0;
  std::size_t n = 1;
  while (n < text.size() && is_identifier_part(text[n])) ++n;
  return n;
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string parse_macro(std::string_view text, std::string* name, Macro* macro) {
  text = trim(text);
  const std::size_t n = identifier_length(text);
  if (n == 0) return "a macro needs a name made of letters, digits and '_'";
  *name = text.substr(0, n);
  text.remove_prefix(n);
  if (*name == "defined") return "'defined' cannot be a macro";
  if (!text.empty() && text.front() == '(') {
    if (std::string error = parse_parameters(text, macro); !error.empty()) return error;
  }
  return BodyReader(text, macro).read();
}

}  // namespace rayshade::lang
