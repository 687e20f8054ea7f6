// SPDX-License-Identifier: MIT
// picture_errors PICTURE REFERENCE
//
// How far a picture is from a converged one, as three numbers in a line:
//
//   RMSE   the root of the mean square difference, over pixels and channels;
//   P999   the 99.9th percentile over the pixels of the root of the mean square over the channels;
//   SSIM   the mean structural similarity of the luma, 1 for equal pictures (Z. Wang, A. C. Bovik, H. R.
//   Sheikh,
//          E. P. Simoncelli, "Image quality assessment: from error visibility to structural similarity", IEEE
//          Trans. Image Processing 13(4), 2004): Gaussian windows of 11 x 11 with a deviation of 1.5, K1 =
//          .01, K2 = .03, only windows that lie within the picture.
//
// Values are those stored, clamped to [0, 1]; luma has the weights of Rec. 709. The reference may be a whole
// multiple as wide and high: its pixels are then averaged. Exit status 2: usage, an unreadable file or sizes
// that do not fit.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include "rayshade/image/reader.h"
#include "rayshade/scene/provider.h"

namespace {

using rayshade::Image;
using Rgb = std::array<double, 3>;

/// Colours in [0, 1], row by row.
struct Picture {
  std::int64_t width = 0, height = 0;
  std::vector<Rgb> pixels;
  const Rgb& at(std::int64_t x, std::int64_t y) const {
    return pixels[static_cast<std::size_t>(y * width + x)];
  }
};

Image load(const std::string& name) {
  try {
    return rayshade::read_image(*rayshade::FileProvider().read(name));
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("{}: {}", name, error.what()));
  }
}

/// The mean over each square of `step` x `step` pixels, which fit in whole numbers.
Picture shrink(const Image& image, std::int64_t step) {
  Picture out{image.width / step, image.height / step, {}};
  for (std::int64_t y = 0; y < out.height; ++y) {
    for (std::int64_t x = 0; x < out.width; ++x) {
      Rgb sum{};
      for (std::int64_t i = 0; i < step * step; ++i) {
        for (int c = 0; c < 3; ++c) {
          sum[static_cast<std::size_t>(c)] += std::clamp(
              image.value(x * step + i % step, y * step + i / step, image.channels == 1 ? 0 : c), 0.0, 1.0);
        }
      }
      for (double& s : sum) s /= static_cast<double>(step * step);
      out.pixels.push_back(sum);
    }
  }
  return out;
}

/// Per pixel, the mean square difference over the channels.
std::vector<double> squares(const Picture& a, const Picture& b) {
  std::vector<double> out;
  out.reserve(a.pixels.size());
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double d = a.pixels[i][c] - b.pixels[i][c];
      sum += d * d;
    }
    out.push_back(sum / 3);
  }
  return out;
}

double luma(const Rgb& p) { return .2126 * p[0] + .7152 * p[1] + .0722 * p[2]; }

constexpr int kWindow = 11;

double mean_ssim(const Picture& a, const Picture& b) {
  std::array<double, kWindow> bell{};
  double total = 0;
  for (int i = 0; i < kWindow; ++i) {
    const double d = i - kWindow / 2;
    total += bell[static_cast<std::size_t>(i)] = std::exp(-d * d / (2 * 1.5 * 1.5));
  }
  for (double& w : bell) w /= total;
  constexpr double c1 = .01 * .01, c2 = .03 * .03;
  double sum = 0;
  std::int64_t windows = 0;
  for (std::int64_t y = 0; y + kWindow <= a.height; ++y) {
    for (std::int64_t x = 0; x + kWindow <= a.width; ++x) {
      double ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
      for (int j = 0; j < kWindow; ++j) {
        for (int i = 0; i < kWindow; ++i) {
          const double w = bell[static_cast<std::size_t>(i)] * bell[static_cast<std::size_t>(j)];
          const double va = luma(a.at(x + i, y + j)), vb = luma(b.at(x + i, y + j));
          ma += w * va;
          mb += w * vb;
          aa += w * va * va;
          bb += w * vb * vb;
          ab += w * va * vb;
        }
      }
      sum += (2 * ma * mb + c1) * (2 * (ab - ma * mb) + c2) /
             ((ma * ma + mb * mb + c1) * (aa - ma * ma + bb - mb * mb + c2));
      ++windows;
    }
  }
  return sum / static_cast<double>(windows);
}

void run(const std::string& picture, const std::string& reference) {
  const Image a = load(picture), b = load(reference);
  const std::int64_t step = a.width > 0 ? b.width / a.width : 0;
  if (step < 1 || b.width != step * a.width || b.height != step * a.height) {
    throw std::runtime_error(
        fmt::format("sizes do not fit: {} x {}, {} x {}", a.width, a.height, b.width, b.height));
  }
  if (std::min(a.width, a.height) < kWindow) {
    throw std::runtime_error(fmt::format("pictures need at least {} x {} pixels", kWindow, kWindow));
  }
  const Picture mine = shrink(a, 1), truth = shrink(b, step);
  std::vector<double> errors = squares(mine, truth);
  double sum = 0;
  for (const double e : errors) sum += e;
  const double rmse = std::sqrt(sum / static_cast<double>(errors.size()));
  std::sort(errors.begin(), errors.end());
  // Nearest rank: the smallest value that at least 99.9 % do not exceed.
  const std::size_t rank = (errors.size() * 999 + 999) / 1000;
  fmt::print("{:.7f} {:.6f} {:.6f}\n", rmse, std::sqrt(errors[rank - 1]), mean_ssim(mine, truth));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 3) throw std::runtime_error("usage: picture_errors PICTURE REFERENCE");
    run(argv[1], argv[2]);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "picture_errors: {}\n", error.what());
  }
  return 2;
}
