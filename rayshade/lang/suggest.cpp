// SPDX-License-Identifier: MIT
// See suggest.h.
#include "rayshade/lang/suggest.h"

#include <algorithm>
#include <vector>

namespace rayshade::lang {

std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t limit) {
  const std::size_t difference = a.size() > b.size() ? a.size() - b.size() : b.size() - a.size();
  if (difference > limit) return limit + 1;
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1] ? 1u : 0u)});
      const bool exchanged = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (exchanged) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    if (*std::min_element(row.begin(), row.end()) > limit) return limit + 1;
    std::swap(before, last);
    std::swap(last, row);
  }
  return std::min(last[b.size()], limit + 1);
}

Suggestion::Suggestion(std::string_view wrong) : wrong_(wrong.substr(0, 64)) {
  limit_ = wrong_.size() <= 2 ? 0 : wrong_.size() <= 4 ? 1 : 2;
}

void Suggestion::offer(std::string_view candidate) {
  if (candidate.size() > 64 || (found() && limit_ == 0)) return;
  const std::size_t bound = found() ? limit_ - 1 : limit_;
  const std::size_t distance = edit_distance(wrong_, candidate, bound);
  if (distance > bound || distance == 0) return;
  limit_ = distance;
  best_ = candidate;
}

std::string Suggestion::text() const { return found() ? "did you mean '" + best_ + "'?" : std::string(); }

}  // namespace rayshade::lang
