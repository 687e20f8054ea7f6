// SPDX-License-Identifier: MIT
#include "rayshade/sampling/pixel_filter.h"

#include <algorithm>

#include "rayshade/math/functions.h"

namespace rayshade {
namespace {

constexpr int kSteps = 1024;
/// Beyond so many standard deviations a Gaussian weighs less than 1e-14 of what it does in the middle.
constexpr double kFarthest = 8;

/// By Simpson's rule.
std::vector<double> gauss_integral(double low, double step) {
  const auto weight = [](double x) { return fn::exp(-x * x / 2); };
  std::vector<double> out{0};
  for (int i = 0; i < kSteps; ++i) {
    const double x = low + i * step;
    out.push_back(out.back() + weight(x) + 4 * weight(x + step / 2) + weight(x + step));
  }
  const double whole = out.back();
  for (double& value : out) value /= whole;
  return out;
}

}  // namespace

PixelFilter::PixelFilter(FilterKind kind, double width) : low_(-width / 2), width_(width) {
  if (kind != FilterKind::kGauss) return;
  low_ = std::clamp(low_, -kFarthest, kFarthest);
  width_ = -2 * low_;
  integral_ = gauss_integral(low_, width_ / kSteps);
}

double PixelFilter::quantile(double xi) const {
  // The last step that begins at or below xi.
  const auto above = std::upper_bound(integral_.begin() + 1, integral_.end() - 1, xi);
  const double from = *(above - 1), to = *above;
  const double step =
      static_cast<double>(above - 1 - integral_.begin()) + (to > from ? (xi - from) / (to - from) : 0);
  return low_ + step * (width_ / kSteps);
}

}  // namespace rayshade
