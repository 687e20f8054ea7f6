// SPDX-License-Identifier: MIT
#include "rayshade/geometry/ray_pack.h"

#include <limits>

#include "fas/compiled_targets.h"
#include "rayshade/geometry/rank.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE \
  "rayshade/geometry/ray_pack.cpp"  // NOLINT: Highway includes this file once per target
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "fas/dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace rayshade::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
using DI = hn::RebindToSigned<D>;
using VI = hn::Vec<DI>;

#define RAYSHADE_LANES HWY_ATTR inline

RAYSHADE_LANES V constant(double x) { return hn::Set(D(), x); }
// As std::min and std::max do it, also for NaN and zeros of either sign.
RAYSHADE_LANES V least(V a, V b) { return hn::IfThenElse(hn::Lt(b, a), b, a); }
RAYSHADE_LANES V most(V a, V b) { return hn::IfThenElse(hn::Lt(a, b), b, a); }
RAYSHADE_LANES M is_finite_lane(V x) {
  return hn::Le(hn::Abs(x), constant(std::numeric_limits<double>::max()));
}

struct V3 {
  V x, y, z;
};
RAYSHADE_LANES V3 constant(const Vec3& v) { return {constant(v.x), constant(v.y), constant(v.z)}; }
RAYSHADE_LANES V3 minus(const V3& a, const V3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
RAYSHADE_LANES V3 plus(const V3& a, const V3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
RAYSHADE_LANES V3 times(V s, const V3& a) { return {s * a.x, s * a.y, s * a.z}; }
RAYSHADE_LANES V dot3(const V3& a, const V3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
RAYSHADE_LANES V3 cross3(const V3& a, const V3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

struct Rays {
  V3 o, d;
  V lo, hi;
};

struct Found {
  M hit;
  V t, a, b, part;
};
RAYSHADE_LANES Found found(M hit, V t) { return {hit, t, constant(0), constant(0), constant(0)}; }

RAYSHADE_LANES M squarely(V t, V slope, V normal_square, V direction_square) {
  const V limit = constant(kEpsilon * kEpsilon) * normal_square * direction_square;
  return hn::And(hn::Ge(slope * slope, limit), is_finite_lane(t));
}

RAYSHADE_LANES Found test(const Plane& plane, const Rays& r, std::uint64_t) {
  const V3 n = constant(plane.normal());
  const V slope = dot3(n, r.d);
  const V t = dot3(n, minus(constant(plane.point()), r.o)) / slope;
  const M within = hn::And(hn::Gt(t, r.lo), hn::Le(t, r.hi));
  return found(hn::And(within, squarely(t, slope, constant(1), dot3(r.d, r.d))), t);
}

struct Roots {
  V near, far;
};
RAYSHADE_LANES Roots roots_of(V a, V b, V c, V root) {
  const V zero = constant(0);
  const V q = hn::IfThenElse(hn::Lt(b, zero), root - b, hn::Neg(root + b));
  const M none = hn::Eq(q, zero);
  const V large = q / a, small = c / q;
  const M order = hn::Lt(large, small);
  const V both = zero / a;
  return {hn::IfThenElse(none, both, hn::IfThenElse(order, large, small)),
          hn::IfThenElse(none, both, hn::IfThenElse(order, small, large))};
}

RAYSHADE_LANES Found test(const Sphere& sphere, const Rays& r, std::uint64_t) {
  const V3 l = minus(r.o, constant(sphere.center()));
  const V a = dot3(r.d, r.d);
  const V square = constant(sphere.radius() * sphere.radius());
  const V3 n = cross3(l, r.d);
  const V discriminant = a * square - dot3(n, n);
  const M real = hn::Ge(discriminant, constant(0));
  if (hn::AllFalse(D(), real)) return found(real, discriminant);
  const Roots roots = roots_of(a, dot3(l, r.d), dot3(l, l) - square, hn::Sqrt(discriminant));
  const V t = hn::IfThenElse(hn::Gt(roots.near, r.lo), roots.near, roots.far);
  const M within = hn::And(hn::And(hn::Gt(t, r.lo), hn::Le(t, r.hi)),
                           hn::Lt(t, constant(std::numeric_limits<double>::infinity())));
  return found(hn::And(real, within), t);
}

struct Slab {
  V near, far;
};
RAYSHADE_LANES Slab slab(double low, double high, V o, V d) {
  const V lo = constant(low), hi = constant(high);
  V a = (lo - o) / d, b = (hi - o) / d;
  const M parallel = hn::Eq(d, constant(0));
  if (!hn::AllFalse(D(), parallel)) {
    const V infinity = constant(std::numeric_limits<double>::infinity());
    const M inside = hn::And(hn::Ge(o, lo), hn::Le(o, hi));
    a = hn::IfThenElse(parallel, hn::IfThenElse(inside, hn::Neg(infinity), infinity), a);
    b = hn::IfThenElse(parallel, infinity, b);
  }
  return {least(a, b), most(a, b)};
}

RAYSHADE_LANES Found test(const Box& box, const Rays& r, std::uint64_t) {
  const Bounds3 extent = box.bounds();
  const Slab x = slab(extent.lo.x, extent.hi.x, r.o.x, r.d.x);
  const Slab y = slab(extent.lo.y, extent.hi.y, r.o.y, r.d.y);
  const Slab z = slab(extent.lo.z, extent.hi.z, r.o.z, r.d.z);
  const V entry = most(most(x.near, y.near), z.near);
  const V exit = least(least(x.far, y.far), z.far);
  const M met = hn::And(hn::Le(entry, exit), hn::Ge(exit, r.lo));
  const M outside = hn::Gt(entry, r.lo);
  const V t = hn::IfThenElse(outside, entry, exit);
  const M within = hn::And(hn::Le(t, r.hi), hn::Lt(t, constant(std::numeric_limits<double>::infinity())));
  const V fx = hn::IfThenElse(outside, x.near, x.far), fy = hn::IfThenElse(outside, y.near, y.far);
  const M is_x = hn::Eq(t, fx), is_y = hn::Eq(t, fy);
  const V d = hn::IfThenElse(is_x, r.d.x, hn::IfThenElse(is_y, r.d.y, r.d.z));
  const V axis = hn::IfThenElse(is_x, constant(0), hn::IfThenElse(is_y, constant(2), constant(4)));
  const M high = hn::Xor(hn::Not(outside), hn::Lt(d, constant(0)));  // outside == (d < 0)
  Found out = found(hn::And(met, within), t);
  out.part = axis + hn::IfThenElse(high, constant(1), constant(0));
  return out;
}

RAYSHADE_LANES Found test(const Disc& disc, const Rays& r, std::uint64_t) {
  const V3 n = constant(disc.normal());
  const V slope = dot3(n, r.d);
  const V3 from_center = minus(r.o, constant(disc.center()));
  const V t = hn::Neg(dot3(n, from_center)) / slope;
  M hit = hn::And(hn::Ge(t, r.lo), hn::Le(t, r.hi));
  const V3 at = plus(from_center, times(t, r.d));
  hit = hn::And(hit, hn::Le(dot3(at, at), constant(disc.radius() * disc.radius())));
  return found(hn::And(hit, squarely(t, slope, constant(1), dot3(r.d, r.d))), t);
}

RAYSHADE_LANES Found test(const Wall& wall, const Rays& r) {
  const AxisFrame& frame = wall.frame();
  const V3 x = constant(frame.rows[0]), y = constant(frame.rows[1]), z = constant(frame.rows[2]);
  const V3 from = minus(r.o, constant(wall.origin()));
  const V3 d{dot3(r.d, x), dot3(r.d, y), dot3(r.d, z)};
  const V half = constant(0.5 * wall.length());
  const V3 from_middle{dot3(from, x), dot3(from, y), dot3(from, z) - half};
  const V t_start = hn::Neg(dot3(from_middle, d)) / dot3(d, d);
  const V3 nearest = plus(from_middle, times(t_start, d));
  M hit = hn::Le(dot3(nearest, nearest), constant(wall.reach_square()));
  if (hn::AllFalse(D(), hit)) return found(hit, t_start);
  const V3 o{nearest.x, nearest.y, nearest.z + half};
  const V zero = constant(0);
  const V radius = constant(wall.start_radius()) + constant(wall.slope()) * o.z;
  const V s = constant(wall.slope()) * d.z;
  const V across = o.x * d.y - o.y * d.x;
  const V vx = radius * d.x - s * o.x, vy = radius * d.y - s * o.y;
  const V a = d.x * d.x + d.y * d.y - s * s;
  V discriminant = vx * vx + vy * vy - across * across;
  const M real = hn::Ge(discriminant, zero);
  hit = hn::And(hit, hn::Or(real, hn::Lt(a, zero)));
  if (hn::AllFalse(D(), hit)) return found(hit, t_start);
  discriminant = hn::IfThenElse(real, discriminant, zero);
  const V b = o.x * d.x + o.y * d.y - radius * s;
  const V c = o.x * o.x + o.y * o.y - radius * radius;
  const Roots roots = roots_of(a, b, c, hn::Sqrt(discriminant));
  const V length = constant(wall.length());
  const auto valid = [&](V t, V step) HWY_ATTR {
    const V height = o.z + step * d.z;
    return hn::And(hn::And(hn::Ge(t, r.lo), is_finite_lane(t)),
                   hn::And(hn::Ge(height, zero), hn::Le(height, length)));
  };
  const V first = t_start + roots.near, second = t_start + roots.far;
  const M first_valid = valid(first, roots.near), second_valid = valid(second, roots.far);
  const V t = hn::IfThenElse(first_valid, first, second);
  return found(hn::And(hn::And(hit, hn::Or(first_valid, second_valid)), hn::Le(t, r.hi)), t);
}
RAYSHADE_LANES Found test(const Cylinder& cylinder, const Rays& r, std::uint64_t) {
  return test(cylinder.wall(), r);
}
RAYSHADE_LANES Found test(const Cone& cone, const Rays& r, std::uint64_t) { return test(cone.wall(), r); }

/// Weights of the vertices for rays whose direction is largest along z (of the axes as they are named here).
/// `unsure`: lanes where an edge function is exactly zero.
RAYSHADE_LANES M weights(const V3 (&p)[3], V ox, V oy, V oz, V dx, V dy, V dz, V (&w)[3], M& unsure) {
  V x[3], y[3];
  for (int i = 0; i < 3; ++i) {
    const V z = p[i].z - oz;
    x[i] = (p[i].x - ox) * dz - z * dx;
    y[i] = (p[i].y - oy) * dz - z * dy;
  }
  w[0] = x[1] * y[2] - y[1] * x[2];
  w[1] = x[2] * y[0] - y[2] * x[0];
  w[2] = x[0] * y[1] - y[0] * x[1];
  const V zero = constant(0);
  const M inside =
      hn::Or(hn::Ge(least(least(w[0], w[1]), w[2]), zero), hn::Le(most(most(w[0], w[1]), w[2]), zero));
  unsure = hn::And(inside, hn::Or(hn::Or(hn::Eq(w[0], zero), hn::Eq(w[1], zero)), hn::Eq(w[2], zero)));
  return inside;
}

/// One lane by the scalar test; for the few rays through an edge's exact zero.
inline void scalar_lane(const Vec3 (&vertices)[3], const Rays& r, std::size_t lane, Found& out) {
  alignas(64) double values[8][8];
  const V lanes[8] = {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, r.lo, r.hi};
  for (int i = 0; i < 8; ++i) hn::Store(lanes[i], D(), values[i]);
  const Triangle triangle(shape::Triangle{{vertices[0], vertices[1], vertices[2]}});
  const Ray ray{{values[0][lane], values[1][lane], values[2][lane]},
                {values[3][lane], values[4][lane], values[5][lane]}};
  ShapeHit hit;
  const bool met = triangle.intersect(ray, values[6][lane], values[7][lane], hit);
  alignas(64) double chosen[8] = {};
  chosen[lane] = 1;
  const M here = hn::Ne(hn::Load(D(), chosen), constant(0));
  out.hit = met ? hn::Or(out.hit, here) : hn::And(out.hit, hn::Not(here));
  out.t = hn::IfThenElse(here, constant(hit.t), out.t);
  out.a = hn::IfThenElse(here, constant(hit.a), out.a);
  out.b = hn::IfThenElse(here, constant(hit.b), out.b);
}

RAYSHADE_LANES Found test_triangle(const Vec3 (&vertices)[3], const Rays& r, std::uint64_t wanted) {
  const V3 p[3] = {constant(vertices[0]), constant(vertices[1]), constant(vertices[2])};
  const V sx = hn::Abs(r.d.x), sy = hn::Abs(r.d.y), sz = hn::Abs(r.d.z);
  const M by_x = hn::And(hn::Gt(sx, sy), hn::Gt(sx, sz));
  const M by_y = hn::AndNot(by_x, hn::Gt(sy, sz));
  const M by_z = hn::Not(hn::Or(by_x, by_y));
  const M none = hn::Lt(constant(0), constant(0));
  M inside = none, unsure = none;
  V w[3] = {constant(0), constant(0), constant(0)};
  const auto take = [&](M lanes, const V(&v)[3], M in, M doubt) HWY_ATTR {
    inside = hn::Or(inside, hn::And(lanes, in));
    unsure = hn::Or(unsure, hn::And(lanes, doubt));
    for (int i = 0; i < 3; ++i) w[i] = hn::IfThenElse(lanes, v[i], w[i]);
  };
  V v[3];
  M doubt;
  if (!hn::AllFalse(D(), by_x)) {
    const V3 q[3] = {{p[0].y, p[0].z, p[0].x}, {p[1].y, p[1].z, p[1].x}, {p[2].y, p[2].z, p[2].x}};
    const M in = weights(q, r.o.y, r.o.z, r.o.x, r.d.y, r.d.z, r.d.x, v, doubt);
    take(by_x, v, in, doubt);
  }
  if (!hn::AllFalse(D(), by_y)) {
    const V3 q[3] = {{p[0].z, p[0].x, p[0].y}, {p[1].z, p[1].x, p[1].y}, {p[2].z, p[2].x, p[2].y}};
    const M in = weights(q, r.o.z, r.o.x, r.o.y, r.d.z, r.d.x, r.d.y, v, doubt);
    take(by_y, v, in, doubt);
  }
  if (!hn::AllFalse(D(), by_z)) {
    const M in = weights(p, r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, v, doubt);
    take(by_z, v, in, doubt);
  }
  Found out = found(inside, constant(0));
  if (hn::AllFalse(D(), inside)) return out;
  const V3 e1 = minus(p[1], p[0]), e2 = minus(p[2], p[1]), n = cross3(e1, e2);
  const V slope = dot3(n, r.d);
  const V known = constant(kWellKnown) * (dot3(e1, e1) * dot3(e2, e2)) * dot3(r.d, r.d);
  unsure = hn::Or(unsure, hn::And(inside, hn::Not(hn::Ge(slope * slope, known))));
  out.t = dot3(n, minus(p[0], r.o)) / slope;
  const M within = hn::And(hn::Ge(out.t, r.lo), hn::Le(out.t, r.hi));
  const V sum = w[0] + w[1] + w[2];
  out.hit = hn::And(hn::And(inside, within), hn::And(squarely(out.t, slope, dot3(n, n), dot3(r.d, r.d)),
                                                     hn::Gt(hn::Abs(sum), constant(0))));
  out.a = w[1] / sum;
  out.b = w[2] / sum;
  if (!hn::AllFalse(D(), unsure)) {
    std::uint64_t lanes = 0;
    hn::StoreMaskBits(D(), unsure, reinterpret_cast<std::uint8_t*>(&lanes));
    for (lanes &= wanted; lanes != 0; lanes &= lanes - 1)
      scalar_lane(vertices, r, static_cast<std::size_t>(__builtin_ctzll(lanes)), out);
  }
  return out;
}
RAYSHADE_LANES Found test(const Triangle& s, const Rays& r, std::uint64_t w) {
  return test_triangle(s.vertices(), r, w);
}
RAYSHADE_LANES Found test(const SmoothTriangle& s, const Rays& r, std::uint64_t w) {
  return test_triangle(s.vertices(), r, w);
}
RAYSHADE_LANES Found test(const UvTriangle& s, const Rays& r, std::uint64_t w) {
  return test_triangle(s.vertices(), r, w);
}

RAYSHADE_LANES V component(const V3& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/// Polygon::winds_around for every lane, edge by edge.
RAYSHADE_LANES M winds_around(const Polygon& polygon, V cu, V cv) {
  const V one = constant(1);
  V winding = constant(0);
  Polygon::Point2 p = polygon.outline().back();
  M above = hn::Ge(constant(p.v), cv), right = hn::Ge(constant(p.u), cu);
  for (const Polygon::Point2 q : polygon.outline()) {
    const M up = hn::Ge(constant(q.v), cv), next_right = hn::Ge(constant(q.u), cu);
    const M spans = hn::Xor(above, up);
    if (!hn::AllFalse(D(), spans)) {
      const V side = constant(q.u - p.u) * (cv - constant(p.v)) - constant(q.v - p.v) * (cu - constant(p.u));
      const M other = hn::Xor(hn::Gt(side, constant(0)), up);  // the sign and the sense differ
      const M mixed = hn::Xor(right, next_right);
      const M crosses = hn::Or(hn::AndNot(other, mixed), hn::AndNot(mixed, right));
      const V step = hn::IfThenElse(up, one, hn::Neg(one));
      winding = winding + hn::IfThenElseZero(hn::And(spans, crosses), step);
    }
    p = q;
    above = up;
    right = next_right;
  }
  return hn::Ne(winding, constant(0));
}

RAYSHADE_LANES Found test(const Polygon& polygon, const Rays& r, std::uint64_t wanted) {
  const V3 n = constant(polygon.normal());
  const V slope = dot3(n, r.d);
  const V t = dot3(n, minus(constant(polygon.point()), r.o)) / slope;
  M hit = hn::And(hn::Ge(t, r.lo), hn::Le(t, r.hi));
  hit = hn::And(hit, squarely(t, slope, constant(1), dot3(r.d, r.d)));
  const V u = component(r.o, polygon.u_axis()) + t * component(r.d, polygon.u_axis());
  const V v = component(r.o, polygon.v_axis()) + t * component(r.d, polygon.v_axis());
  hit = hn::And(hit, hn::And(hn::Ge(u, constant(polygon.lo().u)), hn::Le(u, constant(polygon.hi().u))));
  hit = hn::And(hit, hn::And(hn::Ge(v, constant(polygon.lo().v)), hn::Le(v, constant(polygon.hi().v))));
  std::uint64_t lanes = 0;
  hn::StoreMaskBits(D(), hit, reinterpret_cast<std::uint8_t*>(&lanes));
  lanes &= wanted;
  if (lanes == 0 || polygon.takes_every_edge())
    return found(lanes == 0 ? hit : hn::And(hit, winds_around(polygon, u, v)), t);
  alignas(64) double us[8], vs[8], inside[8] = {};
  hn::Store(u, D(), us);
  hn::Store(v, D(), vs);
  for (; lanes != 0; lanes &= lanes - 1) {
    const int i = __builtin_ctzll(lanes);
    inside[i] = polygon.contains(us[i], vs[i]) ? 1 : 0;
  }
  return found(hn::Ne(hn::Load(D(), inside), constant(0)), t);
}

RAYSHADE_LANES V3 mapped(const Affine& map, const V3& v) {
  return plus(plus(times(v.x, constant(map.rows[0])), times(v.y, constant(map.rows[1]))),
              times(v.z, constant(map.rows[2])));
}

template <class Shape>
HWY_ATTR Found test_at(const Shape& shape, const Affine* inverse, const RayPack& pack, std::size_t i,
                       std::uint64_t wanted) {
  const D d;
  Rays r{{hn::Load(d, pack.origin[0] + i), hn::Load(d, pack.origin[1] + i), hn::Load(d, pack.origin[2] + i)},
         {hn::Load(d, pack.direction[0] + i), hn::Load(d, pack.direction[1] + i),
          hn::Load(d, pack.direction[2] + i)},
         hn::Load(d, pack.lo + i),
         hn::Load(d, pack.t + i)};
  if (inverse) {
    r.o = plus(mapped(*inverse, r.o), constant(inverse->translation));
    r.d = mapped(*inverse, r.d);
  }
  return test(shape, r, wanted);
}

template <class Shape>
HWY_ATTR std::uint64_t improve_shape(const Shape& shape, const Affine* inverse, std::int64_t rank,
                                     RayPack& pack, std::uint64_t mask) {
  const D d;
  const DI di;
  const std::size_t n = hn::Lanes(d);
  const std::uint64_t lanes = (std::uint64_t{1} << n) - 1;
  std::uint64_t improved = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(pack.count); i += n) {
    const std::uint64_t wanted = mask >> i & lanes;
    if (wanted == 0) continue;
    const Found f = test_at(shape, inverse, pack, i, wanted);
    const M equal = hn::Eq(f.t, hn::Load(d, pack.t + i));
    const VI ranks = hn::Load(di, pack.rank + i);
    const M worse = hn::And(equal, hn::RebindMask(d, hn::Not(hn::Lt(hn::Set(di, rank), ranks))));
    std::uint64_t bits = 0;
    hn::StoreMaskBits(d, hn::AndNot(worse, f.hit), reinterpret_cast<std::uint8_t*>(&bits));
    bits &= wanted;
    if (bits == 0) continue;
    const auto m8 = static_cast<std::uint8_t>(bits);
    alignas(8) std::uint8_t mask_bytes[8] = {m8};
    const M better = hn::LoadMaskBits(d, mask_bytes);
    hn::Store(hn::IfThenElse(better, f.t, hn::Load(d, pack.t + i)), d, pack.t + i);
    hn::Store(hn::IfThenElse(better, f.a, hn::Load(d, pack.a + i)), d, pack.a + i);
    hn::Store(hn::IfThenElse(better, f.b, hn::Load(d, pack.b + i)), d, pack.b + i);
    hn::Store(hn::IfThenElse(better, f.part, hn::Load(d, pack.part + i)), d, pack.part + i);
    hn::Store(hn::IfThenElse(hn::RebindMask(di, better), hn::Set(di, rank), ranks), di, pack.rank + i);
    improved |= bits << i;
  }
  return improved;
}

template <class Shape>
HWY_ATTR std::uint64_t occlude_shape(const Shape& shape, const Affine* inverse, bool closed,
                                     const RayPack& pack, std::uint64_t mask) {
  const D d;
  const std::size_t n = hn::Lanes(d);
  const std::uint64_t lanes = (std::uint64_t{1} << n) - 1;
  std::uint64_t stopped = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(pack.count); i += n) {
    const std::uint64_t wanted = mask >> i & lanes;
    if (wanted == 0) continue;
    const Found f = test_at(shape, inverse, pack, i, wanted);
    const M before = closed ? f.hit : hn::And(f.hit, hn::Lt(f.t, hn::Load(d, pack.t + i)));
    std::uint64_t bits = 0;
    hn::StoreMaskBits(d, before, reinterpret_cast<std::uint8_t*>(&bits));
    stopped |= (bits & wanted) << i;
  }
  return stopped;
}

/// Calls `f` with the shape of a leaf.
template <class F>
HWY_ATTR std::uint64_t with_shape(const CompiledScene& scene, const Leaf& leaf, const F& f) {
  switch (leaf.kind) {
    case LeafKind::kPlane:
      return f(scene.planes[leaf.shape]);
    case LeafKind::kSphere:
      return f(scene.spheres[leaf.shape]);
    case LeafKind::kBox:
      return f(scene.boxes[leaf.shape]);
    case LeafKind::kDisc:
      return f(scene.discs[leaf.shape]);
    case LeafKind::kCylinder:
      return f(scene.cylinders[leaf.shape]);
    case LeafKind::kCone:
      return f(scene.cones[leaf.shape]);
    case LeafKind::kTriangle:
      return f(scene.triangles[leaf.shape]);
    case LeafKind::kSmoothTriangle:
      return f(scene.smooth_triangles[leaf.shape]);
    case LeafKind::kUvTriangle:
      return f(scene.uv_triangles[leaf.shape]);
    case LeafKind::kPolygon:
      return f(scene.polygons[leaf.shape]);
    default:
      return std::uint64_t{0};
  }
}

inline const Affine* inverse_of(const CompiledScene& scene, const Leaf& leaf) {
  return leaf.placement == kNone ? nullptr : &scene.placements[leaf.placement].map.inverse;
}

HWY_ATTR std::uint64_t improve(const CompiledScene& scene, const Leaf& leaf, std::int64_t rank, RayPack& pack,
                               std::uint64_t mask) {
  const Affine* inverse = inverse_of(scene, leaf);
  return with_shape(scene, leaf, [&](const auto& shape) HWY_ATTR {
    return improve_shape(shape, inverse, rank, pack, mask);
  });
}

HWY_ATTR std::uint64_t occlude(const CompiledScene& scene, const Leaf& leaf, const RayPack& pack,
                               std::uint64_t mask) {
  const Affine* inverse = inverse_of(scene, leaf);
  const bool closed = closed_at_far_limit(leaf.kind);
  return with_shape(scene, leaf, [&](const auto& shape) HWY_ATTR {
    return occlude_shape(shape, inverse, closed, pack, mask);
  });
}

HWY_ATTR void prepare(RayPack& pack) {
  const D d;
  const std::size_t n = hn::Lanes(d);
  for (std::size_t i = 0; i < static_cast<std::size_t>(pack.count); i += n) {
    V size = constant(0);
    for (int axis = 0; axis < 3; ++axis) {
      hn::Store(constant(1) / hn::Load(d, pack.direction[axis] + i), d, pack.inverse[axis] + i);
      size = most(size, hn::Abs(hn::Load(d, pack.origin[axis] + i)));
    }
    hn::Store(size, d, pack.size + i);
  }
}

/// fas::clip() for every lane.
HWY_ATTR std::uint64_t clip(const Bounds3& box, double condition, const RayPack& rays, const RayPack& limits,
                            std::uint64_t mask) {
  const D d;
  const std::size_t n = hn::Lanes(d);
  const std::uint64_t lanes = (std::uint64_t{1} << n) - 1;
  constexpr double kUnit = 64 * std::numeric_limits<double>::epsilon();
  const double extent = max_abs(box.lo) + max_abs(box.hi);
  std::uint64_t met = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(rays.count); i += n) {
    const std::uint64_t wanted = mask >> i & lanes;
    if (wanted == 0) continue;
    const V slack = constant(kUnit * condition) * (hn::Load(d, rays.size + i) + constant(extent));
    V entry = hn::Load(d, limits.lo + i), exit = hn::Load(d, limits.t + i);
    for (int axis = 0; axis < 3; ++axis) {
      const V o = hn::Load(d, rays.origin[axis] + i), inverse = hn::Load(d, rays.inverse[axis] + i);
      const V low = constant(box.lo[axis]) - slack - o, high = constant(box.hi[axis]) + slack - o;
      const M forward = hn::Ge(hn::CopySign(constant(1), inverse), constant(0));
      entry = most(entry, hn::IfThenElse(forward, low, high) * inverse);
      exit = least(exit, hn::IfThenElse(forward, high, low) * inverse);
    }
    std::uint64_t bits = 0;
    const V room = constant(8 * std::numeric_limits<double>::epsilon()) * hn::Abs(exit);
    hn::StoreMaskBits(d, hn::Le(entry, exit + room), reinterpret_cast<std::uint8_t*>(&bits));
    met |= (bits & wanted) << i;
  }
  return met;
}

#undef RAYSHADE_LANES

}  // namespace rayshade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayshade {

namespace {
constexpr auto kImprove = FAS_VERSIONS(improve);
constexpr auto kOcclude = FAS_VERSIONS(occlude);
constexpr auto kPrepare = FAS_VERSIONS(prepare);
constexpr auto kClip = FAS_VERSIONS(clip);
}  // namespace

RayPack::Mask improve_pack(const CompiledScene& scene, LeafId id, RayPack& pack, RayPack::Mask mask) {
  const Leaf& leaf = scene.leaves[id];
  const auto rank = static_cast<std::int64_t>(rank_of(leaf.kind, leaf.order));
  const RayPack::Mask better = kImprove.best()(scene, leaf, rank, pack, mask);
  for_each_ray(better, [&](std::size_t i) {
    pack.leaf[i] = id;
    pack.flag[i] = EnterFlag::kUnset;
  });
  return better;
}

RayPack::Mask occlude_pack(const CompiledScene& scene, const Leaf& leaf, const RayPack& pack,
                           RayPack::Mask mask) {
  return kOcclude.best()(scene, leaf, pack, mask);
}

void prepare_pack(RayPack& pack) {
  if (!pack.clip_ready) kPrepare.best()(pack);
  pack.clip_ready = true;
}

RayPack::Mask clip_pack(const Bounds3& box, double condition, RayPack& rays, const RayPack& limits,
                        RayPack::Mask mask) {
  prepare_pack(rays);
  return kClip.best()(box, condition, rays, limits, mask);
}

}  // namespace rayshade
#endif
