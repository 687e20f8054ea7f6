// SPDX-License-Identifier: MIT
// Triangles: flat, with vertex normals (Phong), and with vertex normals and surface coordinates
// (objects.md 4.4).
//
// Inside or outside is decided on the vertices projected along the ray, with edge functions of two projected
// vertices (Woop, Benthin, Wald: "Watertight ray/triangle intersection", JCGT 2013), here scaled by a
// component of the direction instead of divided by it. A projected vertex depends on vertex and ray only, and
// the sign of an edge function is exact (a rounded difference of rounded products has the right sign unless
// it is zero; then the rounding errors of the products decide), so the two triangles of an edge always
// contradict each other about its side, in whatever order they name the vertices: no ray leaks between them.
// Rays through the very edge hit both; the rank of the leaves decides.
#pragma once

#include <algorithm>
#include <cmath>

#include "rayshade/geometry/ray.h"
#include "rayshade/geometry/shapes/flat.h"
#include "rayshade/math/bounds.h"
#include "rayshade/scene/shape.h"

namespace rayshade {

class Triangle {
 public:
  /// `flip`: the option -f, which negates the normal.
  explicit Triangle(const shape::Triangle& triangle, bool flip = false)
      : p_{triangle.p[0], triangle.p[1], triangle.p[2]}, negated_(flip) {}

  /// t >= lo, t <= hi. hit.a, hit.b: weights of p2 and p3.
  bool intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const;
  SurfacePoint surface_point(const Ray& ray, const ShapeHit& hit) const;
  /// By the geometric normal.
  bool entering(const Ray& ray, double /*lo*/, const ShapeHit& /*hit*/) const {
    return (dot(cross_product(), ray.direction) < 0) != negated_;
  }
  /// v = b3, u = b2 / (b1 + b2) of the weights of the hit.
  TextureCoordinates texture_coordinates(const Vec3& x, const Vec3& facing_normal, const ShapeHit& hit) const;
  Bounds3 bounds() const;
  const Vec3 (&vertices() const)[3] { return p_; }

 private:
  friend class SmoothTriangle;
  friend class UvTriangle;
  /// (p2 - p1) x (p3 - p2), never negated.
  Vec3 cross_product() const { return cross(p_[1] - p_[0], p_[2] - p_[1]); }
  Vec3 geometric_normal() const;

  Vec3 p_[3];
  bool negated_;
};

class SmoothTriangle {
 public:
  /// `flip`: the option -f, which negates all normals. Without it the first vertex normal decides to which
  /// side the geometric normal points.
  explicit SmoothTriangle(const shape::SmoothTriangle& triangle, bool flip = false);

  bool intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const {
    return flat_.intersect(ray, lo, hi, hit);
  }
  SurfacePoint surface_point(const Ray& ray, const ShapeHit& hit) const;
  /// By the geometric normal.
  bool entering(const Ray& ray, double lo, const ShapeHit& hit) const { return flat_.entering(ray, lo, hit); }
  TextureCoordinates texture_coordinates(const Vec3& x, const Vec3& facing_normal,
                                         const ShapeHit& hit) const {
    return flat_.texture_coordinates(x, facing_normal, hit);
  }
  Bounds3 bounds() const { return flat_.bounds(); }
  const Vec3 (&vertices() const)[3] { return flat_.vertices(); }

 private:
  friend class UvTriangle;
  Triangle flat_;
  Vec3 n_[3];  ///< unit
};

class UvTriangle {
 public:
  explicit UvTriangle(const shape::UvTriangle& triangle, bool flip = false);

  bool intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const {
    return smooth_.intersect(ray, lo, hi, hit);
  }
  SurfacePoint surface_point(const Ray& ray, const ShapeHit& hit) const {
    return smooth_.surface_point(ray, hit);
  }
  /// By the geometric normal.
  bool entering(const Ray& ray, double lo, const ShapeHit& hit) const {
    return smooth_.entering(ray, lo, hit);
  }
  /// The vertices' u and v, weighted.
  TextureCoordinates texture_coordinates(const Vec3& x, const Vec3& facing_normal, const ShapeHit& hit) const;
  Bounds3 bounds() const { return smooth_.bounds(); }
  const Vec3 (&vertices() const)[3] { return smooth_.vertices(); }

