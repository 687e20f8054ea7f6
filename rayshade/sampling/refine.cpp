// SPDX-License-Identifier: MIT
#include "rayshade/sampling/refine.h"

#include <array>
#include <cstdlib>

namespace rayshade {
namespace {

constexpr std::array<std::array<int, 2>, 5> kPlus{{{0, 0}, {-1, 0}, {0, -1}, {1, 0}, {0, 1}}};

bool channel_exceeds(double lowest, double highest, double threshold) {
  const double sum = highest + lowest;
  return sum > kEpsilon && (highest - lowest) / sum > threshold;
}

int class_of(int x, int y) { return (x + 2 * y) % 5; }

/// The steps of one call; see the head of refine.h.
class Refinement {
 public:
  Refinement(const PixelRect& rect, std::span<const Color> single, const Color& threshold, int width,
             int height)
      : threshold_(threshold),
        width_(width),
        height_(height),
        outer_(around(rect, kRefinementReach)),
        single_(single) {
    find_active(rect);
    find_firing(rect);
  }

  std::vector<bool> choose(const PixelRect& rect) const {
    std::vector<bool> full(rect.area());
    for (int y = rect.y0; y < rect.y1; ++y) {
      for (int x = rect.x0; x < rect.x1; ++x) {
        bool chosen = on_border(x, y);
        for (const auto& [dx, dy] : kPlus) {
          chosen =
              chosen || (fire_rect_.contains(x + dx, y + dy) && fires_[fire_rect_.index(x + dx, y + dy)]);
        }
        full[rect.index(x, y)] = chosen;
      }
    }
    return full;
  }

 private:
  PixelRect around(const PixelRect& rect, int margin) const { return halo(rect, margin, width_, height_); }
  bool on_border(int x, int y) const { return x == 0 || y == 0 || x == width_ - 1 || y == height_ - 1; }
  const Color& single(int x, int y) const { return single_[outer_.index(x, y)]; }

  void find_active(const PixelRect& rect) {
    active_rect_ = around(rect, 3);
    active_.assign(active_rect_.area(), false);
    for (int y = active_rect_.y0; y < active_rect_.y1; ++y) {
      for (int x = active_rect_.x0; x < active_rect_.x1; ++x) {
        if (on_border(x, y)) continue;
        std::array<Color, 5> values;
        for (std::size_t i = 0; i < 5; ++i) values[i] = single(x + kPlus[i][0], y + kPlus[i][1]);
        active_[active_rect_.index(x, y)] = contrast_exceeds(values, threshold_);
      }
    }
  }

  /// Whether the pixel is fully sampled as a pixel of class `rank` sees it.
  bool sampled_before(int x, int y, int rank) const {
    if (on_border(x, y)) return true;
    for (const auto& [dx, dy] : kPlus) {
      if (class_of(x + dx, y + dy) < rank && active_[active_rect_.index(x + dx, y + dy)]) return true;
    }
    return false;
  }

  /// The mean of the single samples within two pixels, rows and columns added, as far as they are on the
  /// screen.
  Color estimate(int x, int y) const {
    Color sum;
    int count = 0;
    for (int dy = -2; dy <= 2; ++dy) {
      const int span = 2 - std::abs(dy);
      for (int dx = -span; dx <= span; ++dx) {
        if (x + dx < 0 || y + dy < 0 || x + dx >= width_ || y + dy >= height_) continue;
        sum += single(x + dx, y + dy);
        ++count;
      }
    }
    return sum * (1.0 / count);
  }

  void find_firing(const PixelRect& rect) {
    fire_rect_ = around(rect, 1);
    fires_.assign(fire_rect_.area(), false);
    for (int y = fire_rect_.y0; y < fire_rect_.y1; ++y) {
      for (int x = fire_rect_.x0; x < fire_rect_.x1; ++x) {
        if (!active_[active_rect_.index(x, y)]) continue;
        std::array<Color, 5> values;
        for (std::size_t i = 0; i < 5; ++i) {
          const int px = x + kPlus[i][0], py = y + kPlus[i][1];
          values[i] = sampled_before(px, py, class_of(x, y)) ? estimate(px, py) : single(px, py);
        }
        fires_[fire_rect_.index(x, y)] = contrast_exceeds(values, threshold_);
      }
    }
  }

  Color threshold_;
  int width_, height_;
  PixelRect outer_, active_rect_, fire_rect_;
  std::span<const Color> single_;
  std::vector<bool> active_, fires_;
};

}  // namespace

PixelRect halo(const PixelRect& rect, int margin, int screen_width, int screen_height) {
  return {std::max(0, rect.x0 - margin), std::max(0, rect.y0 - margin),
          std::min(screen_width, rect.x1 + margin), std::min(screen_height, rect.y1 + margin)};
}

bool contrast_exceeds(std::span<const Color, 5> colors, const Color& threshold) {
  Color lowest = colors[0], highest = colors[0];
  for (const Color& c : colors.subspan<1>()) {
    lowest = {std::min(lowest.r, c.r), std::min(lowest.g, c.g), std::min(lowest.b, c.b)};
    highest = {std::max(highest.r, c.r), std::max(highest.g, c.g), std::max(highest.b, c.b)};
  }
  return channel_exceeds(lowest.r, highest.r, threshold.r) ||
         channel_exceeds(lowest.g, highest.g, threshold.g) ||
         channel_exceeds(lowest.b, highest.b, threshold.b);
}

std::vector<bool> choose_full(const PixelRect& rect, std::span<const Color> single, const Color& threshold,
                              int screen_width, int screen_height) {
  return Refinement(rect, single, threshold, screen_width, screen_height).choose(rect);
}

}  // namespace rayshade
