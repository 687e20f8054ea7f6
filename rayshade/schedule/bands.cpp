// SPDX-License-Identifier: MIT
#include "rayshade/schedule/bands.h"

#include <algorithm>
#include <cmath>

namespace rayshade {
namespace {

/// Follows the links to the one that points at itself, and shortens them on the way.
std::int64_t follow(std::vector<std::int64_t>& links, std::int64_t from) {
  auto i = static_cast<std::size_t>(from);
  while (links[i] != static_cast<std::int64_t>(i)) {
    links[i] = links[static_cast<std::size_t>(links[i])];
    i = static_cast<std::size_t>(links[i]);
  }
  return static_cast<std::int64_t>(i);
}

}  // namespace

std::int64_t first_band(std::int64_t lines, int worker, int workers) {
  const std::int64_t last = std::max<std::int64_t>(0, lines - 2);
  if (workers < 2) return 0;
  return std::llround(static_cast<double>(last) * (worker % workers) / (workers - 1));
}

// Line i is entry i + 1, so that there is a free one beyond both ends.
Bands::Bands(std::int64_t lines, int workers) : lines_(lines), workers_(workers) {
  for (std::int64_t i = 0; i <= lines + 1; ++i) {
    after_.push_back(i);
    before_.push_back(i);
  }
}

std::int64_t Bands::free_at_or_after(std::int64_t line) { return follow(after_, line + 1) - 1; }
std::int64_t Bands::free_at_or_before(std::int64_t line) { return follow(before_, line + 1) - 1; }

std::int64_t Bands::next(int worker) {
  const auto [entry, is_new] = reach_.try_emplace(worker);
  Reach& reach = entry->second;
  const std::int64_t start = first_band(lines_, worker, workers_);
  if (is_new) reach = {start, start - 1};
  std::int64_t line = -1;
  if (is_new || reach.last < reach.first) {
    const std::int64_t below = free_at_or_after(start), above = free_at_or_before(start);
    line = below < lines_ && (above < 0 || below - start <= start - above) ? below : above;
  } else {
    const std::int64_t below = free_at_or_after(reach.last + 1), above = free_at_or_before(reach.first - 1);
    const std::int64_t down = below - reach.last, up = reach.first - above;
    // Of two equally close the one nearer to the start: the band grows on both sides.
    const bool prefer_below = down != up ? down < up : below - start - 1 <= start - above;
    line = below < lines_ && (above < 0 || prefer_below) ? below : above;
  }
  if (line < 0) return -1;
  if (reach.last < reach.first)
    reach = {line, line};
  else
    reach = {std::min(reach.first, line), std::max(reach.last, line)};
  const auto i = static_cast<std::size_t>(line) + 1;
  after_[i] = line + 2;
  before_[i] = line;
  return line;
}

}  // namespace rayshade
