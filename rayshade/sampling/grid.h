// SPDX-License-Identifier: MIT
// The samples of a pixel: where they lie, what they weigh, and their numbers in the dither pattern
// (shading.md 7.1, 7.2, 7.6). Sample k = i + N j is in column i and row j of an N x N grid over the filter's
// square around the pixel.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "rayshade/scene/settings.h"

namespace rayshade {

/// The numbers s of samples 0 ... N^2 - 1, a permutation: time slice s, lens cell (s mod N, s div N). The
/// original's tables for 1 <= N <= 8 (those for 6, 7 and 8 counted from 0, too); above, up to 64, a
/// permutation of our own.
std::vector<std::uint16_t> sample_numbers(int samples_per_side);

/// The weights of samples 0 ... N^2 - 1; their sum is 1.
std::vector<double> filter_weights(int samples_per_side, FilterKind kind, double width);

/// Immutable; any number of threads may share one.
class SampleGrid {
 public:
  /// 1 <= samples_per_side <= 64.
  SampleGrid(int samples_per_side, bool jitter, FilterKind kind, double width);
  explicit SampleGrid(const RenderSettings& settings)
      : SampleGrid(settings.samples, settings.jitter, settings.filter, settings.filter_width) {}

  int samples_per_side() const { return side_; }
  int count() const { return side_ * side_; }
  bool jitter() const { return jitter_; }
  double width() const { return width_; }

  /// What to add to the coordinates of the pixel to get the screen point of sample k. `xi` and `zeta` in [0,
  /// 1) place it within its cell; they are not looked at without jitter, where it is on the low corner.
  std::array<double, 2> offset(int k, double xi, double zeta) const {
    const std::array<double, 2>& low = corner(k);
    if (!jitter_) return low;
    return {low[0] + xi * width_ / side_, low[1] + zeta * width_ / side_};
  }
  /// The same without jitter.
  const std::array<double, 2>& corner(int k) const { return corners_[static_cast<std::size_t>(k)]; }
  double weight(int k) const { return weights_[static_cast<std::size_t>(k)]; }
  int sample_number(int k) const { return numbers_[static_cast<std::size_t>(k)]; }

 private:
  int side_;
  bool jitter_;
  double width_;
  std::vector<std::array<double, 2>> corners_;  ///< the low one of each cell, relative to the pixel
  std::vector<double> weights_;
  std::vector<std::uint16_t> numbers_;
};

}  // namespace rayshade
