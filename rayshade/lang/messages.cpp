// SPDX-License-Identifier: MIT
// See messages.h.
#include "rayshade/lang/messages.h"

#include <fmt/format.h>

#include <algorithm>

namespace rayshade::lang {
namespace {

constexpr std::uint64_t kRepeats = 10;       ///< equal warnings shown
constexpr std::size_t kMostWarnings = 1000;  ///< distinct texts counted; beyond them everything is shared
constexpr std::uint64_t kWindow = 160;       ///< bytes of a source line shown at most
constexpr std::size_t kChain = 8;            ///< inclusions shown at most

}  // namespace

void Messages::error(const Place& place, std::string text, std::string suggestion) {
  if (stopped_) return;
  add(Severity::kError, place, std::move(text), std::move(suggestion));
  if (++errors_ < max_errors_) return;
  add(Severity::kError, place, "too many errors", {});
  stopped_ = true;
}

void Messages::error_in_file(const std::string& file, std::string text) {
  if (stopped_) return;
  Diagnostic d;
  d.file = file;
  d.text = std::move(text);
  diagnostics_.push_back(std::move(d));
  ++errors_;
}

void Messages::add(Severity severity, const Place& place, std::string text, std::string suggestion) {
  if (severity == Severity::kNote && left_out_) return;
  left_out_ = false;
  if (severity == Severity::kWarning || severity == Severity::kAdvice) {
    const bool known = repeats_.contains(text) || repeats_.size() < kMostWarnings;
    left_out_ = ++repeats_[known ? text : "other messages"] > (known ? kRepeats : 0);
    if (left_out_) return;
  }
  diagnostics_.push_back(make(severity, place, std::move(text), std::move(suggestion)));
}

Diagnostic Messages::make(Severity severity, const Place& place, std::string text, std::string suggestion) {
  Diagnostic d;
  d.severity = severity;
  d.text = std::move(text);
  d.suggestion = std::move(suggestion);
  d.location = sources_.locate(place);
  d.file = sources_.file_name(d.location);

  // Of a long line only the neighbourhood of the place is shown.
  std::uint64_t column = 0;
  const std::string_view line = sources_.line_text(place, &column);
  const std::uint64_t from = column > kWindow / 2 && line.size() > kWindow ? column - kWindow / 2 : 0;
  d.source_line = std::string(line.substr(std::min<std::uint64_t>(from, line.size()), kWindow));
  while (!d.source_line.empty() && (d.source_line.back() == '\r' || d.source_line.back() == ' '))
    d.source_line.pop_back();
  d.caret_begin = static_cast<std::uint32_t>(column - from);
  const std::uint64_t length = std::max<std::uint64_t>(place.end - place.begin, 1);
  d.caret_end =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(d.caret_begin + length, d.source_line.size()));

  std::optional<Place> from_place = sources_.included_from(place.source);
  while (from_place && d.included_from.size() < kChain) {
    const Location where = sources_.locate(*from_place);
    d.included_from.push_back({sources_.file_name(where), where.line});
    from_place = sources_.included_from(from_place->source);
  }
  return d;
}

std::vector<Diagnostic> Messages::take() {
  std::vector<std::pair<std::string, std::uint64_t>> hidden;
  for (const auto& [text, count] : repeats_) {
    const std::uint64_t shown = text == "other messages" ? 0 : kRepeats;
    if (count > shown) hidden.emplace_back(text, count - shown);
  }
  std::sort(hidden.begin(), hidden.end());
  for (const auto& [text, count] : hidden) {
    Diagnostic d;
    d.severity = Severity::kWarning;
    d.text = fmt::format("{} more like this: {}", count, text);
    diagnostics_.push_back(std::move(d));
  }
  return std::move(diagnostics_);
}

}  // namespace rayshade::lang
