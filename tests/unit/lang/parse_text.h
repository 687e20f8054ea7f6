// SPDX-License-Identifier: MIT
// Helpers of the tests of the language layer: parse a text, find a message.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "rayshade/lang/parse.h"

namespace rayshade::test {

/// Parses `text` as the file "scene.ray", with further files beside it.
inline ParseResult parse_text(const std::string& text, const ParseOptions& options = {},
                              const std::map<std::string, std::string>& files = {}) {
  MemoryProvider provider;
  provider.add("scene.ray", text);
  for (const auto& [name, content] : files) provider.add(name, content);
  return parse_scene(provider, "scene.ray", options);
}

inline int count(const ParseResult& result, Severity severity) {
  int n = 0;
  for (const Diagnostic& d : result.diagnostics) n += d.severity == severity;
  return n;
}

/// All messages as a person would see them.
inline std::string all_messages(const ParseResult& result) {
  std::string out;
  for (const Diagnostic& d : result.diagnostics) out += format_diagnostic(d, false);
  return out;
}

/// "line:column severity text" of each message, for comparing.
inline std::vector<std::string> brief(const ParseResult& result) {
  static const char* const kWords[] = {"note", "advice", "warning", "error"};
  std::vector<std::string> out;
  for (const Diagnostic& d : result.diagnostics) {
    out.push_back(std::to_string(d.location.line) + ":" + std::to_string(d.location.column) + " " +
                  kWords[static_cast<int>(d.severity)] + " " + d.text);
  }
  return out;
}

}  // namespace rayshade::test
