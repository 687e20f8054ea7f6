// SPDX-License-Identifier: MIT
// Collects diagnostics while a scene is read: counts errors, stops after too many, and keeps a scene with a
// million equal complaints from filling the memory.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "rayshade/lang/diagnostic.h"
#include "rayshade/lang/source_map.h"

namespace rayshade::lang {

class Messages {
 public:
  Messages(SourceMap& sources, int max_errors) : sources_(sources), max_errors_(max_errors) {}

  void error(const Place& place, std::string text, std::string suggestion = {});
  void error(const Span& span, std::string text, std::string suggestion = {}) {
    error(sources_.place(span), std::move(text), std::move(suggestion));
  }
  /// An error about a file, or about no place at all where `file` is empty.
  void error_in_file(const std::string& file, std::string text);
  void warning(const Place& place, std::string text) { add(Severity::kWarning, place, std::move(text), {}); }
  void warning(const Span& span, std::string text) { warning(sources_.place(span), std::move(text)); }
  void advice(const Span& span, std::string text) {
    add(Severity::kAdvice, sources_.place(span), std::move(text), {});
  }
  /// Explains the message before it.
  void note(const Span& span, std::string text) {
    add(Severity::kNote, sources_.place(span), std::move(text), {});
  }

  /// Nothing more should be read: too many errors, or one after which going on makes no sense.
  bool stopped() const { return stopped_; }
  void stop() { stopped_ = true; }
  int errors() const { return errors_; }
  /// All messages in order, with a summary of those that were left out.
  std::vector<Diagnostic> take();

 private:
  void add(Severity severity, const Place& place, std::string text, std::string suggestion);
  Diagnostic make(Severity severity, const Place& place, std::string text, std::string suggestion);

  SourceMap& sources_;
  int max_errors_;
  int errors_ = 0;
  bool stopped_ = false;
  bool left_out_ = false;  ///< the last message was left out, and so are its notes
  std::vector<Diagnostic> diagnostics_;
  std::unordered_map<std::string, std::uint64_t> repeats_;  ///< per text, of advice and warnings
};

}  // namespace rayshade::lang
