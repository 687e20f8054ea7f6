// SPDX-License-Identifier: MIT
// The primitives once more, in 113 bits and from other equations than the product's (rule 16): every place
// where the line of a ray meets the surface, with how safely it lies within the shape's extent, the height of
// any point over the surface, and the normal. No frames, no canonical spaces, no stable forms: the
// precision pays for plain algebra.
#pragma once

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <vector>

#include "rayshade/geometry/ray.h"
#include "rayshade/scene/shape.h"

namespace rayshade::quad {

using Q = boost::multiprecision::cpp_bin_float_quad;

struct V {
  Q x, y, z;
  V() = default;
  V(const Q& a, const Q& b, const Q& c) : x(a), y(b), z(c) {}
  V(const Vec3& v) : x(v.x), y(v.y), z(v.z) {}  // NOLINT: implicit on purpose
  const Q& operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
};
inline V operator+(const V& a, const V& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline V operator-(const V& a, const V& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline V operator*(const Q& s, const V& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Q dot(const V& a, const V& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline V cross(const V& a, const V& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Q length(const V& a) { return sqrt(dot(a, a)); }
inline V unit(const V& a) { return (1 / length(a)) * a; }
inline Vec3 rounded(const V& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

struct Line {
  V o, d;
  explicit Line(const Ray& ray) : o(ray.origin), d(ray.direction) {}
  V at(const Q& t) const { return o + t * d; }
};

/// A place where the line meets the surface, extended beyond its rim.
struct Crossing {
  Q t;
  Q inside;          ///< distance to the rim, negative outside; huge where there is none
  Q cosine;          ///< |n.d| / |d|
  Q curvature = -1;  ///< radius of curvature in the direction of the line; negative for flat ones
  Q turning = -1;    ///< smallest radius of curvature
  Q softness = 0;    ///< a size that takes part as well: what the surface's own equation rounds
};

/// Surface coordinates, and how far one goes on the surface for a unit of each; 0: not defined there.
struct Coordinates {
  Q u, v, along_u, along_v;
  bool cyclic_u = false, cyclic_v = false;
};

struct Crossings {
  std::vector<Crossing> all;
  /// How far the line is from where the number of crossings changes, as a length.
  Q from_tangency = 1e300;
};

inline void keep_nearest(Q& best, const Q& candidate) {
  if (candidate < best) best = candidate;
}

/// The two points at a distance `half` from the closest approach at t = `middle`.
inline void add_pair(Crossings& out, const Q& a, const Q& middle, const Q& square) {
  if (square < 0) return;
  const Q half = sqrt(square / a);
  out.all.push_back({middle - half, 1e300, 0, 0, 0});
  out.all.push_back({middle + half, 1e300, 0, 0, 0});
}

class Sphere {
 public:
  explicit Sphere(const shape::Sphere& s) : c_(s.center), r_(s.radius) {}
  Crossings crossings(const Line& line) const {
    const Q a = dot(line.d, line.d);
    const Q middle = dot(c_ - line.o, line.d) / a;
    const V closest = line.at(middle) - c_;
    Crossings out;
    out.from_tangency = abs(r_ - length(closest));
    add_pair(out, a, middle, r_ * r_ - dot(closest, closest));
    for (Crossing& k : out.all) {
      k.cosine = abs(dot(unit(line.at(k.t) - c_), unit(line.d)));
      k.curvature = k.turning = r_;
    }
    return out;
  }
  Q height(const V& p) const { return length(p - c_) - r_; }
  V normal(const V& p) const { return unit(p - c_); }

 protected:
  V c_;
  Q r_;
};

/// Cylinder and cone: |m x (p - e)| = |m| R(s) with s = (p - e).m / m.m along the axis m, R linear in s, 0 <=
/// s <= 1.
class Wall {
 public:
  explicit Wall(const shape::Cylinder& c) : e_(c.bottom), m_(V(c.top) - e_), r0_(c.radius), r1_(c.radius) {}
  explicit Wall(const shape::Cone& c)
      : e_(c.bottom), m_(V(c.top) - e_), r0_(c.bottom_radius), r1_(c.top_radius) {}
  Crossings crossings(const Line& line) const {
    // F(t) = |m x p|^2 - m.m R^2 is quadratic: its coefficients from three of its values.
    // The step is of the size of the distance, so that these differ.
    const Q step = (length(line.o - e_) + length(m_)) / length(line.d);
    const Q f0 = f(line.at(0)), fp = f(line.at(step)), fm = f(line.at(-step));
    const Q a = (fp + fm) / 2 - f0, b = (fp - fm) / 2, c = f0;
    Crossings out;
    const Q discriminant = b * b - 4 * a * c;
    // This is 4 |m|^4 step^2 times |v|^2 - across^2 of wall.h; the number of roots changes where v = across.
    const V h = cross(m_, line.o - e_), hd = cross(m_, step * line.d);
    const Q across = abs(dot(cross(h, hd), unit(m_))), scale = dot(m_, m_) * step * length(line.d);
    const Q size = sqrt(abs(discriminant / 4 + across * across));
    const Q tilt = (r1_ - r0_) / length(m_);
    out.from_tangency = abs(size - across) / scale / sqrt(1 + tilt * tilt);
    if (abs(discriminant) < 1e-28 * (b * b + 4 * abs(a * c))) out.from_tangency = 0;  // not known even here
    if (discriminant < 0) return out;
    const Q root = sqrt(discriminant);
    std::vector<Q> roots;
    if (a == 0) {
      if (b != 0) roots = {-c / b};
    } else {
      roots = {(-b - root) / (2 * a), (-b + root) / (2 * a)};
    }
    std::sort(roots.begin(), roots.end());
    for (const Q& r : roots) {
      const Q t = r * step;
      const V p = line.at(t);
      const Q s = dot(p - e_, m_) / dot(m_, m_);
      // Curvature is around the axis only.
      const Q along =
          (dot(line.d, m_) / length(m_) + tilt * (radius(s) < 0 ? -1 : 1) * dot(line.d, radial(p))) /
          (length(line.d) * sqrt(1 + tilt * tilt));
      const Q turning_radius = abs(radius(s)) * sqrt(1 + tilt * tilt);
      out.all.push_back({t, (s < 1 - s ? s : Q(1 - s)) * length(m_), abs(dot(normal(p), unit(line.d))),
                         turning_radius / (1 - along * along), turning_radius});
    }
    return out;
  }
  Q height(const V& p) const {
    const Q s = dot(p - e_, m_) / dot(m_, m_);
    const Q tilt = (r1_ - r0_) / length(m_);
    return (length(cross(m_, p - e_)) / length(m_) - abs(radius(s))) / sqrt(1 + tilt * tilt);
  }
  V normal(const V& p) const {  // from the axis to p, tilted
    const Q s = dot(p - e_, m_) / dot(m_, m_);
    const Q sign = radius(s) < 0 ? -1 : 1;
    return sign * unit(radial(p) - sign * ((r1_ - r0_) / dot(m_, m_)) * m_);
  }

 protected:
  V radial(const V& p) const { return unit(p - e_ - (dot(p - e_, m_) / dot(m_, m_)) * m_); }
  Q radius(const Q& s) const { return r0_ + s * (r1_ - r0_); }
  Q f(const V& p) const {
    const V moment = cross(m_, p - e_);
    const Q r = radius(dot(p - e_, m_) / dot(m_, m_));
    return dot(moment, moment) - dot(m_, m_) * r * r;
  }
  V e_, m_;
  Q r0_, r1_;
};

/// A plane through three points' sums or a normal as written; `inside` is left to the shapes.
class Flat {
 public:
  Flat(const V& on, const V& n) : on_(on), n_(unit(n)) {}
  Crossings crossings(const Line& line) const {
    Crossings out;
    const Q cosine = abs(dot(n_, unit(line.d)));
    out.from_tangency = abs(cosine / kEpsilon - 1) < 1e-6 ? 0 : 1e300;
    if (cosine < kEpsilon) return out;
    out.all.push_back({dot(n_, on_ - line.o) / dot(n_, line.d), 1e300, cosine, -1, -1});
    return out;
  }
  Q height(const V& p) const { return dot(n_, p - on_); }
  V normal(const V&) const { return n_; }

 protected:
  V on_, n_;
};

class Plane : public Flat {
 public:
  explicit Plane(const shape::Plane& p) : Flat(p.point, p.normal) {}
};

class Disc : public Flat {
 public:
  explicit Disc(const shape::Disc& d) : Flat(d.center, d.normal), r_(d.radius) {}
  Crossings crossings(const Line& line) const {
    Crossings out = Flat::crossings(line);
    for (Crossing& c : out.all) c.inside = r_ - length(line.at(c.t) - on_);
    return out;
  }

 protected:
  Q r_;
};

/// Any number of vertices in a plane; the normal is the sum of the triangles of a fan. Inside by counting
/// signed crossings of a half line with the edges.
class Polygon : public Flat {
 public:
  explicit Polygon(const std::vector<Vec3>& points) : Flat(points[0], fan(points)) {
    for (const Vec3& p : points) v_.emplace_back(p);
    e1_ = unit(cross(n_, abs(n_.x) < Q(0.6) ? V(1, 0, 0) : V(0, 1, 0)));
    e2_ = cross(n_, e1_);
  }
  Crossings crossings(const Line& line) const {
    Crossings out = Flat::crossings(line);
    for (Crossing& c : out.all) {
      const V p = line.at(c.t);
      Q nearest = 1e300;
      int winding = 0;
      for (std::size_t i = 0; i < v_.size(); ++i) {
        const V a = v_[i] - p, b = v_[(i + 1) % v_.size()] - p;
        const Q ax = dot(a, e1_), ay = dot(a, e2_), bx = dot(b, e1_), by = dot(b, e2_);
        const Q side = ax * by - ay * bx;
        if (ay <= 0 && by > 0 && side > 0) ++winding;
        if (ay > 0 && by <= 0 && side < 0) --winding;
        const V e = b - a;
        const Q s = std::clamp(Q(-dot(a, e) / dot(e, e)), Q(0), Q(1));
        keep_nearest(nearest, length(a + s * e));
      }
      c.inside = winding ? nearest : Q(-nearest);
    }
    return out;
  }

 protected:
  static V fan(const std::vector<Vec3>& points) {
    V sum(0, 0, 0);
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      sum = sum + cross(V(points[i]) - V(points[0]), V(points[i + 1]) - V(points[0]));
    }
    return sum;
  }
  std::vector<V> v_;
  V e1_, e2_;
};

class Box {
 public:
  explicit Box(const shape::Box& b) : lo_(b.lo), hi_(b.hi) {}
  Crossings crossings(const Line& line) const {
    Crossings out;
    for (int axis = 0; axis < 3; ++axis) {
      if (line.d[axis] == 0) {
        keep_nearest(out.from_tangency, abs(line.o[axis] - lo_[axis]));
        keep_nearest(out.from_tangency, abs(line.o[axis] - hi_[axis]));
        continue;
      }
      for (const Q& face : {lo_[axis], hi_[axis]}) {
        const Q t = (face - line.o[axis]) / line.d[axis];
        const V p = line.at(t);
        Q inside = 1e300;
        for (int other = 0; other < 3; ++other) {
          if (other == axis) continue;
          keep_nearest(inside, p[other] - lo_[other]);
          keep_nearest(inside, hi_[other] - p[other]);
        }
        out.all.push_back({t, inside, abs(line.d[axis]) / length(line.d), -1, -1});
      }
    }
    std::sort(out.all.begin(), out.all.end(), [](const Crossing& a, const Crossing& b) { return a.t < b.t; });
    return out;
  }
  /// Beside a face.
  Q height(const V& p) const {
    Q most = -1e300;
    for (int axis = 0; axis < 3; ++axis)
      most = std::max(most, std::max(Q(lo_[axis] - p[axis]), Q(p[axis] - hi_[axis])));
    return most;
  }
  V normal(const V& p) const {
    Q nearest = 1e300;
    V out;
    for (int axis = 0; axis < 3; ++axis) {
      for (const int side : {-1, 1}) {
        const Q d = abs(p[axis] - (side < 0 ? lo_ : hi_)[axis]);
        if (d < nearest) {
          nearest = d;
          out = {axis == 0 ? side : 0, axis == 1 ? side : 0, axis == 2 ? side : 0};
        }
      }
    }
    return out;
  }

 private:
  V lo_, hi_;
};

}  // namespace rayshade::quad