 private:
  SmoothTriangle smooth_;
  double u_[3], v_[3];
};

/// The edge function a.x b.y - a.y b.x of two projected vertices where it was computed as zero: a value with
/// the sign of the exact one.
double edge_function_exactly(double ax, double ay, double bx, double by);

/// The weights of the three vertices, unnormalised and of one sign; false where the ray misses. X, Y, Z: the
/// axes, with Z that of the largest component of the direction.
template <double Vec3::*X, double Vec3::*Y, double Vec3::*Z>
bool projected_weights(const Vec3 (&p)[3], const Ray& ray, double (&weight)[3]) {
  const double dx = ray.direction.*X, dy = ray.direction.*Y, dz = ray.direction.*Z;
  const auto across = [&](const Vec3& q, double& x, double& y) {
    const double z = q.*Z - ray.origin.*Z;
    x = (q.*X - ray.origin.*X) * dz - z * dx;
    y = (q.*Y - ray.origin.*Y) * dz - z * dy;
  };
  double x0, y0, x1, y1, x2, y2;
  across(p[0], x0, y0);
  across(p[1], x1, y1);
  across(p[2], x2, y2);
  double w0 = x1 * y2 - y1 * x2, w1 = x2 * y0 - y2 * x0, w2 = x0 * y1 - y0 * x1;
  const auto one_sign = [&] {
    return std::min(std::min(w0, w1), w2) >= 0 || std::max(std::max(w0, w1), w2) <= 0;
  };
  // Signs that differ are right; zeros agree with either, until they are looked at closely.
  if (!one_sign()) return false;
  if (w0 == 0 || w1 == 0 || w2 == 0) {
    if (w0 == 0) w0 = edge_function_exactly(x1, y1, x2, y2);
    if (w1 == 0) w1 = edge_function_exactly(x2, y2, x0, y0);
    if (w2 == 0) w2 = edge_function_exactly(x0, y0, x1, y1);
    if (!one_sign()) return false;
  }
  weight[0] = w0, weight[1] = w1, weight[2] = w2;
  return true;
}

/// `t` of a ray that passes between the vertices, kept to where the ray is within their box. Between is
/// decided to the last bit, but t comes from the plane, which edge-on triangles and slivers know poorly:
/// without this a hit could be reported at a place where no bounds would look for it.
double kept_within_box(const Vec3 (&p)[3], const Ray& ray, double t);
/// Whether that may change anything: below the square of the sine of the angle of the edges times that of the
/// angle of plane and ray, the error of t stays below what culling allows for (fas::make_probe).
constexpr double kWellKnown = 1.0 / 16;

inline bool Triangle::intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const {
  double w[3];
  const Vec3& d = ray.direction;
  const Vec3 size = abs(d);
  const bool inside = size.x > size.y && size.x > size.z
                          ? projected_weights<&Vec3::y, &Vec3::z, &Vec3::x>(p_, ray, w)
                      : size.y > size.z ? projected_weights<&Vec3::z, &Vec3::x, &Vec3::y>(p_, ray, w)
                                        : projected_weights<&Vec3::x, &Vec3::y, &Vec3::z>(p_, ray, w);
  if (!inside) return false;
  const Vec3 e1 = p_[1] - p_[0], e2 = p_[2] - p_[1], n = cross(e1, e2);
  const double slope = dot(n, d);
  double t = dot(n, p_[0] - ray.origin) / slope;
  if (!(slope * slope >= kWellKnown * (dot(e1, e1) * dot(e2, e2)) * dot(d, d)))
    t = kept_within_box(p_, ray, t);
  if (!(t >= lo && t <= hi) || !hit_squarely(t, slope, dot(n, n), dot(d, d))) return false;
  const double sum = w[0] + w[1] + w[2];
  if (!(std::fabs(sum) > 0)) return false;
  hit.t = t;
  hit.a = w[1] / sum;
  hit.b = w[2] / sum;
  return true;
}

}  // namespace rayshade
