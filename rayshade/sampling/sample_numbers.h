// SPDX-License-Identifier: MIT
// The numbers of one eye sample, for whatever needs some: independent ones, or those of the sequences that
// the samples of its pixel share (SamplingKind).
#pragma once

#include "rayshade/sampling/random.h"
#include "rayshade/sampling/sobol.h"
#include "rayshade/scene/settings.h"

namespace rayshade {

class SampleNumbers {
 public:
  /// Of sample number `sample` of the pixel (x, y). `settings` outlives this.
  SampleNumbers(const RenderSettings& settings, int frame, std::uint32_t x, std::uint32_t y,
                std::uint32_t sample)
      : settings_(settings), frame_(frame), x_(x), y_(y), sample_(sample) {}

  /// What the eye ray needs: place in the pixel, two numbers for the lens, one for the moment; in [0, 1).
  /// Those that are not wanted mean nothing.
  struct Eye {
    std::array<double, 2> pixel{}, lens{};
    double moment = 0;
  };
  Eye eye(bool pixel, bool lens, bool moment) const {
    Eye out;
    if (settings_.sobol() && (lens || moment)) {
      const auto all = sobol5(pixel_stream(settings_.seed, frame_, x_, y_),
                              dimension(kRootPath, Purpose::kPixel), sample_);
      // The third dimension goes best with the first two.
      return {{all[0], all[1]}, {all[2], all[3]}, lens ? all[4] : all[2]};
    }
    if (pixel) out.pixel = two(dimension(kRootPath, Purpose::kPixel));
    if (lens) out.lens = two(dimension(kRootPath, Purpose::kLens));
    if (moment) out.moment = two(dimension(kRootPath, Purpose::kTime))[0];
    return out;
  }

  /// Two numbers in [0, 1) for a dimension (random.h).
  std::array<double, 2> two(std::uint64_t dimension) const { return two_of_several(dimension, 0, 1); }
  /// The same where each sample needs `turns` pairs: pair number `turn`. Independent numbers look only at the
  /// dimension.
  std::array<double, 2> two_of_several(std::uint64_t dimension, std::uint32_t turn,
                                       std::uint32_t turns) const {
    if (settings_.sobol())
      return sobol2(pixel_stream(settings_.seed, frame_, x_, y_), dimension, sample_ * turns + turn);
    return uniform2({settings_.seed, frame_, x_, y_, sample_}, dimension);
  }

 private:
  const RenderSettings& settings_;
  int frame_;
  std::uint32_t x_, y_, sample_;
};

}  // namespace rayshade
