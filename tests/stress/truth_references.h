// SPDX-License-Identifier: MIT
// Shapes in 113 bits as trials of single rays want them: those of shapes_quad.h with surface coordinates, and
// the shapes whose equations have no closed solution - torus, blob - or many pieces - height field.
#pragma once

#include <cmath>
#include <vector>

#include "rayshade/geometry/shapes.h"
#include "rayshade/math/functions.h"
#include "tests/unit/geometry/shapes_quad.h"

namespace rayshade::stress {

using quad::Coordinates;
using quad::Crossing;
using quad::Crossings;
using quad::Line;
using quad::Q;
using quad::V;

inline const Q& pi() {
  static const Q value = acos(Q(-1));
  return value;
}

/// The angle of (x, y) in turns, 0 to 1.
inline Q turns_of(const Q& x, const Q& y) {
  const Q a = atan2(y, x) / (2 * pi());
  return a < 0 ? Q(1 + a) : a;
}

/// The smallest rotation that takes +z to an axis (objects.md 3.1).
struct Frame {
  V rows[3];
  explicit Frame(const V& axis) {
    const V w = quad::unit(axis);
    const Q square = w.x * w.x + w.y * w.y;
    if (square == 0) {
      const Q s = w.z < 0 ? -1 : 1;
      rows[0] = {1, 0, 0}, rows[1] = {0, s, 0}, rows[2] = {0, 0, s};
      return;
    }
    const Q k = w.z < 0 ? Q((1 - w.z) / square) : Q(1 / (1 + w.z));
    rows[0] = {1 - w.x * w.x * k, -w.x * w.y * k, -w.x};
    rows[1] = {-w.x * w.y * k, 1 - w.y * w.y * k, -w.y};
    rows[2] = w;
  }
  V local(const V& p) const { return {dot(p, rows[0]), dot(p, rows[1]), dot(p, rows[2])}; }
};

class Sphere : public quad::Sphere {
 public:
  using quad::Sphere::Sphere;
  Coordinates coordinates(const V& p, const V&) const {
    const V e = quad::unit(p - c_);
    const Q across = sqrt(e.x * e.x + e.y * e.y), v = atan2(across, -e.z) / pi();
    // Near the poles u is 0 by decree.
    const bool pole = v < 2e-5 || v > 1 - 2e-5;
    return {turns_of(e.x, e.y), v, pole ? Q(0) : 2 * pi() * r_ * across, pi() * r_, true};
  }
};

class Plane : public quad::Plane {
 public:
  using quad::Plane::Plane;
  Coordinates coordinates(const V& p, const V& direction) const {
    const V m = dot(n_, direction) > 0 ? Q(-1) * n_ : n_;
    V u(-m.y, m.x, 0);
    // The nearer the normal is to the z axis, the more a rounding of it turns the axes of the pattern.
    const Q turn = quad::length(u), firm = turn < kEpsilon ? Q(1) : turn;
    u = quad::unit(turn < kEpsilon ? V(m.z, 0, -m.x) : u);
    return {dot(p - on_, u), dot(p - on_, cross(m, u)), firm, firm};
  }
};

/// The angle u of a disc is taken from absolute places, and means something in the middle only.
class Disc : public quad::Disc {
 public:
  using quad::Disc::Disc;
  Coordinates coordinates(const V& p, const V&) const {
    const Q v = quad::length(p - on_) / r_;
    return {0, v, 0, v < .01 ? Q(0) : r_};
  }
};

class Polygon : public quad::Polygon {
 public:
  using quad::Polygon::Polygon;
  Coordinates coordinates(const V& p, const V&) const { return {p.x, p.y, 1, 1}; }
};

class Triangle : public quad::Polygon {
 public:
  explicit Triangle(const Vec3 (&p)[3]) : quad::Polygon({p[0], p[1], p[2]}) {}
  Coordinates coordinates(const V& p, const V&) const {
    // Weights, and their gradients within the plane.
    const V n = cross(v_[1] - v_[0], v_[2] - v_[0]);
    Q b[3];
    V g[3];
    for (std::size_t i = 0; i < 3; ++i) {
      g[i] = (1 / dot(n, n)) * cross(n, v_[(i + 2) % 3] - v_[(i + 1) % 3]);
      b[i] = dot(g[i], p - v_[(i + 1) % 3]);
    }
    const Q rest = b[0] + b[1];
    if (b[2] > 1 - 2e-5) return {0, b[2], 0, 1 / quad::length(g[2])};  // u is 0 by decree
    const V along = (1 / (rest * rest)) * (b[0] * g[1] - b[1] * g[0]);
    return {b[1] / rest, b[2], 1 / quad::length(along), 1 / quad::length(g[2])};
  }
};

class Wall : public quad::Wall {
 public:
  using quad::Wall::Wall;
  Coordinates coordinates(const V& p, const V&) const {
    const Q s = dot(p - e_, m_) / dot(m_, m_), tilt = (r1_ - r0_) / quad::length(m_);
    // v begins at the thinner end, and the frame is about the axis from there.
    const bool down = r1_ < r0_;
    const V at = Frame(down ? Q(-1) * m_ : m_).local(p - e_);
    const bool apex = abs(radius(s)) < 2e-5 * std::max(abs(r0_), abs(r1_));
    return {turns_of(at.x, at.y), down ? Q(1 - s) : s, apex ? Q(0) : 2 * pi() * abs(radius(s)),
            quad::length(m_) * sqrt(1 + tilt * tilt), true};
  }
};

/// By its distance function, and all places where that changes sign.
class Torus {
 public:
  explicit Torus(const shape::Torus& torus)
      : center_(torus.center), frame_(torus.axis), swept_(torus.swept), tube_(torus.tube) {}

