// SPDX-License-Identifier: MIT
// compare_pictures A B [--diff OUT.png] [--tolerance N] [--max-share P] [--max-patch N]
//
// Tells how two pictures differ, for tests that hold a rendering against a reference: the share of pixels of
// which a channel differs by more than the tolerance (in units of 1/255, default 0), the largest difference,
// the PSNR, and the largest connected patch of differing pixels, which tells a moved edge (thin, scattered)
// from a missing object. Alpha counts where both pictures have it. Exit status 0: the share is at most
// --max-share (percent, default 0) and the patch at most --max-patch pixels (default: any); 1: it is more, or
// the sizes differ; 2: usage or unreadable file.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "rayshade/image/output_file.h"
#include "rayshade/image/reader.h"
#include "rayshade/image/writer.h"
#include "rayshade/scene/provider.h"

namespace {

using rayshade::Image;

struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Options {
  std::string first, second;
  std::optional<std::string> diff;
  double tolerance = 0, max_share = 0;
  std::optional<double> max_patch;
};

double number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(value >= 0))
    throw UsageError(fmt::format("\"{}\" is not a number from 0 on", text));
  return value;
}

Options parse(const std::vector<std::string>& arguments) {
  Options options;
  std::vector<std::string> files;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (!argument.starts_with("--")) {
      files.push_back(argument);
      continue;
    }
    if (i + 1 == arguments.size()) throw UsageError(argument + " needs a value");
    const std::string& value = arguments[++i];
    if (argument == "--diff") {
      options.diff = value;
    } else if (argument == "--tolerance") {
      options.tolerance = number(value);
    } else if (argument == "--max-share") {
      options.max_share = number(value);
    } else if (argument == "--max-patch") {
      options.max_patch = number(value);
    } else {
      throw UsageError("unknown option " + argument);
    }
  }
  if (files.size() != 2) throw UsageError("two pictures are needed");
  options.first = files[0];
  options.second = files[1];
  return options;
}

Image load(const std::string& name) {
  try {
    return rayshade::read_image(*rayshade::FileProvider().read(name));
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("{}: {}", name, error.what()));
  }
}

// Above the rounding of a difference between codes, so that "--tolerance 1" lets a difference of 1 pass.
constexpr double kRounding = 1e-6;

// Grey counts for all three colours, so that a grey picture can be held against a coloured one.
double sample(const Image& image, std::int64_t x, std::int64_t y, int c) {
  if (c == 3) return image.alpha(x, y);
  return image.value(x, y, image.channels == 1 ? 0 : c);
}

struct Comparison {
  std::vector<double> largest;  // per pixel, in units of 1/255
  double maximum = 0;
  double square_sum = 0;
  std::int64_t samples = 0;
};

Comparison compare(const Image& a, const Image& b) {
  const int channels = a.has_alpha && b.has_alpha ? 4 : 3;
  Comparison result;
  result.largest.reserve(static_cast<std::size_t>(a.width * a.height));
  for (std::int64_t y = 0; y < a.height; ++y) {
    for (std::int64_t x = 0; x < a.width; ++x) {
      double pixel = 0;
      for (int c = 0; c < channels; ++c) {
        const double va = sample(a, x, y, c), vb = sample(b, x, y, c);
        double difference = 255 * std::fabs(va - vb);
        // Not-a-number equals itself only; equal infinities are equal.
        if (std::isnan(va) != std::isnan(vb)) difference = INFINITY;
        if (va == vb || (std::isnan(va) && std::isnan(vb))) difference = 0;
        pixel = std::max(pixel, difference);
        result.square_sum += difference * difference;
      }
      result.largest.push_back(pixel);
      result.maximum = std::max(result.maximum, pixel);
    }
  }
  result.samples = a.width * a.height * channels;
  return result;
}

