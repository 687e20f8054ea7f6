// SPDX-License-Identifier: MIT
// Scenes whose pixels are integrals that can be had without rays: what a picture misses of them falls as
// samples rise, under both schemes of sampling, and is no bias.
//
// The eye is 10 units before the plane y = 0, which shows 2 x 2 units of it: pixel (i, j) is the mean over
// the square of one pixel's side around x = (i - 12) / 12, z = (12 - j) / 12. Sharp pictures are checked as a
// whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "rayshade/lang/parse.h"
#include "rayshade/render/renderer.h"

namespace rayshade {
namespace {

constexpr int kSide = 24;
constexpr double kPixel = 2.0 / kSide;
constexpr double kDistance = 10;
/// 2 atan(1 / 10) in degrees, so that the screen is 2 units wide at the distance of the plane.
constexpr const char* kView =
    "screen 24 24 eyep 0 -10 0 lookp 0 0 0 up 0 0 1 fov 11.42118627449610 filter box 1 background .2 .2 .2\n"
    "light 1 ambient surface white ambient 1 1 1 diffuse 0 0 0\n";

/// The mean of a function over [a, b], by three points of Gauss in each of `steps` parts.
double mean_over(double a, double b, int steps, const std::function<double(double)>& f) {
  const double h = (b - a) / steps, reach = h / 2 * std::sqrt(.6);
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double middle = a + (i + .5) * h;
    sum += (5 * f(middle - reach) + 8 * f(middle) + 5 * f(middle + reach)) / 18;
  }
  return sum / steps;
}

/// The share of [a, b] above `edge`.
double share_above(double a, double b, double edge) { return std::clamp((b - edge) / (b - a), 0.0, 1.0); }

/// A scene and how far its pixel around the point (x, z) of the plane is from .2 to 1. Not from 0: the
/// original refines nothing where all is black.
struct Known {
  std::string scene;
  std::function<double(double, double)> pixel;
};

std::vector<double> render(const Scene& scene, const SettingsOverrides& overrides) {
  const RenderSettings settings = resolve_settings(scene.settings, overrides);
  MemoryProvider provider;
  Renderer renderer(scene, settings, provider, {});
  FrameBufferOptions buffer;
  buffer.width = kSide;
  buffer.height = kSide;
  buffer.storage = PixelStorage::kFloat;
  FrameBuffer picture(buffer);
  const std::atomic<bool> stop{false};
  EXPECT_TRUE(renderer.render_frame({0, picture, stop}));
  std::array<float, 4 * kSide> row{};
  std::vector<double> out;
  for (int y = 0; y < kSide; ++y) {
    picture.read_row(y, reinterpret_cast<std::uint8_t*>(row.data()));
    for (std::size_t x = 0; x < kSide; ++x) out.push_back(static_cast<double>(row[4 * x]));
  }
  return out;
}

/// Errors over all pixels and some seeds.
struct Errors {
  double rms = 0;
  double mean = 0;
  double deviation = 0;  ///< of the mean, from the scatter between seeds
};

class KnownIntegral {
 public:
  explicit KnownIntegral(const Known& known) {
    MemoryProvider provider;
    provider.add("test.ray", kView + known.scene);
    ParseResult result = parse_scene(provider, "test.ray", {});
    for (const Diagnostic& d : result.diagnostics) ADD_FAILURE() << format_diagnostic(d, false);
    scene_ = std::move(result.scene);
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i)
        truth_.push_back(.2 + .8 * known.pixel((i - kSide / 2) * kPixel, (kSide / 2 - j) * kPixel));
    }
  }

  Errors errors(SettingsOverrides overrides) const {
    constexpr int kSeeds = 16;
    Errors out;
    double squares = 0;
    for (int seed = 0; seed < kSeeds; ++seed) {
      overrides.seed = static_cast<std::uint64_t>(seed + 1);
      const std::vector<double> picture = render(scene_, overrides);
      double sum = 0;
      for (std::size_t i = 0; i < picture.size(); ++i) {
        const double e = picture[i] - truth_[i];
        sum += e;
        out.rms += e * e;
      }
      sum /= static_cast<double>(picture.size());
      out.mean += sum / kSeeds;
      squares += sum * sum / kSeeds;
    }
    out.rms = std::sqrt(out.rms / (kSeeds * kSide * kSide));
    out.deviation = std::sqrt(std::max(squares - out.mean * out.mean, 0.0) / (kSeeds - 1));
    return out;
  }

 private:
  Scene scene_;
  std::vector<double> truth_;
};

SettingsOverrides all_samples(SamplingKind kind, int per_side) {
  SettingsOverrides out;
  out.sampling = kind;
  out.samples = per_side;
  if (kind == SamplingKind::kSobol) out.tolerance = 0;
  out.contrast = Color{-2, -2, -2};  // always exceeded
  return out;
}

/// From 4 to 256 samples the error falls at least as samples^-`rate`, and its mean is no more than its
/// scatter explains; under the original scheme, no more than `bias` of the error besides.
void expect_convergence(const Known& known, double rate_original, double rate_sobol, double bias = 0) {
  const KnownIntegral integral(known);
  for (const SamplingKind kind : {SamplingKind::kOriginal, SamplingKind::kSobol}) {
    const bool sobol = kind == SamplingKind::kSobol;
    SCOPED_TRACE(sobol ? "sobol" : "original");
    const Errors few = integral.errors(all_samples(kind, 2)), many = integral.errors(all_samples(kind, 16));
    EXPECT_GT(few.rms, .001) << "nothing to sample";
    const double rate = std::log(few.rms / many.rms) / std::log(64.0);
    EXPECT_GT(rate, sobol ? rate_sobol : rate_original) << few.rms << " to " << many.rms;
    for (const Errors& e : {few, many})
      EXPECT_LT(std::fabs(e.mean), 5 * e.deviation + (sobol ? 1e-7 : 1e-7 + bias * e.rms));
    ::testing::Test::RecordProperty(sobol ? "rate_sobol" : "rate_original", std::to_string(rate));
  }
  // The error of a picture is about what it was allowed to be; it is estimated, pixel by pixel.
  SettingsOverrides tolerant = all_samples(SamplingKind::kSobol, 32);
  for (const double tolerance : {.05, .01}) {
    tolerant.tolerance = tolerance;
    const Errors e = integral.errors(tolerant);
    EXPECT_LT(e.rms, 1.2 * tolerance) << tolerance;
    EXPECT_LT(std::fabs(e.mean), .1 * tolerance) << tolerance;
  }
}