  Crossings crossings(const Line& line, const Q& touching) const {
    const Q speed = quad::length(line.d), middle = dot(center_ - line.o, line.d) / (speed * speed);
    const Q reach = 1.01 * (swept_ + tube_) / speed;
    Crossings out;
    // At least the smaller of the two principal radii, whichever way the line goes.
    const Q inner = std::min(tube_, Q(abs(swept_ - tube_)));
    std::vector<Q> found;
    const Q width = 1e-3 * tube_ / speed, bend = width * speed * width * speed / inner;
    if (search(line, middle - reach, middle + reach, width, speed, bend + touching, found))
      out.from_tangency = 0;
    for (const Q& t : found) {
      const V p = line.at(t), n = normal(p);
      out.all.push_back({t, 1e300, abs(dot(n, line.d)) / speed, inner, inner});
    }
    return out;
  }
  Q height(const V& p) const { return quad::length(p - ring(p)) - tube_; }
  V normal(const V& p) const { return quad::unit(p - ring(p)); }
  Coordinates coordinates(const V& p, const V&) const {
    const V at = frame_.local(p - center_);
    const Q h = sqrt(at.x * at.x + at.y * at.y);
    return {turns_of(at.x, at.y), turns_of(swept_ - h, -at.z), 2 * pi() * h, 2 * pi() * tube_, true, true};
  }

 private:
  /// The nearest point of the circle.
  V ring(const V& p) const {
    const V q = p - center_, &axis = frame_.rows[2];
    return center_ + swept_ * quad::unit(q - dot(q, axis) * axis);
  }
  /// All sign changes of the height in (a, b). True where there may be more: two within one `width`, which
  /// need a height below `bend` there, or three, which need a slope that is nearly nothing.
  bool search(const Line& line, Q a, Q b, const Q& width, const Q& speed, const Q& bend,
              std::vector<Q>& out) const {
    const Q middle = (a + b) / 2, at_middle = abs(height(line.at(middle)));
    if (at_middle > speed * (b - a) / 2) return false;
    if (b - a > width) {
      const bool before = search(line, a, middle, width, speed, bend, out);
      return search(line, middle, b, width, speed, bend, out) || before;
    }
    const bool positive = height(line.at(a)) > 0;
    if (positive == (height(line.at(b)) > 0)) return at_middle < bend;
    for (int i = 0; i < 90; ++i) {
      const Q x = (a + b) / 2;
      ((height(line.at(x)) > 0) == positive ? a : b) = x;
    }
    out.push_back((a + b) / 2);
    return abs(dot(normal(line.at(out.back())), line.d)) * width < 2 * bend;
  }

