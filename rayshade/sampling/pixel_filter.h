// SPDX-License-Identifier: MIT
// The filter over a pixel as a density of samples: where it weighs more, more samples are, and all of them
// count alike. For samples that lie in no grid.
#pragma once

#include <array>
#include <vector>

#include "rayshade/scene/settings.h"

namespace rayshade {

/// Immutable; any number of threads may share one.
class PixelFilter {
 public:
  /// The square [-width/2, width/2]^2 around the pixel; within it, all alike (box) or by exp(-r^2/2) (gauss).
  PixelFilter(FilterKind kind, double width);

  /// What to add to the coordinates of the pixel to get the screen point of a sample: distributed as the
  /// filter says where `xi` and `zeta` are uniform in [0, 1).
  std::array<double, 2> offset(double xi, double zeta) const { return {along(xi), along(zeta)}; }

 private:
  double along(double xi) const { return integral_.empty() ? low_ + xi * width_ : quantile(xi); }
  double quantile(double xi) const;

  double low_, width_;
  /// Gauss: the share of the filter up to each of equal steps of the width, from 0 to 1.
  std::vector<double> integral_;
};

}  // namespace rayshade
