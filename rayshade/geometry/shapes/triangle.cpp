// SPDX-License-Identifier: MIT
#include "rayshade/geometry/shapes/triangle.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "rayshade/geometry/roots/quadratic.h"

namespace rayshade {
namespace {

shape::Triangle corners(const Vec3 (&p)[3]) { return {{p[0], p[1], p[2]}}; }

/// The direction in the triangle along which `still` is constant and `moving` grows; zero where `still`
/// hardly varies.
Vec3 tangent_along(const Vec3 (&p)[3], const double (&still)[3], const double (&moving)[3]) {
  int lo = 0, mid = 1, hi = 2;
  if (still[mid] < still[lo]) std::swap(lo, mid);
  if (still[hi] < still[mid]) std::swap(mid, hi);
  if (still[mid] < still[lo]) std::swap(lo, mid);
  const double range = still[hi] - still[lo];
  if (range < kEpsilon) return {0, 0, 0};
  const double part = (still[mid] - still[lo]) / range;
  const Vec3 opposite = p[lo] + part * (p[hi] - p[lo]);
  const double moving_there = moving[lo] + part * (moving[hi] - moving[lo]);
  return normalize(moving[mid] < moving_there ? opposite - p[mid] : p[mid] - opposite);
}

}  // namespace

double edge_function_exactly(double ax, double ay, double bx, double by) {
  const double a = std::max(std::fabs(ax), std::fabs(ay)), b = std::max(std::fabs(bx), std::fabs(by));
  if (a == 0 || b == 0 || !std::isfinite(a) || !std::isfinite(b)) return 0;
  // Powers of two that keep the products away from overflow, and their rounding errors from underflow.
  const int sa = -std::ilogb(a), sb = -std::ilogb(b);
  return product_difference(std::ldexp(ax, sa), std::ldexp(by, sb), std::ldexp(ay, sa), std::ldexp(bx, sb));
}

double kept_within_box(const Vec3 (&p)[3], const Ray& ray, double t) {
  double entry = -std::numeric_limits<double>::infinity(), exit = -entry;
  for (int axis = 0; axis < 3; ++axis) {
    const double o = ray.origin[axis], d = ray.direction[axis];
    if (d == 0) continue;
    const double lo = std::min(std::min(p[0][axis], p[1][axis]), p[2][axis]),
                 hi = std::max(std::max(p[0][axis], p[1][axis]), p[2][axis]);
    // A few units of rounding more, so that the last bits stay those of the plane.
    const double margin = 8 * std::numeric_limits<double>::epsilon() *
                          std::max(std::fabs(o), std::max(std::fabs(lo), std::fabs(hi))) / std::fabs(d);
    const double a = (lo - o) / d, b = (hi - o) / d;
    entry = std::max(entry, std::min(a, b) - margin);
    exit = std::min(exit, std::max(a, b) + margin);
  }
  return t > exit ? exit : t < entry ? entry : t;
}

Vec3 Triangle::geometric_normal() const {
  const Vec3 g = normalize(cross_product());
  return negated_ ? -g : g;
}

SurfacePoint Triangle::surface_point(const Ray& /*ray*/, const ShapeHit& hit) const {
  // From the weights: the point is in the plane of the vertices however far away the ray began.
  const Vec3 e2 = p_[1] - p_[0], e3 = p_[2] - p_[0];
  SurfacePoint out;
  out.point = p_[0] + (hit.a * e2 + hit.b * e3);
  out.normal = out.geometric_normal = geometric_normal();
  // Per edge: difference, product, sum; then the last sum. Errors in the plane do not count.
  out.error = 4 * kRoundoff * (length(e2) + length(e3)) + 2 * storage_error(out.point);
  return out;
}

TextureCoordinates Triangle::texture_coordinates(const Vec3& x, const Vec3& /*facing_normal*/,
                                                 const ShapeHit& hit) const {
  const double b1 = 1 - hit.a - hit.b, b2 = hit.a;
  const Vec3 n = cross_product();
  TextureCoordinates out;
  out.v = hit.b;
  out.u = std::fabs(out.v - 1) < kEpsilon ? 0 : b2 / (b1 + b2);
  const Vec3 along = normalize(p_[1] - p_[0]);
  out.du = n[dominant_axis(n)] < 0 ? -along : along;
  out.dv = normalize(p_[0] - x);
  return out;
}

Bounds3 Triangle::bounds() const {
  Bounds3 out;
  for (const Vec3& p : p_) out.add(p);
  return out;
}

SmoothTriangle::SmoothTriangle(const shape::SmoothTriangle& triangle, bool flip)
    : flat_(corners(triangle.p), flip),
      n_{normalize(triangle.n[0]), normalize(triangle.n[1]), normalize(triangle.n[2])} {
  if (flip) {
    for (Vec3& n : n_) n = -n;
  } else {
    flat_.negated_ = dot(n_[0], flat_.cross_product()) < 0;
  }
}

SurfacePoint SmoothTriangle::surface_point(const Ray& ray, const ShapeHit& hit) const {
  SurfacePoint out = flat_.surface_point(ray, hit);
  const Vec3 n = (1 - hit.a - hit.b) * n_[0] + hit.a * n_[1] + hit.b * n_[2];
  if (!(n == Vec3{})) out.normal = normalize(n);
  out.smooth = true;
  return out;
}

UvTriangle::UvTriangle(const shape::UvTriangle& triangle, bool flip)
    : smooth_({{triangle.p[0], triangle.p[1], triangle.p[2]}, {triangle.n[0], triangle.n[1], triangle.n[2]}},
              flip),
      u_{triangle.u[0], triangle.u[1], triangle.u[2]},
      v_{triangle.v[0], triangle.v[1], triangle.v[2]} {}

TextureCoordinates UvTriangle::texture_coordinates(const Vec3& /*x*/, const Vec3& /*facing_normal*/,
                                                   const ShapeHit& hit) const {
  const double b1 = 1 - hit.a - hit.b, b2 = hit.a, b3 = hit.b;
  TextureCoordinates out;
  out.u = b1 * u_[0] + b2 * u_[1] + b3 * u_[2];
  out.v = b1 * v_[0] + b2 * v_[1] + b3 * v_[2];
  out.du = tangent_along(smooth_.flat_.p_, v_, u_);
  out.dv = tangent_along(smooth_.flat_.p_, u_, v_);
  return out;
}

}  // namespace rayshade