// Pixels of the largest set of differing ones that touch each other, corners included.
std::int64_t largest_patch(const std::vector<double>& largest, std::int64_t width, double tolerance) {
  const auto height = static_cast<std::int64_t>(largest.size()) / width;
  std::vector<char> open(largest.size());
  for (std::size_t i = 0; i < open.size(); ++i) open[i] = largest[i] > tolerance + kRounding ? 1 : 0;
  std::int64_t best = 0;
  std::vector<std::int64_t> stack;
  for (std::int64_t start = 0; start < width * height; ++start) {
    if (open[static_cast<std::size_t>(start)] == 0) continue;
    open[static_cast<std::size_t>(start)] = 0;
    stack.push_back(start);
    std::int64_t count = 0;
    while (!stack.empty()) {
      const std::int64_t at = stack.back();
      stack.pop_back();
      ++count;
      const std::int64_t x0 = at % width, y0 = at / width;
      for (std::int64_t y = std::max<std::int64_t>(0, y0 - 1); y <= std::min(height - 1, y0 + 1); ++y) {
        for (std::int64_t x = std::max<std::int64_t>(0, x0 - 1); x <= std::min(width - 1, x0 + 1); ++x) {
          const std::int64_t next = y * width + x;
          if (open[static_cast<std::size_t>(next)] == 0) continue;
          open[static_cast<std::size_t>(next)] = 0;
          stack.push_back(next);
        }
      }
    }
    best = std::max(best, count);
  }
  return best;
}

// The differences as colours, eight times as large and lifted, so that a difference of 1 can be seen; pixels
// within the tolerance are black.
void write_difference(const Image& a, const Image& b, const Comparison& result, double tolerance,
                      const std::string& name) {
  rayshade::FrameBufferOptions options;
  options.width = a.width;
  options.height = a.height;
  rayshade::FrameBuffer buffer(options);
  std::vector<double> row(static_cast<std::size_t>(4 * a.width));
  for (std::int64_t y = 0; y < a.height; ++y) {
    for (std::int64_t x = 0; x < a.width; ++x) {
      double* const p = &row[static_cast<std::size_t>(4 * x)];
      const double alpha = std::fabs(sample(a, x, y, 3) - sample(b, x, y, 3));
      const bool counts = result.largest[static_cast<std::size_t>(y * a.width + x)] > tolerance + kRounding;
      for (int c = 0; c < 3; ++c) {
        const double difference = std::max(alpha, std::fabs(sample(a, x, y, c) - sample(b, x, y, c)));
        p[c] = counts ? 0.2 + 8 * difference : 0;
      }
      p[3] = 1;
    }
    // Images start at the bottom, frame buffers at the top.
    buffer.put(rayshade::PixelBlock{0, a.height - 1 - y, a.width, 1, row, {}});
  }
  rayshade::OutputFile file(name);
  rayshade::PictureInfo info;
  info.alpha = false;
  rayshade::write_picture(buffer, rayshade::FileFormat::kPng8, info, file);
  file.commit();
}

int run(const Options& options) {
  const Image a = load(options.first), b = load(options.second);
  if (a.width != b.width || a.height != b.height) {
    fmt::print("sizes differ: {} x {}, {} x {}\n", a.width, a.height, b.width, b.height);
    return 1;
  }
  const Comparison result = compare(a, b);
  const auto differing = std::count_if(result.largest.begin(), result.largest.end(),
                                       [&](double d) { return d > options.tolerance + kRounding; });
  const double share = 100.0 * static_cast<double>(differing) / static_cast<double>(result.largest.size());
  const std::int64_t patch = largest_patch(result.largest, a.width, options.tolerance);
  const double mean_square = result.square_sum / static_cast<double>(result.samples);
  const double psnr = mean_square > 0 ? 10 * std::log10(255.0 * 255.0 / mean_square) : INFINITY;
  fmt::print("differing pixels: {} of {} ({:.4f} %)\n", differing, result.largest.size(), share);
  fmt::print("largest difference: {:.4g} / 255\n", result.maximum);
  fmt::print("PSNR: {:.2f} dB\n", psnr);
  fmt::print("largest patch: {} pixels\n", patch);
  if (options.diff) write_difference(a, b, result, options.tolerance, *options.diff);
  const bool patch_fits = !options.max_patch || static_cast<double>(patch) <= *options.max_patch;
  return share <= options.max_share && patch_fits ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(parse(std::vector<std::string>(argv + 1, argv + argc)));
  } catch (const UsageError& error) {
    fmt::print(
        stderr,
        "compare_pictures: {}\n"
        "usage: compare_pictures A B [--diff OUT.png] [--tolerance N] [--max-share P] [--max-patch N]\n",
        error.what());
  } catch (const std::exception& error) {
    fmt::print(stderr, "compare_pictures: {}\n", error.what());
  }
  return 2;
}