// Edges through the pixel.
TEST(KnownIntegrals, CoverageOfADisc) {
  constexpr double radius = .713, cx = .08, cz = -.05;
  const auto pixel = [](double x, double z) {
    return mean_over(x - kPixel / 2, x + kPixel / 2, 400, [&](double at) {
      const double square = radius * radius - (at - cx) * (at - cx);
      if (square <= 0) return 0.0;
      const double low = z - kPixel / 2, high = z + kPixel / 2, half = std::sqrt(square);
      return std::max(0.0, std::min(high, cz + half) - std::max(low, cz - half)) / kPixel;
    });
  };
  expect_convergence({"disc white .713 .08 0 -.05 0 -1 0", pixel}, .65, .65);
}

// Smooth within the pixel: the light of a lamp close before a wall.
TEST(KnownIntegrals, ShadingAcrossAWall) {
  const auto pixel = [](double x, double z) {
    return mean_over(x - kPixel / 2, x + kPixel / 2, 4, [&](double u) {
      return mean_over(z - kPixel / 2, z + kPixel / 2, 4, [&](double v) {
        return .1 / std::sqrt(.01 + (u - .3) * (u - .3) + (v - .2) * (v - .2));
      });
    });
  };
  expect_convergence({"light 1 point .3 -.1 .2 surface wall ambient .2 .2 .2 diffuse .8 .8 .8\n"
                      "plane wall 0 0 0  0 -1 0",
                      pixel},
                     .9, 1.2);
}

// A square light of side 1, one unit before the wall, and half way a sheet up to x = .25 (as the eye sees it,
// before the wall up to 10 / 9.5 of that), in whose penumbra the rest of the wall lies.
TEST(KnownIntegrals, PenumbraOfASquareLight) {
  const auto lit = [](double u, double v) {
    // The point lx of the light is seen from u where the middle between them is beyond the sheet.
    constexpr double half = .5;
    const double first = std::clamp(.5 - u, -half, half);
    return (half - first) / (2 * half) * mean_over(first, half, 4, [&](double lx) {
             return mean_over(-half, half, 4, [&](double lz) {
               return 1 / std::sqrt(1 + (u - lx) * (u - lx) + (v - lz) * (v - lz));
             });
           });
  };
  const auto pixel = [&lit](double x, double z) {
    const double edge = .25 * kDistance / 9.5, low = x - kPixel / 2, high = x + kPixel / 2;
    if (high <= edge) return 0.0;
    return share_above(low, high, edge) * mean_over(std::max(low, edge), high, 2, [&](double u) {
             return mean_over(z - kPixel / 2, z + kPixel / 2, 1, [&](double v) { return lit(u, v); });
           });
  };
  expect_convergence(
      {"light 1 area -.5 -1 -.5  .5 -1 -.5 1  -.5 -1 .5 1\n"
       "surface wall ambient .2 .2 .2 diffuse .8 .8 .8 surface dark ambient .2 .2 .2 diffuse 0 0 0\n"
       "plane wall 0 0 0  0 -1 0\n"
       "poly dark -50 -.5 -50  .25 -.5 -50  .25 -.5 50  -50 -.5 50",
       pixel},
      .45, .55);
}

// A square lens of side .4: the edge at x = 0 is 10 units away, sharp are 5.
TEST(KnownIntegrals, AnEdgeOutOfFocus) {
  constexpr double lens = .2, focal = 5;
  const auto pixel = [](double x, double z) {
    return mean_over(x - kPixel / 2, x + kPixel / 2, 8, [&](double u) {
      return mean_over(z - kPixel / 2, z + kPixel / 2, 1, [&](double v) {
        // Rays from the lens point s meet those through the pinhole at the focal distance, and the plane at
        // u + s (1 - t), t being the plane's distance over that along the axis.
        const double along = focal * kDistance / std::sqrt(kDistance * kDistance + u * u + v * v);
        const double shift = lens * std::fabs(1 - kDistance / along);
        return share_above(u - shift, u + shift, 0);
      });
    });
  };
  expect_convergence({"aperture .2 focaldist 5\npoly white 0 0 -50  50 0 -50  50 0 50  0 0 50", pixel}, .65,
                     .65);
}

// From x = 0 at the start to .5 at the end. The original has slice s of the shutter in the same part of every
// pixel, so that with so many samples the mean over a moving edge has a bias, small beside the error.
TEST(KnownIntegrals, AMovingEdge) {
  const auto pixel = [](double x, double) {
    return mean_over(x - kPixel / 2, x + kPixel / 2, 64,
                     [](double u) { return std::clamp(u / .5, 0.0, 1.0); });
  };
  expect_convergence({"shutter 1\npoly white -50 0 -50  0 0 -50  0 0 50  -50 0 50 translate (.5 * time) 0 0",
                      [pixel](double x, double z) { return 1 - pixel(x, z); }},
                     .65, .65, .4);
}

}  // namespace
}  // namespace rayshade
