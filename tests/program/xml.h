// SPDX-License-Identifier: MIT
// Whether a text is well-formed XML, as far as the program uses it: elements, attributes, characters and the
// predefined entities; no comments, CDATA or document types.
#pragma once

#include <cctype>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace rayshade::testing_tools {

class XmlReader {
 public:
  explicit XmlReader(std::string_view text) : text_(text) {}

  /// What is wrong first, empty if nothing is.
  std::string error() {
    if (take("<?xml ")) {
      const std::size_t end = text_.find("?>");
      if (end == std::string_view::npos) return "declaration without end";
      text_.remove_prefix(end + 2);
    }
    skip_blanks();
    bool seen_root = false;
    while (!text_.empty()) {
      if (open_.empty() && seen_root) {
        skip_blanks();
        return text_.empty() ? "" : "something after the root element";
      }
      if (text_[0] == '<') {
        seen_root = true;
        if (std::string wrong = tag(); !wrong.empty()) return wrong;
      } else if (open_.empty()) {
        return "text before the root element";
      } else if (std::string wrong = character(); !wrong.empty()) {
        return wrong;
      }
    }
    return !seen_root ? "no root element" : open_.empty() ? "" : "<" + open_.back() + "> is not closed";
  }

 private:
  bool take(std::string_view word) {
    if (!text_.starts_with(word)) return false;
    text_.remove_prefix(word.size());
    return true;
  }
  bool skip_blanks() {
    const std::size_t before = text_.size();
    while (!text_.empty() && std::isspace(static_cast<unsigned char>(text_[0]))) text_.remove_prefix(1);
    return text_.size() < before;
  }
  std::string name() {
    std::size_t n = 0;
    while (n < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[n])) || text_[n] == ':' ||
                                (n > 0 && (text_[n] == '-' || text_[n] == '_'))))
      ++n;
    std::string out(text_.substr(0, n));
    text_.remove_prefix(n);
    return out;
  }
  std::string character() {
    const auto byte = static_cast<unsigned char>(text_[0]);
    if (byte >= 0x80 || (byte < ' ' && !std::isspace(byte))) return "a byte that is not ASCII text";
    if (byte == '&') {
      for (const std::string_view entity : {"&amp;", "&lt;", "&gt;", "&quot;", "&apos;"})
        if (take(entity)) return "";
      return "a bare &";
    }
    text_.remove_prefix(1);
    return "";
  }
  std::string tag() {
    if (take("</")) {
      const std::string closed = name();
      skip_blanks();
      if (open_.empty() || open_.back() != closed) return "</" + closed + "> closes nothing";
      open_.pop_back();
      return take(">") ? "" : "closing tag without end";
    }
    take("<");
    const std::string element = name();
    if (element.empty()) return "an element without a name";
    std::set<std::string> seen;
    for (;;) {
      const bool apart = skip_blanks();
      if (take("/>")) return "";
      if (take(">")) {
        open_.push_back(element);
        return "";
      }
      const std::string attribute = name();
      if (attribute.empty() || !apart || !seen.insert(attribute).second || !take("=\""))
        return "bad attributes of <" + element + ">";
      while (!text_.empty() && text_[0] != '"') {
        if (text_[0] == '<') return "< in a value of <" + element + ">";
        if (std::string wrong = character(); !wrong.empty()) return wrong;
      }
      if (!take("\"")) return "a value without end";
    }
  }

  std::string_view text_;
  std::vector<std::string> open_;
};

inline std::string xml_error(const std::string& text) { return XmlReader(text).error(); }

}  // namespace rayshade::testing_tools
