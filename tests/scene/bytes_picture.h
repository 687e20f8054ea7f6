// SPDX-License-Identifier: MIT
// A picture as the tests see it: 8-bit pixels read from a binary PPM by a reader of their own, and the
// numbers that expectations ask for.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace rayshade::checks {

using Pixel = std::array<int, 3>;

struct Picture {
  int width = 0, height = 0;
  std::vector<Pixel> pixels;  ///< rows from the top

  const Pixel& at(int x, int y) const {
    if (x < 0 || y < 0 || x >= width || y >= height) throw std::runtime_error("no such pixel");
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
  bool operator==(const Picture&) const = default;
};

inline Picture read_ppm(const std::string& bytes) {
  std::istringstream in(bytes);
  std::string magic;
  int maximum = 0;
  Picture picture;
  in >> magic >> picture.width >> picture.height >> maximum;
  if (magic != "P6" || maximum != 255 || picture.width < 1 || picture.height < 1) {
    throw std::runtime_error("not an 8-bit PPM");
  }
  in.get();
  picture.pixels.resize(static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height));
  for (Pixel& pixel : picture.pixels) {
    for (int& value : pixel) value = in.get();
  }
  if (!in || in.peek() != std::istringstream::traits_type::eof())
    throw std::runtime_error("wrong length of a PPM");
  return picture;
}

/// The pixels that have red in them.
struct Lit {
  int count = 0, left = -1, right = -1, top = -1, bottom = -1;
  std::set<int> levels;  ///< their red values
};

inline Lit lit_pixels(const Picture& picture) {
  Lit lit;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const Pixel& p = picture.at(x, y);
      if (p[0] == 0) continue;
      if (lit.count++ == 0) {
        lit.left = lit.right = x;
        lit.top = y;
      }
      lit.left = std::min(lit.left, x);
      lit.right = std::max(lit.right, x);
      lit.bottom = y;
      lit.levels.insert(p[0]);
    }
  }
  return lit;
}

struct Moments {
  double mean = 0, deviation = 0;
};

inline Moments moments(const Picture& picture, std::size_t channel) {
  double sum = 0, squares = 0;
  for (const Pixel& p : picture.pixels) {
    sum += p[channel];
    squares += static_cast<double>(p[channel]) * p[channel];
  }
  const double n = static_cast<double>(picture.pixels.size());
  return {sum / n, std::sqrt(squares / n - sum / n * (sum / n))};
}

}  // namespace rayshade::checks
