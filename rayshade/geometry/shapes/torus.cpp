// SPDX-License-Identifier: MIT
#include "rayshade/geometry/shapes/torus.h"

#include <limits>

#include "rayshade/geometry/roots/quartic.h"

namespace rayshade {
namespace {

constexpr double kUlp = std::numeric_limits<double>::epsilon();

/// The torus of swept radius R and tube radius r, R + r = 1, seen from a point whose distance from the centre
/// is stationary along the ray: origin . direction = 0, direction of unit length.
struct CanonicalRay {
  Vec3 origin, direction;
  double swept, tube;

  struct Meridian {
    double h, h_slope, z;
  };
  Meridian meridian(double x) const {
    const double px = origin.x + x * direction.x, py = origin.y + x * direction.y;
    const double h = std::sqrt(px * px + py * py);
    return {h, h > 0 ? (px * direction.x + py * direction.y) / h : 0, origin.z + x * direction.z};
  }
  double outer_of(const Meridian& m) const {
    const double off = m.h - swept;
    return off * off + (m.z - tube) * (m.z + tube);
  }
  double inner_of(const Meridian& m) const {
    const double off = m.h + swept;
    return off * off + (m.z - tube) * (m.z + tube);
  }
  roots::ValueAndSlope outer(double x) const {
    const Meridian m = meridian(x);
    return {outer_of(m), 2 * ((m.h - swept) * m.h_slope + m.z * direction.z)};
  }
  roots::ValueAndSlope inner(double x) const {
    const Meridian m = meridian(x);
    return {inner_of(m), 2 * ((m.h + swept) * m.h_slope + m.z * direction.z)};
  }
};

}  // namespace

Torus::Torus(const shape::Torus& torus)
    : frame_(axis_frame(torus.axis)), center_(torus.center), swept_(torus.swept), tube_(torus.tube) {
  // The silhouette of a ring: R sin(angle between its axis and the coordinate axis) + r along each
  // coordinate.
  Vec3 reach;
  for (int i = 0; i < 3; ++i) {
    const double across =
        std::sqrt(frame_.rows[0][i] * frame_.rows[0][i] + frame_.rows[1][i] * frame_.rows[1][i]);
    reach[i] = (swept_ * across + tube_) * (1 + 16 * kUlp);
  }
  bounds_ = grown({center_ - reach, center_ + reach}, 4 * kUlp * max_abs(center_));
}

bool Torus::intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const {
  const Vec3 from_center = ray.origin - center_;
  const Vec3& d = ray.direction;
  const double dd = dot(d, d);
  const double size = swept_ + tube_;
  // The point of the ray nearest the centre, in two steps: the first leaves an error that shrinks with the
  // distance of the origin, the second makes origin and direction perpendicular to working accuracy.
  double shift = -dot(from_center, d) / dd;
  Vec3 nearest = from_center + shift * d;
  if (!(dot(nearest, nearest) < 1.0000001 * size * size)) return false;
  const double second = -dot(nearest, d) / dd;
  nearest += second * d;
  shift += second;

  const double per_length = 1 / std::sqrt(dd), per_size = 1 / size;
  const double scale = size * per_length;  // t per unit of x
  CanonicalRay canonical{frame_.local(nearest) * per_size, frame_.local(d) * per_length, swept_ * per_size,
                         tube_ * per_size};
  const Vec3 &o = canonical.origin, &u = canonical.direction;
  const double swept = canonical.swept, tube = canonical.tube;

  // The part of the ray inside the enclosing sphere and slab, both grown far beyond rounding: its ends are
  // outside.
  const double oo = dot(o, o);
  const double half_square = 1.0000001 - oo;
  if (!(half_square > 0)) return false;
  double b = std::sqrt(half_square), a = -b;
  const double top = tube * 1.000000001 + 1e-14;
  if (u.z != 0) {
    const double slab = 1 / u.z;
    const double s0 = (-top - o.z) * slab, s1 = (top - o.z) * slab;
    a = std::max(a, std::min(s0, s1));
    b = std::min(b, std::max(s0, s1));
  } else if (std::fabs(o.z) > top) {
    return false;
  }
  if (!(a < b)) return false;
  const double t_end = shift + b * scale;
  if (t_end <= lo || shift + a * scale > hi) return false;
  // Through the hole: h is convex along the ray.
  const double hole = (swept - tube) * 0.999999999;
  if (hole > 0) {
    const double ax = o.x + a * u.x, ay = o.y + a * u.y, bx = o.x + b * u.x, by = o.y + b * u.y;
    if (std::max(ax * ax + ay * ay, bx * bx + by * by) < hole * hole) return false;
  }

  // A quarter of the quartic's derivative, without a square term since o . u = 0.
  const double swept_square = 2 * swept * swept;
  const double p = oo - (swept * swept + tube * tube) + swept_square * u.z * u.z;
  roots::DepressedCubicZeros stationary(p, swept_square * o.z * u.z, a, b);
  // Roots are the same numbers whatever `lo` is; pieces of the ray that end before it are passed over
  // quickly.
  const auto accept = [&](double root, std::uint32_t sheet) {
    const double t = shift + root * scale;
    if (!(t > lo)) return false;
    hit = {t, 0, 0, sheet};
    return true;
  };
  const bool spindle = tube > swept;
  bool outside = true, outside_inner = true;  // states at the left end of the piece
  double left = a, left_parabola = 0;
  for (bool more = true; more;) {
    double right = b;
    more = stationary.next(right);
    bool outside_next = true, outside_inner_next = true;
    double parabola = 0;  // square of the distance of the zeros from the stationary point
    if (more) {
      const CanonicalRay::Meridian m = canonical.meridian(right);
      const double outer = canonical.outer_of(m), inner = canonical.inner_of(m);
      // Near a stationary point the quartic is a parabola: this tells about where its zeros are. Where they
      // are one number the ray only touches, and nothing changes.
      parabola = -outer * inner / (6 * right * right + 2 * p);
      const double t = shift + right * scale,
                   reach = t - (shift + (right - std::sqrt(std::fabs(parabola))) * scale);
      const bool resolved = std::fabs(reach) > 2 * kUlp * std::fabs(t);
      outside_next = resolved ? outer > 0 : outside;
      outside_inner_next = resolved ? inner > 0 || !spindle : outside_inner;
    } else {
      right = b;
    }
    if (shift + right * scale > lo) {
      if (outside != outside_next) {
        const double guess = outside && parabola > 0         ? right - std::sqrt(parabola)
                             : !outside && left_parabola > 0 ? left + std::sqrt(left_parabola)
                                                             : 0.5 * (left + right);
        const double root = roots::bracketed_root([&](double x) { return canonical.outer(x); }, left, right,
                                                  outside, guess, kUlp);
        if (accept(root, 0)) return hit.t <= hi;
      }
      if (outside_inner != outside_inner_next) {
        const double root = roots::bracketed_root([&](double x) { return canonical.inner(x); }, left, right,
                                                  outside_inner, 0.5 * (left + right), kUlp);
        if (accept(root, 1)) return hit.t <= hi;
      }
    }
    outside = outside_next;
    outside_inner = outside_inner_next;
    left = right;
    left_parabola = parabola;
  }
  return false;
}

Vec3 Torus::local_normal(const Vec3& p) const {
  const double h = std::sqrt(p.x * p.x + p.y * p.y);
  // The original's threshold, in proportion for tori below unit size.
  if (h <= kEpsilon * std::min(1.0, swept_ + tube_)) return p;
  const double f = 1 - swept_ / h;
  return {p.x * f, p.y * f, p.z};
}

SurfacePoint Torus::surface_point(const Ray& ray, const ShapeHit& hit) const {
  Vec3 p = frame_.local(ray.at(hit.t) - center_);
  // Along the line to the nearest point of the tube's centre circle; for the inner sheet to the farthest one.
  const double h = std::sqrt(p.x * p.x + p.y * p.y);
  if (h > 0) {
    const double f = (hit.part == 0 ? swept_ : -swept_) / h;
    const Vec3 middle{p.x * f, p.y * f, 0};
    const Vec3 out = p - middle;
    const double distance = length(out);
    if (distance > 0) p = middle + out * (tube_ / distance);
  } else {
    p.z = std::copysign(std::sqrt(std::max(0.0, tube_ * tube_ - swept_ * swept_)), p.z);
  }
  SurfacePoint out;
  Vec3 normal = local_normal(p);
  // The formula vanishes on the inner sheet where h = R, z = 0, and at the pinch of a horn (r = R), which has
  // no normal.
  const double nothing = 1e-12 * (swept_ + tube_);
  if (max_abs(normal) <= nothing) normal = p;
  out.normal = out.geometric_normal =
      normalize(max_abs(normal) <= nothing ? -ray.direction : frame_.outward(normal));
  out.point = center_ + frame_.outward(p);
  // In the frame the point is off the tube by at most 6 roundings of numbers below R + r (three for the
  // centre's circle, three for the way from it); turning it out costs another 6 (the axes are unit and
  // perpendicular within 3, the sum of products rounds 3 times), adding the centre one of the result.
  out.error = kUlp * (12 * (swept_ + tube_) + max_abs(out.point));
  return out;
}

bool Torus::entering(const Ray& ray, double /*lo*/, const ShapeHit& hit) const {
  return dot(surface_point(ray, hit).geometric_normal, ray.direction) < 0;
}

TextureCoordinates Torus::texture_coordinates(const Vec3& x, const Vec3& facing_normal,
                                              const ShapeHit&) const {
  const Vec3 p = frame_.local(x - center_);
  const double h = std::sqrt(p.x * p.x + p.y * p.y);
  TextureCoordinates out;
  if (h > 0) out.u = turns(p.x / h, p.y / h, p.y < 0);
  out.v = turns(-(h - swept_) / tube_, p.z / tube_, p.z > 0);
  // The frame turns both tangents outward; the second is outside already (objects.md G18).
  out.du = normalize(frame_.outward({-p.y, p.x, 0}));
  out.dv = normalize(frame_.outward(cross(facing_normal, out.du)));
  return out;
}

}  // namespace rayshade