  V center_;
  Frame frame_;
  Q swept_, tube_;
};

/// By its field along the line: between the borders of influence a quartic, whose zeros lie one each between
/// those of its derivative.
class Blob {
 public:
  explicit Blob(const shape::Blob& blob) : blob_(blob) {
    for (const shape::Metaball& ball : blob.balls) {
      strengths_ += ball.strength;
      bend_ += 8 * ball.strength / (ball.radius * ball.radius);
    }
  }

  Crossings crossings(const Line& line, const Q& touching) const {
    const Q speed = quad::length(line.d);
    Crossings out;
    // A change of the ray by `touching` changes the field by no more than this.
    Q slope = 0;
    for (const shape::Metaball& ball : blob_.balls) slope += 1.54 * ball.strength / ball.radius;
    const Q little = slope * touching + 1e-12 * strengths_;
    const std::vector<Q> found = roots(line, blob_.threshold);
    if (roots(line, blob_.threshold - little).size() != found.size() ||
        roots(line, blob_.threshold + little).size() != found.size())
      out.from_tangency = 0;
    for (const Q& t : found) {
      const V p = line.at(t), g = gradient(p);
      const Q steep = quad::length(g), radius = steep / bend_;
      out.all.push_back({t, 1e300, abs(dot(g, line.d)) / (steep * speed), radius, radius,
                         (strengths_ + std::fabs(blob_.threshold)) / steep});
    }
    return out;
  }
  /// To first order, for points next to the surface.
  Q height(const V& p) const { return (blob_.threshold - field(p)) / quad::length(gradient(p)); }
  V normal(const V& p) const { return Q(-1) * quad::unit(gradient(p)); }

 private:
  using Polynomial = std::vector<Q>;  ///< coefficients, of 1 first

  static Q value(const Polynomial& f, const Q& x) {
    Q sum = 0;
    for (std::size_t i = f.size(); i-- > 0;) sum = sum * x + f[i];
    return sum;
  }
  /// The places in (a, b) where `f` changes sign.
  static std::vector<Q> sign_changes(const Polynomial& f, const Q& a, const Q& b) {
    if (f.size() < 2) return {};
    Polynomial derivative;
    for (std::size_t i = 1; i < f.size(); ++i) derivative.push_back(Q(i) * f[i]);
    std::vector<Q> ends{a}, out;
    for (const Q& x : sign_changes(derivative, a, b)) ends.push_back(x);
    ends.push_back(b);
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      Q lo = ends[i], hi = ends[i + 1];
      const bool positive = value(f, lo) > 0;
      if (positive == (value(f, hi) > 0)) continue;
      for (int k = 0; k < 115; ++k) {
        const Q x = (lo + hi) / 2;
        ((value(f, x) > 0) == positive ? lo : hi) = x;
      }
      out.push_back((lo + hi) / 2);
    }
    return out;
  }
  std::vector<Q> roots(const Line& line, const Q& threshold) const {
    // Along x, a length from the middle of the balls.
    const Q speed = quad::length(line.d);
    const Q start = dot(V(blob_.balls[0].center) - line.o, line.d) / (speed * speed);
    const V o = line.at(start), d = (1 / speed) * line.d;
    struct Span {
      Q from, to;
      Polynomial f;
    };
    std::vector<Span> spans;
    std::vector<Q> borders;
    for (const shape::Metaball& ball : blob_.balls) {
      const V q = o - V(ball.center);
      const Q r2 = Q(ball.radius) * ball.radius, along = dot(q, d), square = dot(q, q);
      const Q inside = along * along - square + r2;
      if (inside <= 0) continue;
      const Q half = sqrt(inside), s = ball.strength;
      // s (1 - (x^2 + 2 along x + square) / r^2)^2
      const Q c0 = 1 - square / r2, c1 = -2 * along / r2, c2 = -1 / r2;
      spans.push_back(
          {-along - half,
           -along + half,
           {s * c0 * c0, 2 * s * c0 * c1, s * (c1 * c1 + 2 * c0 * c2), 2 * s * c1 * c2, s * c2 * c2}});
      borders.push_back(spans.back().from);
      borders.push_back(spans.back().to);
    }
    std::sort(borders.begin(), borders.end());
    std::vector<Q> out;
    for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
      const Q middle = (borders[i] + borders[i + 1]) / 2;
      Polynomial f{-threshold, 0, 0, 0, 0};
      for (const Span& span : spans) {
        if (middle < span.from || middle > span.to) continue;
        for (std::size_t k = 0; k < 5; ++k) f[k] += span.f[k];
      }
      for (const Q& x : sign_changes(f, borders[i], borders[i + 1])) out.push_back(start + x / speed);
    }
    return out;
  }
  Q field(const V& p) const {
    Q sum = 0;
    each(p, [&](const shape::Metaball& ball, const V&, const Q& u) { sum += ball.strength * u * u; });
    return sum;
  }
  V gradient(const V& p) const {
    V sum(0, 0, 0);
    each(p, [&](const shape::Metaball& ball, const V& q, const Q& u) {
      sum = sum + (-4 * ball.strength * u / (Q(ball.radius) * ball.radius)) * q;
    });
    return sum;
  }
  template <class Visit>
  void each(const V& p, const Visit& visit) const {
    for (const shape::Metaball& ball : blob_.balls) {
      const V q = p - V(ball.center);
      const Q u = 1 - dot(q, q) / (Q(ball.radius) * ball.radius);
      if (u > 0) visit(ball, q, u);
    }
  }

  shape::Blob blob_;
  Q strengths_ = 0, bend_ = 0;
};

