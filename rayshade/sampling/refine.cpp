// SPDX-License-Identifier: MIT
#include "rayshade/sampling/refine.h"

#include <array>

namespace rayshade {
namespace {

bool channel_exceeds(double lowest, double highest, double threshold) {
  const double sum = highest + lowest;
  return sum > kEpsilon && (highest - lowest) / sum > threshold;
}

}  // namespace

PixelRect halo(const PixelRect& rect, int margin, int screen_width, int screen_height) {
  return {std::max(0, rect.x0 - margin), std::max(0, rect.y0 - margin), std::min(screen_width, rect.x1 + margin),
          std::min(screen_height, rect.y1 + margin)};
}

bool contrast_exceeds(std::span<const Color, 5> colors, const Color& threshold) {
  Color lowest = colors[0], highest = colors[0];
  for (const Color& c : colors.subspan<1>()) {
    lowest = {std::min(lowest.r, c.r), std::min(lowest.g, c.g), std::min(lowest.b, c.b)};
    highest = {std::max(highest.r, c.r), std::max(highest.g, c.g), std::max(highest.b, c.b)};
  }
  return channel_exceeds(lowest.r, highest.r, threshold.r) || channel_exceeds(lowest.g, highest.g, threshold.g) ||
         channel_exceeds(lowest.b, highest.b, threshold.b);
}

std::vector<bool> choose_full(const PixelRect& rect, std::span<const Color> single, const Color& threshold,
                              int screen_width, int screen_height) {
  const PixelRect outer = halo(rect, kRefinementReach, screen_width, screen_height);
  const PixelRect tested = halo(rect, 1, screen_width, screen_height);
  const auto value = [&](int x, int y) -> const Color& {
    return single[static_cast<std::size_t>(y - outer.y0) * outer.width() + (x - outer.x0)];
  };
  // Round one. Corners of `tested` reach nobody in `rect` and lack a neighbour in `outer` only off the screen.
  std::vector<bool> active(static_cast<std::size_t>(tested.width()) * tested.height());
  for (int y = std::max(tested.y0, 1); y < std::min(tested.y1, screen_height - 1); ++y) {
    for (int x = std::max(tested.x0, 1); x < std::min(tested.x1, screen_width - 1); ++x) {
      const std::array<Color, 5> plus{value(x, y), value(x - 1, y), value(x + 1, y), value(x, y - 1), value(x, y + 1)};
      active[static_cast<std::size_t>(y - tested.y0) * tested.width() + (x - tested.x0)] =
          contrast_exceeds(plus, threshold);
    }
  }
  // Round two.
  const auto is_active = [&](int x, int y) {
    return tested.contains(x, y) && active[static_cast<std::size_t>(y - tested.y0) * tested.width() + (x - tested.x0)];
  };
  std::vector<bool> full(static_cast<std::size_t>(rect.width()) * rect.height());
  for (int y = rect.y0; y < rect.y1; ++y) {
    for (int x = rect.x0; x < rect.x1; ++x) {
      const bool border = x == 0 || y == 0 || x == screen_width - 1 || y == screen_height - 1;
      full[static_cast<std::size_t>(y - rect.y0) * rect.width() + (x - rect.x0)] =
          border || is_active(x, y) || is_active(x - 1, y) || is_active(x + 1, y) || is_active(x, y - 1) ||
          is_active(x, y + 1);
    }
  }
  return full;
}

}  // namespace rayshade
