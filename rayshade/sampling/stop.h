// SPDX-License-Identifier: MIT
// When a pixel has samples enough (SamplingKind::kSobol).
//
// Samples come in rounds that double their number, so that what a pixel has is a stratified set at every end
// of a round. A pixel gets no more when the estimated standard error of its mean is at most what is allowed.
// The mean of n stratified samples of something with an edge in it, the usual case, has a variance that falls
// with n^(-3/2); so the error is taken to be sqrt(v) n^(-3/4), v being the variance of a single sample.
//
// Allowed is the tolerance at nine samples, and the more the more samples there are: tolerance (n / 9)^(1/4).
// The error of the whole picture would be least, for its samples, if each pixel stopped where a further
// sample takes the same from the sum of the squares, which falls with n^(-5/2): those with much variance
// would be left with much more error than others. One error for all would spend most samples on few pixels.
// This is midway; it was measured to be as good as the former (bench-accuracy).
//
// Few samples tell little about v: two that happen to agree do not show that there is no edge. So v is
// estimated together with a *prior*: the variance over the first samples of the 3 x 3 pixels around, beyond
// what a linear ramp explains, which counts as so many further samples of the pixel itself. Calm regions stop
// with their first samples; pixels beside an edge get some more before they are believed.
//
// The choice depends on first samples no farther than kStopReach pixels and on the pixel's own samples: any
// tile, window or crop gives the same bytes.
#pragma once

#include <array>

#include "rayshade/math/vec.h"

namespace rayshade {

inline constexpr int kStopReach = 1;
/// Samples that every pixel gets, where it may have so many: the fewest that have a variance. Four cost calm
/// regions twice as much and made the median scene of bench-accuracy take a third longer for its error.
inline constexpr int kFirstSamples = 2;

/// The samples of a pixel so far, as sums.
struct SampleSums {
  Color sum, squares;
  int count = 0;
  int hits = 0;
  void add(const Color& color, bool hit) {
    sum += color;
    squares += color * color;
    ++count;
    hits += hit;
  }
  Color mean() const { return sum * (1.0 / count); }
  /// The sum of the squared differences from the mean.
  Color scatter() const { return squares - sum * sum * (1.0 / count); }
};

/// What a pixel's first samples tell its neighbours.
struct SampleMoments {
  Color mean, square, scatter;  ///< `square`: of the mean
  explicit SampleMoments(const SampleSums& sums)
      : mean(sums.mean()), square(mean * mean), scatter(sums.scatter()) {}
};

class StopRule {
 public:
  /// `tolerance`: of the standard error at nine samples, mean square over the channels; 0: no pixel stops
  /// before it has `most` samples.
  StopRule(double tolerance, int most) : square_(tolerance * tolerance), most_(most) {}

  /// Samples of the first round.
  int first() const { return square_ > 0 && most_ > kFirstSamples ? kFirstSamples : most_; }
  /// Samples after the round that follows the one that ended with `count`.
  int next(int count) const;

  /// The variance of a single sample that the first samples of a pixel's surroundings suggest. `around`: the
  /// 3 x 3 pixels, row by row, those beyond the screen replaced by the nearest on it; all of `count` samples.
  static Color prior(const std::array<const SampleMoments*, 9>& around, int count);

  /// Whether the pixel stops.
  bool enough(const SampleSums& pixel, const Color& prior) const;

 private:
  double square_;
  int most_;
};

}  // namespace rayshade
