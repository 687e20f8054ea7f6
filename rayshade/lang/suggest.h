// SPDX-License-Identifier: MIT
// "Did you mean ...?": the nearest of a set of names by edit distance.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace rayshade::lang {

/// Insertions, deletions, changes and exchanges of neighbours that turn `a` into `b`; at most `limit` + 1.
std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t limit);

/// Finds the name nearest to a misspelt one. Offer every candidate, then ask. Of equally near ones the first
/// wins.
class Suggestion {
 public:
  explicit Suggestion(std::string_view wrong);
  void offer(std::string_view candidate);
  bool found() const { return !best_.empty(); }
  const std::string& best() const { return best_; }
  /// "did you mean 'best'?", or nothing.
  std::string text() const;

 private:
  std::string wrong_;
  std::string best_;
  std::size_t limit_;  ///< distance that a better candidate must not exceed
};

}  // namespace rayshade::lang
