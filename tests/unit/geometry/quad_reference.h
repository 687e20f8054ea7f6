// SPDX-License-Identifier: MIT
// Quadruple precision for references that are written from the equations of surfaces, apart from the product:
// numbers with 113 bits, vectors of them, and the search for all places where a function changes sign along a
// ray.
#pragma once

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "rayshade/geometry/ray.h"

namespace rayshade::reference {

__extension__ typedef __float128 Quad;

inline Quad absolute(Quad x) { return x < 0 ? -x : x; }

inline Quad root(Quad x) {
  if (!(x > 0)) return 0;
  Quad y = std::sqrt(static_cast<double>(x));
  if (!(y > 0)) return 0;
  for (int i = 0; i < 3; ++i) y = (y + x / y) / 2;  // 53, 106, 113 bits
  return y;
}

struct QuadVec {
  Quad x, y, z;
};
inline QuadVec wide(const Vec3& v) { return {v.x, v.y, v.z}; }
inline QuadVec operator+(const QuadVec& a, const QuadVec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline QuadVec operator-(const QuadVec& a, const QuadVec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline QuadVec operator*(Quad s, const QuadVec& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Quad dot(const QuadVec& a, const QuadVec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Quad length(const QuadVec& a) { return root(dot(a, a)); }
inline QuadVec at(const Ray& ray, Quad t) { return wide(ray.origin) + t * wide(ray.direction); }

using Function = std::function<Quad(Quad)>;
using Slope = std::function<double(double, double)>;

/// Where `f` changes sign in [a, b], ascending, to 72 bits of `width`. |f(x) - f(y)| <= slope(u, v) |x - y|
/// must hold for x, y in [u, v] (f need not be smooth). Two changes closer than `width` may be missed: the
/// caller says which width it does not care for.
inline void sign_changes(const Function& f, Quad a, Quad b, const Slope& slope, Quad width,
                         std::vector<Quad>& out) {
  const Quad middle = (a + b) / 2;
  if (absolute(f(middle)) > slope(static_cast<double>(a), static_cast<double>(b)) * (b - a) / 2) return;
  if (b - a > width) {
    sign_changes(f, a, middle, slope, width, out);
    sign_changes(f, middle, b, slope, width, out);
    return;
  }
  const bool positive = f(a) > 0;
  if (positive == (f(b) > 0)) return;
  for (int i = 0; i < 72 && a < b; ++i) {
    const Quad x = (a + b) / 2;
    ((f(x) > 0) == positive ? a : b) = x;
  }
  out.push_back((a + b) / 2);
}

/// Random numbers of the tests. Every test says its seed.
class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  double between(double a, double b) {
    return a + (b - a) * (static_cast<double>(generator_() >> 11) * 0x1p-53);
  }
  int below(int n) { return static_cast<int>(generator_() % static_cast<unsigned>(n)); }
  Vec3 in_cube(double half) { return {between(-half, half), between(-half, half), between(-half, half)}; }
  Vec3 unit() {
    while (true) {
      const Vec3 v = in_cube(1);
      const double l = rayshade::length(v);
      if (l > 0.1 && l <= 1) return v / l;
    }
  }

 private:
  std::mt19937_64 generator_;
};

}  // namespace rayshade::reference
