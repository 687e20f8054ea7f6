// SPDX-License-Identifier: MIT
// A fractal mountain by midpoint displacement (A. Fournier, D. Fussell, L. Carpenter, "Computer rendering of
// stochastic models", CACM 25(6), 1982) and four glass spheres above its slope.
//
// Every height is a function of its place alone, so that neighbouring patches agree and detail only adds to
// the form. The displacement is Gaussian by Marsaglia's polar method on the congruential generator 8121,
// 28411, 134456, seeded with the place; on the published data of size 6 this reproduces all 4225 heights.
#include <cstdint>

#include "rayshade/math/functions.h"
#include "scenes/spd/databases.h"

namespace rayshade::spd {
namespace {

constexpr std::int64_t kModulus = 134456, kMultiplier = 8121, kIncrement = 28411;
constexpr std::int64_t kMountain = 21;  // another number, another mountain
// Places are counted in 128ths of the side. Below that the seed is advanced by a stride of its own, prime to
// the modulus, so that no two neighbours share one.
constexpr int kSeedCells = 128;
constexpr std::int64_t kFineStride = 50021;

class Generator {
 public:
  explicit Generator(std::int64_t seed) : state_(seed % kModulus) {}

  double uniform() {
    state_ = (kMultiplier * state_ + kIncrement) % kModulus;
    return static_cast<double>(state_) / kModulus;
  }

  double gaussian() {
    while (true) {
      const double u = 2 * uniform() - 1, v = 2 * uniform() - 1;
      const double square = u * u + v * v;
      if (square > 0 && square < 1) return u * std::sqrt(-2 * fn::log(square) / square);
    }
  }

 private:
  std::int64_t state_;
};

class Mountain {
 public:
  explicit Mountain(int size)
      : cells_(1 << size), heights_(static_cast<std::size_t>(cells_ + 1) * (cells_ + 1)) {
    for (int step = cells_; step > 1; step /= 2) displace(step);
  }

  int cells() const { return cells_; }
  Vec3 point(int x, int y) const { return {2.0 * x / cells_ - 1, 2.0 * y / cells_ - 1, height(x, y)}; }

 private:
  double height(int x, int y) const { return heights_[static_cast<std::size_t>(y) * (cells_ + 1) + x]; }
  double& height(int x, int y) { return heights_[static_cast<std::size_t>(y) * (cells_ + 1) + x]; }

  // Standard deviation 1 at a distance of 1 between the points that are averaged, times the distance.
  double displacement(int x, int y, double distance) const {
    static const double scale = std::sqrt(fn::cbrt(2) - 1) / 2;
    const std::int64_t px = static_cast<std::int64_t>(x) * kSeedCells,
                       py = static_cast<std::int64_t>(y) * kSeedCells;
    const std::int64_t seed = kMountain + px / cells_ + 256 * (py / cells_) +
                              kFineStride * (px % cells_ + (py % cells_) * std::int64_t{cells_} * 3);
    return scale * distance * Generator(seed).gaussian();
  }

  // Squares of `step` cells are divided in four: the middles of their edges first, then their own.
  void displace(int step) {
    const int half = step / 2;
    const double edge = 2.0 * step / cells_;
    for (int y = 0; y <= cells_; y += step)
      for (int x = half; x <= cells_; x += step)
        height(x, y) = (height(x - half, y) + height(x + half, y)) / 2 + displacement(x, y, edge);
    for (int y = half; y <= cells_; y += step)
      for (int x = 0; x <= cells_; x += step)
        height(x, y) = (height(x, y - half) + height(x, y + half)) / 2 + displacement(x, y, edge);
    for (int y = half; y <= cells_; y += step)
      for (int x = half; x <= cells_; x += step)
        height(x, y) = (height(x - half, y - half) + height(x + half, y - half) + height(x - half, y + half) +
                        height(x + half, y + half)) /
                           4 +
                       displacement(x, y, edge * std::sqrt(2.0));
  }

  int cells_;
  std::vector<double> heights_;
};

// The quarters in turn: along x, up, back.
void write_square(Writer& writer, const Mountain& mountain, int x, int y, int step) {
  if (step == 1) {
    const Vec3 a = mountain.point(x, y), b = mountain.point(x + 1, y), c = mountain.point(x + 1, y + 1),
               d = mountain.point(x, y + 1);
    writer.polygon(std::array<Vec3, 3>{a, b, c});
    writer.polygon(std::array<Vec3, 3>{c, d, a});
    return;
  }
  const int half = step / 2;
  write_square(writer, mountain, x, y, half);
  write_square(writer, mountain, x + half, y, half);
  write_square(writer, mountain, x + half, y + half, half);
  write_square(writer, mountain, x, y + half, half);
}

// Four equal spheres that touch, one on top of three.
void write_spheres(Writer& writer) {
  constexpr double kRadius = 0.17;
  const Vec3 top{-0.8, 0.8, 1.20821};
  writer.sphere(kRadius, top);
  const double drop = 2 * kRadius * std::sqrt(2.0 / 3), out = 2 * kRadius / std::sqrt(3.0);
  for (const int degrees : {-45, 75, 195}) {
    const double angle = degrees * (fn::kPi / 180);
    writer.sphere(kRadius, top + Vec3{out * fn::cos(angle), out * fn::sin(angle), -drop});
  }
}

}  // namespace

void generate_mount(int size, Writer& writer) {
  View view;
  view.eye = {-1.6, 1.6, 1.7};
  view.lights = {{{-100, -100, 100}, 1}};
  writer.header("mount", view);
  writer.surface({.color = {1, 1, 1},
                  .diffuse = 0.1,
                  .highlight = 0.4,
                  .exponent = 101.148,
                  .reflection = 0.1,
                  .transmission = 0.9,
                  .index = 1.5});
  write_spheres(writer);
  writer.surface({.color = {1, 0.9, 0.7}, .diffuse = 0.5});
  const Mountain mountain(size);
  write_square(writer, mountain, 0, 0, mountain.cells());
}

}  // namespace rayshade::spd
