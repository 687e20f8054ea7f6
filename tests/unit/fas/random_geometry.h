// SPDX-License-Identifier: MIT
// Random and adversarial primitives for the tests of the trees, and points of them: ordinary and extreme
// ones.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "fas/fas.h"

namespace fas::test {

using Quad = long double;

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  double uniform(double lo = 0, double hi = 1) {
    return lo + (hi - lo) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }
  /// Spread evenly over the powers of ten from 10^lo to 10^hi.
  double size(double lo, double hi) { return std::pow(10, uniform(lo, hi)); }
  Point in_box(double half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
  Point direction() {
    for (;;) {
      const Point p = in_box(1);
      const double square = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
      if (!(square > 0.01 && square <= 1)) continue;
      const double scale = 1 / std::sqrt(square);
      return {p[0] * scale, p[1] * scale, p[2] * scale};
    }
  }

 private:
  std::mt19937_64 engine_;
};

inline Point along(const Point& p, const Point& d, double t) {
  return {p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]};
}

inline void add(Bounds& box, const Point& p, double radius = 0) {
  for (std::size_t i = 0; i < 3; ++i) {
    box.lo[i] = std::min(box.lo[i], p[i] - radius);
    box.hi[i] = std::max(box.hi[i], p[i] + radius);
  }
}

/// The box around points or balls.
inline void set_box(Geometry& geometry) {
  if (geometry.form == Geometry::Form::kBox) return;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  geometry.box = {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (const Point& p : geometry.points) add(geometry.box, p);
  for (int i = 0; i < geometry.spheres; ++i) add(geometry.box, geometry.center[i], geometry.radius[i]);
}

/// A primitive of about this size about this place.
inline Geometry random_geometry(Dice& dice, const Point& at, double size) {
  Geometry out;
  switch (dice.below(8)) {
    case 0: {
      out.form = Geometry::Form::kBox;
      for (std::size_t i = 0; i < 3; ++i) {
        out.box.lo[i] = at[i] - size * dice.uniform();
        out.box.hi[i] = at[i] + (dice.below(5) ? size * dice.uniform() : 0);
      }
      break;
    }
    case 1:
    case 2:
    case 3: {  // triangles, often needles
      out.form = Geometry::Form::kPolygon;
      const Point b = along(at, dice.direction(), size);
      Point c = along(at, dice.direction(), size);
      if (dice.below(2)) {
        for (std::size_t i = 0; i < 3; ++i) c[i] = at[i] + dice.uniform() * (b[i] - at[i]);
        c = along(c, dice.direction(), dice.below(4) ? size * dice.size(-12, -1) : 0);
      }
      out.points = {at, b, c};
      break;
    }
    case 4: {  // any points, or the corners of a polygon
      out.form = dice.below(2) ? Geometry::Form::kPoints : Geometry::Form::kPolygon;
      const Point u = dice.direction(), w = dice.direction();
      const int corners = 3 + dice.below(6);
      for (int i = 0; i < corners; ++i) {
        const double angle = 6.283185307179586 * i / corners;
        out.points.push_back(along(along(at, u, size * std::cos(angle)), w, size * std::sin(angle)));
      }
      break;
    }
    case 5: {
      out.form = Geometry::Form::kSpheres;
      out.spheres = 1;
      out.center[0] = at;
      out.radius[0] = dice.below(8) ? size : 0;
      break;
    }
    default: {
      out.form = Geometry::Form::kSpheres;
      out.spheres = 2;
      out.center[0] = at;
      out.center[1] = along(at, dice.direction(), size * (dice.below(5) ? 1 : dice.size(-9, 0)));
      for (double& radius : out.radius) radius = dice.below(5) ? size * dice.size(-5, 0) : 0;
    }
  }
  set_box(out);
  return out;
}

/// A point of the hull. Corners, edges and silhouettes as seen from `apex` are common.
inline std::array<Quad, 3> random_point(Dice& dice, const Geometry& geometry, const Point& apex) {
  std::array<Quad, 3> out{};
  const auto share = [&] { return dice.below(3) ? dice.uniform() : static_cast<double>(dice.below(2)); };
  if (geometry.form == Geometry::Form::kBox) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double t = share();
      out[i] = t == 1 ? static_cast<Quad>(geometry.box.hi[i])
                      : geometry.box.lo[i] + t * (static_cast<Quad>(geometry.box.hi[i]) - geometry.box.lo[i]);
    }
    return out;
  }
  if (geometry.form != Geometry::Form::kSpheres) {
    const auto n = static_cast<int>(geometry.points.size());
    const Point &a = geometry.points[static_cast<std::size_t>(dice.below(n))],
                &b = geometry.points[static_cast<std::size_t>(dice.below(n))],
                &c = geometry.points[static_cast<std::size_t>(dice.below(n))];
    const Quad s = share(), t = dice.below(2) ? dice.uniform() : 0;
    for (std::size_t i = 0; i < 3; ++i)
      out[i] = (1 - t) * ((1 - s) * static_cast<Quad>(a[i]) + s * b[i]) + t * static_cast<Quad>(c[i]);
    return out;
  }
  const Quad s = geometry.spheres == 2 ? share() : 0;
  const int other = geometry.spheres - 1;
  std::array<Quad, 3> center;
  for (std::size_t i = 0; i < 3; ++i)
    center[i] = (1 - s) * static_cast<Quad>(geometry.center[0][i]) + s * geometry.center[other][i];
  const Quad radius = (1 - s) * static_cast<Quad>(geometry.radius[0]) + s * geometry.radius[other];
  // A direction, made to lie on the silhouette every other time.
  const Point d = dice.direction();
  std::array<Quad, 3> n{d[0], d[1], d[2]};
  std::array<Quad, 3> toward;
  Quad square = 0, product = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    toward[i] = center[i] - apex[i];
    square += toward[i] * toward[i];
  }
  if (dice.below(3) == 0) {  // where a coordinate is largest or smallest
    const std::size_t k = static_cast<std::size_t>(dice.below(3));
    n[k] = 0;
  }
  for (std::size_t i = 0; i < 3; ++i) product += n[i] * toward[i];
  if (dice.below(2) && square > radius * radius) {
    // Normal to the cone of tangents: n . toward = -radius.
    Quad across = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      n[i] -= product / square * toward[i];
      across += n[i] * n[i];
    }
    const Quad sine = radius / std::sqrt(square), cosine = std::sqrt(1 - sine * sine);
    if (across > 0)
      for (std::size_t i = 0; i < 3; ++i)
        n[i] = n[i] * cosine / std::sqrt(across) - toward[i] * sine / std::sqrt(square);
  }
  Quad length = 0;
  for (std::size_t i = 0; i < 3; ++i) length += n[i] * n[i];
  length = std::sqrt(length);
  for (std::size_t i = 0; i < 3; ++i) out[i] = center[i] + (length > 0 ? radius * n[i] / length : 0);
  return out;
}

}  // namespace fas::test