/// All of its triangles.
class HeightField {
 public:
  HeightField(int size, std::vector<float> altitudes) : size_(size), altitudes_(std::move(altitudes)) {
    for (int j = 0; j + 1 < size_; ++j) {
      for (int i = 0; i + 1 < size_; ++i) {
        facets_.push_back({{vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)}});
        facets_.push_back({{vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)}});
      }
    }
  }

  Crossings crossings(const Line& line) const {
    Crossings out;
    for (const Facet& facet : facets_) {
      const V n = facet.normal();
      const Q sine = dot(n, line.d);
      if (sine == 0) continue;
      const Q t = dot(n, facet.corners[0] - line.o) / sine;
      const V p = line.at(t);
      Q inside = 1e300;
      for (int k = 0; k < 3; ++k) {
        const V edge = facet.corners[(k + 1) % 3] - facet.corners[k];
        quad::keep_nearest(inside, dot(cross(edge, p - facet.corners[k]), n) / quad::length(edge));
      }
      out.all.push_back({t, inside, abs(sine) / quad::length(line.d), -1, -1});
    }
    std::sort(out.all.begin(), out.all.end(), [](const Crossing& a, const Crossing& b) { return a.t < b.t; });
    return out;
  }
  Q height(const V& p) const {
    const Facet& facet = facet_at(p);
    return dot(facet.normal(), p - facet.corners[0]);
  }
  V normal(const V& p) const { return facet_at(p).normal(); }
  Coordinates coordinates(const V& p, const V&) const { return {p.x, p.y, 1, 1}; }

 private:
  struct Facet {
    V corners[3];
    V normal() const { return quad::unit(cross(corners[1] - corners[0], corners[2] - corners[0])); }
  };
  V vertex(int i, int j) const {
    return {Q(i) / (size_ - 1), Q(j) / (size_ - 1), altitudes_[static_cast<std::size_t>(j * size_ + i)]};
  }
  const Facet& facet_at(const V& p) const {
    const Q x = p.x * (size_ - 1), y = p.y * (size_ - 1);
    const int i = std::clamp(static_cast<int>(x), 0, size_ - 2);
    const int j = std::clamp(static_cast<int>(y), 0, size_ - 2);
    const int upper = x - i + y - j > 1 ? 1 : 0;
    return facets_[static_cast<std::size_t>(2 * (j * (size_ - 1) + i) + upper)];
  }

  int size_;
  std::vector<float> altitudes_;
  std::vector<Facet> facets_;
};

}  // namespace rayshade::stress
