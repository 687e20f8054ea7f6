// SPDX-License-Identifier: MIT
// Points, vectors and colours: three doubles each, with the arithmetic that the renderer needs.
#pragma once

#include <algorithm>
#include <cmath>

namespace rayshade {

// The original's two universal constants (language.md conventions): the general tolerance and infinite
// distance.
inline constexpr double kEpsilon = 1e-5;
inline constexpr double kFar = 1e14;

struct Vec3 {
  double x = 0, y = 0, z = 0;

  constexpr double operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr double& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr bool operator==(const Vec3&) const = default;
};

constexpr Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
constexpr Vec3 operator*(const Vec3& a, double s) { return {a.x * s, a.y * s, a.z * s}; }
constexpr Vec3 operator*(double s, const Vec3& a) { return {a.x * s, a.y * s, a.z * s}; }
constexpr Vec3 operator/(const Vec3& a, double s) { return {a.x / s, a.y / s, a.z / s}; }
constexpr Vec3& operator+=(Vec3& a, const Vec3& b) { return a = a + b; }
constexpr Vec3& operator-=(Vec3& a, const Vec3& b) { return a = a - b; }
constexpr Vec3& operator*=(Vec3& a, double s) { return a = a * s; }

constexpr double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
constexpr double length_squared(const Vec3& a) { return dot(a, a); }
inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }
inline Vec3 abs(const Vec3& a) { return {std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)}; }
inline double max_abs(const Vec3& a) { return std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)}); }
/// At least the length of `a`, and at most 1.74 times it: for bounds, where a root would cost more than it is
/// worth.
inline double length_bound(const Vec3& a) { return std::fabs(a.x) + std::fabs(a.y) + std::fabs(a.z); }
inline bool is_finite(const Vec3& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// `a` scaled to unit length; unchanged where its length is zero or not finite (objects.md 1.8, FIX). Vectors
/// whose squared length would under- or overflow are scaled first.
inline Vec3 normalize(const Vec3& a) {
  const double square = dot(a, a);
  if (square > 1e-280 && square < 1e280) return a / std::sqrt(square);
  const double largest = max_abs(a);
  if (!(largest > 0) || !std::isfinite(largest)) return a;
  const Vec3 scaled = a / largest;
  return scaled / length(scaled);
}

/// The "Norm" of textures.md 0: `a` is left unchanged where it is shorter than kEpsilon; there the threshold
/// is named.
inline Vec3 normalize_above_epsilon(const Vec3& a) {
  const double len = length(a);
  return len < kEpsilon ? a : a / len;
}

/// The index (0, 1, 2) of the component of largest magnitude, in the original's order of preference
/// (objects.md 4.4): x only if strictly larger than both others, then y only if strictly larger than z.
inline int dominant_axis(const Vec3& a) {
  const Vec3 m = abs(a);
  if (m.x > m.y && m.x > m.z) return 0;
  return m.y > m.z ? 1 : 2;
}

/// Two unit axes perpendicular to `n` of any length (the CoordSys of textures.md 0 and shading.md 4.2). What
/// counts as along z is a question of direction: vectors toward a light are as short as the scene is small.
inline void coordinate_system(const Vec3& n, Vec3& u, Vec3& w) {
  u = {-n.y, n.x, 0};
  if (length(u) < kEpsilon * length(n)) u = {n.z, 0, -n.x};
  u = normalize(u);
  w = normalize(cross(n, u));
}

/// Linear red, green, blue; unbounded.
struct Color {
  double r = 0, g = 0, b = 0;
  constexpr bool operator==(const Color&) const = default;
};

constexpr Color operator+(const Color& a, const Color& b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
constexpr Color operator-(const Color& a, const Color& b) { return {a.r - b.r, a.g - b.g, a.b - b.b}; }
constexpr Color operator*(const Color& a, const Color& b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
constexpr Color operator*(const Color& a, double s) { return {a.r * s, a.g * s, a.b * s}; }
constexpr Color operator*(double s, const Color& a) { return {a.r * s, a.g * s, a.b * s}; }
constexpr Color& operator+=(Color& a, const Color& b) { return a = a + b; }
constexpr Color& operator*=(Color& a, double s) { return a = a * s; }
constexpr Color& operator*=(Color& a, const Color& b) { return a = a * b; }

}  // namespace rayshade
