// SPDX-License-Identifier: MIT
// Axis-aligned boxes.
#pragma once

#include <limits>

#include "rayshade/math/affine.h"
#include "rayshade/math/vec.h"

namespace rayshade {

/// The closed box [lo, hi]. The default box is empty: it holds no point, and joining it to another changes
/// nothing.
struct Bounds3 {
  static constexpr double kInf = std::numeric_limits<double>::infinity();
  Vec3 lo{kInf, kInf, kInf};
  Vec3 hi{-kInf, -kInf, -kInf};

  static Bounds3 everything() { return {{-kInf, -kInf, -kInf}, {kInf, kInf, kInf}}; }

  bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
  /// True where some side is infinite (planes).
  bool unbounded() const { return !empty() && !(is_finite(lo) && is_finite(hi)); }
  void add(const Vec3& p) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  }
  void add(const Bounds3& b) {
    lo = {std::min(lo.x, b.lo.x), std::min(lo.y, b.lo.y), std::min(lo.z, b.lo.z)};
    hi = {std::max(hi.x, b.hi.x), std::max(hi.y, b.hi.y), std::max(hi.z, b.hi.z)};
  }
  bool contains(const Vec3& p) const {
    return p.x >= lo.x && p.x <= hi.x && p.y >= lo.y && p.y <= hi.y && p.z >= lo.z && p.z <= hi.z;
  }
  Vec3 center() const { return (lo + hi) * 0.5; }
  Vec3 extent() const { return hi - lo; }
  double largest_extent() const { return empty() ? 0 : max_abs(hi - lo); }
};

inline Bounds3 join(const Bounds3& a, const Bounds3& b) {
  Bounds3 out = a;
  out.add(b);
  return out;
}

inline Bounds3 intersection(const Bounds3& a, const Bounds3& b) {
  return {{std::max(a.lo.x, b.lo.x), std::max(a.lo.y, b.lo.y), std::max(a.lo.z, b.lo.z)},
          {std::min(a.hi.x, b.hi.x), std::min(a.hi.y, b.hi.y), std::min(a.hi.z, b.hi.z)}};
}

/// `b` grown by an absolute margin on every side; empty and unbounded boxes stay as they are.
inline Bounds3 grown(const Bounds3& b, double margin) {
  const Vec3 m{margin, margin, margin};
  return b.empty() ? b : Bounds3{b.lo - m, b.hi + m};
}

/// The box of the eight transformed corners, grown by a bound of its own rounding; unbounded stays unbounded.
inline Bounds3 transformed(const Bounds3& b, const Affine& map) {
  if (b.empty()) return b;
  if (b.unbounded()) return Bounds3::everything();
  Bounds3 out;
  double size = max_abs(map.translation);
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p{corner & 1 ? b.hi.x : b.lo.x, corner & 2 ? b.hi.y : b.lo.y, corner & 4 ? b.hi.z : b.lo.z};
    const Vec3 sum = std::fabs(p.x) * abs(map.rows[0]) + std::fabs(p.y) * abs(map.rows[1]) +
                     std::fabs(p.z) * abs(map.rows[2]);
    size = std::max(size, max_abs(sum));
    out.add(map.point(p));
  }
  return grown(out, 8 * std::numeric_limits<double>::epsilon() * size);
}

}  // namespace rayshade
