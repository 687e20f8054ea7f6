// SPDX-License-Identifier: MIT
#include "fas/projection.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fas {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// More than what a short sum of products rounds, relative to the sum of their sizes.
constexpr double kRound = 0x1p-48;
/// Hulls nearer to the plane of the apex than this many slacks are taken by their boxes.
constexpr double kNear = 64;

double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Point& a) { return std::sqrt(dot(a, a)); }
Point scaled(const Point& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
Point sum(const Point& a, const Point& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Point difference(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

void start(Footprint& out) {
  out.u0 = out.v0 = out.z0 = kInfinity;
  out.u1 = out.v1 = out.z1 = -kInfinity;
  out.cuts = 0;
  out.covers = false;
}

bool visible_from_point(const Footprint& f) { return f.u0 <= 1 && f.u1 >= -1 && f.v0 <= 1 && f.v1 >= -1; }

/// Values of n . X over a hull, and the half-plane that follows from their minimum. Dividing n . X >= m by
/// the depth z > 0 of X gives n . (u, v, 1) >= m / z, and m / z is smallest at the nearest depth for m < 0,
/// and at least 0 otherwise. This holds for any n, so n itself may be rounded as it likes.
void add_cut(const Point& n, double least, const Footprint& f, bool perspective, Footprint& out) {
  if (out.cuts >= 3 || !(std::fabs(n[0]) + std::fabs(n[1]) > 0)) return;
  double* cut = out.cut[out.cuts];
  cut[0] = n[0];
  cut[1] = n[1];
  if (perspective) {
    const double rounding = kRound * (std::fabs(n[0]) + std::fabs(n[1]) + std::fabs(n[2]));
    cut[2] = n[2] + rounding - std::min(0.0, least) / f.z0;
  } else {
    cut[2] = -least;
  }
  if (!std::isfinite(cut[2])) return;
  ++out.cuts;
}

}  // namespace

Plane::Plane(const View& view, int face) : view_(view), slack_(view.slack) {
  if (view.kind == View::Kind::kPoint) {
    axis_ = face >> 1;
    sign_ = (face & 1) != 0 ? -1 : 1;
    axis_u_ = axis_ == 2 ? 0 : axis_ + 1;
    axis_v_ = axis_u_ == 2 ? 0 : axis_u_ + 1;
    return;
  }
  // Any two directions across; the third row looks against the rays.
  const Point& d = view.direction;
  const Point a = std::fabs(d[0]) < 0.6 ? Point{1, 0, 0} : Point{0, 1, 0};
  const Point u = cross(d, a);
  row_[0] = scaled(u, 1 / length(u));
  row_[1] = cross(d, row_[0]);
  row_[2] = scaled(d, -1);
}

Point Plane::local(const Point& p) const {
  if (view_.kind == View::Kind::kParallel) return {dot(row_[0], p), dot(row_[1], p), dot(row_[2], p)};
  return {p[axis_u_] - view_.apex[axis_u_], p[axis_v_] - view_.apex[axis_v_],
          sign_ * (p[axis_] - view_.apex[axis_])};
}

bool Plane::project(const Bounds& box, Footprint& out) const {
  start(out);
  Point lo = local(box.lo), hi = local(box.hi);
  if (view_.kind == View::Kind::kParallel) {
    const Point center = scaled(sum(box.lo, box.hi), 0.5), half = scaled(difference(box.hi, box.lo), 0.5);
    const Point c = local(center);
    double reach[3];
    for (int i = 0; i < 3; ++i) {
      reach[i] = std::fabs(row_[i][0]) * half[0] + std::fabs(row_[i][1]) * half[1] +
                 std::fabs(row_[i][2]) * half[2] + slack_;
    }
    out.u0 = c[0] - reach[0], out.u1 = c[0] + reach[0];
    out.v0 = c[1] - reach[1], out.v1 = c[1] + reach[1];
    out.z0 = c[2] - reach[2], out.z1 = c[2] + reach[2];
    return true;
  }
  if (sign_ < 0) std::swap(lo[2], hi[2]);
  for (int i = 0; i < 3; ++i) {
    lo[i] -= slack_;
    hi[i] += slack_;
  }
  if (!(hi[2] > 0)) return false;
  const double near = std::max(lo[2], std::numeric_limits<double>::min()), far = hi[2];
  const auto least = [&](double x) { return x >= 0 ? x / far : x / near; };
  const auto most = [&](double x) { return x >= 0 ? x / near : x / far; };
  const auto down = [](double x) { return x - kRound * std::fabs(x); };
  const auto up = [](double x) { return x + kRound * std::fabs(x); };
  out.u0 = std::max(-2.0, down(least(lo[0]))), out.u1 = std::min(2.0, up(most(hi[0])));
  out.v0 = std::max(-2.0, down(least(lo[1]))), out.v1 = std::min(2.0, up(most(hi[1])));
  out.z0 = std::max(0.0, lo[2]), out.z1 = far;
  return visible_from_point(out);
}

bool Plane::project(const Geometry& geometry, Footprint& out) const {
  switch (geometry.form) {
    case Geometry::Form::kPoints:
    case Geometry::Form::kPolygon:
      return project_points(geometry, out);
    case Geometry::Form::kSpheres:
      return project_spheres(geometry, out);
    default:
      return project(geometry.box, out);
  }
}

/// The image of a convex hull in front of the apex is the hull of the images. A point moved by `slack` moves
/// its u = x/z by at most slack (1 + |u|) / (z - slack).
bool Plane::project_points(const Geometry& geometry, Footprint& out) const {
  start(out);
  const bool perspective = view_.kind == View::Kind::kPoint;
  for (const Point& point : geometry.points) {
    const Point p = local(point);
    double u = p[0], v = p[1], eu = slack_, ev = slack_;
    if (perspective) {
      if (!(p[2] > kNear * slack_)) return project(geometry.box, out);
      const double inverse = 1 / p[2], grow = 1.02 * slack_ * inverse;
      u *= inverse;
      v *= inverse;
      eu = grow * (1 + std::fabs(u)) + kRound * std::fabs(u);
      ev = grow * (1 + std::fabs(v)) + kRound * std::fabs(v);
    }
    out.u0 = std::min(out.u0, u - eu), out.u1 = std::max(out.u1, u + eu);
    out.v0 = std::min(out.v0, v - ev), out.v1 = std::max(out.v1, v + ev);
    out.z0 = std::min(out.z0, p[2] - slack_), out.z1 = std::max(out.z1, p[2] + slack_);
  }
  if (!(out.u0 <= out.u1)) return project(geometry.box, out);
  if (perspective && !visible_from_point(out)) return false;
  if (geometry.form == Geometry::Form::kPolygon) add_polygon_cuts(geometry, out);
  return true;
}

/// One half-plane per edge: the plane through the apex (or along the rays) and the edge. Of polygons with
/// more edges the three longest.
void Plane::add_polygon_cuts(const Geometry& geometry, Footprint& out) const {
  const bool perspective = view_.kind == View::Kind::kPoint;
  const std::size_t count = geometry.points.size();
  if (count < 3 || count > 8) return;
  Point p[8];
  for (std::size_t i = 0; i < count; ++i) p[i] = local(geometry.points[i]);
  std::size_t order[8];
  double size[8];
  for (std::size_t i = 0; i < count; ++i) {
    const Point e = difference(p[(i + 1) % count], p[i]);
    order[i] = i;
    size[i] = perspective ? dot(cross(p[i], e), cross(p[i], e)) : e[0] * e[0] + e[1] * e[1];
  }
  if (count > 3)
    std::sort(order, order + count, [&](std::size_t a, std::size_t b) { return size[a] > size[b]; });
  const auto value_at = [&](const Point& normal, const Point& x) {
    return normal[0] * x[0] + normal[1] * x[1] + (perspective ? normal[2] * x[2] : 0);
  };
  const Footprint whole = out;
  bool covers = geometry.opaque && count == 3 && perspective;
  for (std::size_t k = 0; k < std::min<std::size_t>(3, count); ++k) {
    const Point &a = p[order[k]], &b = p[(order[k] + 1) % count];
    Point n = perspective ? cross(a, b) : Point{a[1] - b[1], b[0] - a[0], 0};
    const double size_n = perspective ? length(n) : std::hypot(n[0], n[1]);
    if (!(size_n > 0)) return;
    n = scaled(n, 1 / size_n);
    double least = kInfinity, most = -kInfinity, reach = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double value = value_at(n, p[i]);
      least = std::min(least, value);
      most = std::max(most, value);
      reach = std::max(reach, std::fabs(n[0] * p[i][0]) + std::fabs(n[1] * p[i][1]) +
                                  (perspective ? std::fabs(n[2] * p[i][2]) : 0));
    }
    if (-least > most) {
      n = scaled(n, -1);
      std::swap(least, most);
      least = -least;
      most = -most;
    }
    const double blur = 1.02 * slack_ + kRound * reach;
    const int before = out.cuts;
    add_cut(n, least - blur, whole, perspective, out);
    covers = covers && out.cuts > before;
    if (!covers) continue;
    // Inside by more than twice the blur on all sides, and not seen edge-on, the exact test surely hits. The
    // edge itself is off the plane by what its normal is rounded by, which is much for edges far from the
    // apex and short beside that: by `off`. Beside that the triangle must be wide, or it has no inside.
    const double off = std::max(std::fabs(value_at(n, a)), std::fabs(value_at(n, b))) + kRound * reach;
    out.inside[before] = 2 * (out.cut[before][2] - n[2]) + (off + 4 * blur) / whole.z0;
    covers = most / whole.z1 > 4 * out.inside[before] + 8 * off / whole.z0;
  }
  if (covers) {
    const Point normal = cross(difference(p[1], p[0]), difference(p[2], p[0]));
    const double size_n = length(normal);
    out.covers = size_n > 0 && std::fabs(dot(normal, p[0])) > 1e-3 * size_n * length(p[0]);
  }
}

bool Plane::project_spheres(const Geometry& geometry, Footprint& out) const {
  start(out);
  const bool perspective = view_.kind == View::Kind::kPoint;
  for (int i = 0; i < geometry.spheres; ++i) {
    const Point c = local(geometry.center[i]);
    const double r = geometry.radius[i] + slack_;
    const double near = c[2] - r, far = c[2] + r;
    double u0 = c[0] - r, u1 = c[0] + r, v0 = c[1] - r, v1 = c[1] + r;
    if (perspective) {
      if (!(near > kNear * slack_ && near > 1e-3 * r)) return project(geometry.box, out);
      // The two planes through the apex and the other axis that touch the sphere.
      const double square = near * far;
      const auto tangents = [&](double x, double& lo, double& hi) {
        const double root = r * std::sqrt(x * x + square), product = x * c[2];
        const double error = kRound * (std::fabs(product) + root);
        lo = (product - root - error) / square;
        hi = (product + root + error) / square;
        lo -= kRound * std::fabs(lo);
        hi += kRound * std::fabs(hi);
      };
      tangents(c[0], u0, u1);
      tangents(c[1], v0, v1);
    }
    out.u0 = std::min(out.u0, u0), out.u1 = std::max(out.u1, u1);
    out.v0 = std::min(out.v0, v0), out.v1 = std::max(out.v1, v1);
    out.z0 = std::min(out.z0, near), out.z1 = std::max(out.z1, far);
  }
  if (!(out.u0 <= out.u1)) return project(geometry.box, out);
  if (perspective && !visible_from_point(out)) return false;
  if (geometry.spheres == 2) add_sphere_cuts(geometry, out);
  return true;
}

/// The two planes through the apex (or along the rays) that touch both balls on the same side.
void Plane::add_sphere_cuts(const Geometry& geometry, Footprint& out) const {
  const bool perspective = view_.kind == View::Kind::kPoint;
  Point a = local(geometry.center[0]), b = local(geometry.center[1]);
  const double ra = geometry.radius[0] + slack_, rb = geometry.radius[1] + slack_;
  if (!perspective) a[2] = b[2] = 0;
  Point along, across;
  double share;  // of `along` in the unit normal
  if (perspective) {
    // n = alpha a + beta b + gamma a x b with n . a = ra, n . b = rb.
    const double aa = dot(a, a), ab = dot(a, b), bb = dot(b, b);
    const double determinant = aa * bb - ab * ab;
    if (!(determinant > 1e-10 * aa * bb)) return;
    along = sum(scaled(a, (ra * bb - rb * ab) / determinant), scaled(b, (rb * aa - ra * ab) / determinant));
    across = cross(a, b);
    across = scaled(across, 1 / length(across));
    share = 1;
  } else {
    const Point d = difference(b, a);
    const double size = std::hypot(d[0], d[1]);
    if (!(size > 1e-5 * (ra + rb))) return;
    along = scaled(d, 1 / size);
    across = {-along[1], along[0], 0};
    share = (rb - ra) / size;
  }
  along = scaled(along, share);
  const double rest = 1 - dot(along, along);
  if (!(rest > 0)) return;
  const Footprint whole = out;
  for (const double side : {1.0, -1.0}) {
    Point n = sum(along, scaled(across, side * std::sqrt(rest)));
    n = scaled(n, 1 / length(n));
    const auto support = [&](const Point& c, double r) {
      const double reach = std::fabs(n[0] * c[0]) + std::fabs(n[1] * c[1]) + std::fabs(n[2] * c[2]);
      return dot(n, c) - r - kRound * (reach + r);
    };
    add_cut(n, std::min(support(a, ra), support(b, rb)), whole, perspective, out);
  }
}

}  // namespace fas
