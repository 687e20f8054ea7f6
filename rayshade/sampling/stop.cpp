// SPDX-License-Identifier: MIT
#include "rayshade/sampling/stop.h"

#include <algorithm>
#include <cmath>

namespace rayshade {
namespace {

/// The samples for which the prior counts. Fewer miss thin things; more waste samples beside edges. Measured
/// from 1 to 9 by the error at equal time: flat around 4.
constexpr double kPriorWeight = 4;

/// The variance of one channel's mean, or 0 where that is certain to be shown as full intensity.
double visible_variance(double mean, double variance) {
  constexpr double kCertain = 4;  // standard errors
  return mean - kCertain * std::sqrt(variance) > 1 ? 0 : variance;
}

}  // namespace

int StopRule::next(int count) const {
  const int twice = 2 * count;
  // A rest of less than half a round is not worth one of its own.
  return most_ - twice < count ? most_ : twice;
}

Color StopRule::prior(const std::array<const SampleMoments*, 9>& around, int count) {
  Color sum, squares, within;
  for (const SampleMoments* pixel : around) {
    sum += pixel->mean;
    squares += pixel->square;
    within += pixel->scatter;
  }
  const auto line = [&](std::size_t a, std::size_t b, std::size_t c) {
    return around[a]->mean + around[b]->mean + around[c]->mean;
  };
  const Color ramp_x = line(2, 5, 8) - line(0, 3, 6), ramp_y = line(6, 7, 8) - line(0, 1, 2);
  // Least squares over a 3 x 3 grid; the means of n samples count n times. Nine means less three parameters
  // leave six degrees of freedom, and each pixel's samples add n - 1.
  const Color between = squares - sum * sum * (1.0 / 9) - (ramp_x * ramp_x + ramp_y * ramp_y) * (1.0 / 6);
  const int n = count;
  const Color out = (between * static_cast<double>(n) + within) * (1.0 / (6 + 9 * (n - 1)));
  return {std::max(0.0, out.r), std::max(0.0, out.g), std::max(0.0, out.b)};
}

bool StopRule::enough(const SampleSums& pixel, const Color& prior) const {
  if (!(square_ > 0)) return false;
  const double n = pixel.count;
  const Color mean = pixel.mean();
  const Color single = (kPriorWeight * prior + pixel.scatter()) * (1 / (kPriorWeight + n - 1));
  // n^(-3/2), and what is allowed grows with (n / 9)^(1/2).
  const Color of_mean = single * (3 / (n * n));
  // Not-a-number stays one, and is never enough.
  const double error = visible_variance(mean.r, std::max(of_mean.r, 0.0)) +
                       visible_variance(mean.g, std::max(of_mean.g, 0.0)) +
                       visible_variance(mean.b, std::max(of_mean.b, 0.0));
  return error <= 3 * square_;
}

}  // namespace rayshade
