// SPDX-License-Identifier: MIT
#include "rayshade/geometry/shapes/wall.h"

#include <cmath>

#include "rayshade/geometry/roots/quadratic.h"
#include "rayshade/geometry/shapes/disc.h"
#include "rayshade/geometry/shapes/rounding.h"

namespace rayshade {

Wall::Wall(const Vec3& origin, double radius, const Vec3& end, double end_radius)
    : origin_(origin), frame_(axis_frame(end - origin)), radius_(radius), end_radius_(end_radius) {
  length_ = dot(end - origin, frame_.rows[2]);
  const double rise = end_radius - radius;
  slope_ = rise / length_;
  const Vec3 along = normalize({length_, rise, 0});
  const double widest = std::fmax(std::fabs(radius), std::fabs(end_radius));
  // With room for roundings of rays from far away; there is no harm in asking a few more.
  reach_square_ = 1.001 * (0.25 * length_ * length_ + widest * widest);
  cosine_ = along.x;
  sine_ = along.y;
}

bool Wall::intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const {
  const Vec3 start = frame_.local(ray.origin - origin_);
  const Vec3 d = frame_.local(ray.direction);
  // From the point nearest to the middle of the wall: the coefficients below must not hold squares of a long
  // way, of which little would remain for rays almost parallel to the wall.
  const Vec3 from_middle{start.x, start.y, start.z - 0.5 * length_};
  const double t_start = -dot(from_middle, d) / dot(d, d);
  const Vec3 nearest = from_middle + t_start * d;
  if (!(length_squared(nearest) <= reach_square_)) return false;
  const Vec3 o{nearest.x, nearest.y, nearest.z + 0.5 * length_};

  const double r = radius_at(o.z), s = slope_ * d.z;
  const double across = o.x * d.y - o.y * d.x;
  const double vx = r * d.x - s * o.x, vy = r * d.y - s * o.y;
  const double a = d.x * d.x + d.y * d.y - s * s;
  double discriminant = vx * vx + vy * vy - across * across;
  if (!(discriminant >= 0)) {
    // A line steeper than the wall always meets the double cone: only rounding, at the apex, says otherwise.
    if (!(a < 0)) return false;
    discriminant = 0;
  }
  const double b = o.x * d.x + o.y * d.y - r * s;
  const double c = o.x * o.x + o.y * o.y - r * r;
  const QuadraticRoots roots = quadratic_roots(a, b, c, std::sqrt(discriminant));
  for (const double step : {roots.near, roots.far}) {
    const double t = t_start + step;
    const double z = o.z + step * d.z;
    if (!(t >= lo && z >= 0 && z <= length_) || !std::isfinite(t)) continue;
    if (!(t <= hi)) return false;
    hit.t = t;
    return true;
  }
  return false;
}

SurfacePoint Wall::surface_point(const Ray& ray, const ShapeHit& hit) const {
  const Vec3 q = ray.at(hit.t) - origin_;
  const Vec3& axis = frame_.rows[2];
  const double z = dot(q, axis);
  const Vec3 radial = q - z * axis;
  const double distance = rayshade::length(radial);
  const Vec3 e = distance > 0 ? radial / distance : Vec3{};
  // In the half plane of axis and point the wall is the line distance = nappe (radius + slope z): move along
  // its normal.
  const double nappe = radius_at(z) < 0 ? -1 : 1;
  const double off = cosine_ * distance - nappe * (cosine_ * radius_ + sine_ * z);
  const double new_distance = std::fmax(0.0, distance - off * cosine_);
  const double new_z = z + off * nappe * sine_;

  SurfacePoint out;
  out.point = origin_ + new_z * axis + new_distance * e;
  // At the apex, where e is zero, what remains points along the axis out of the tip.
  out.normal = normalize(nappe * cosine_ * e - sine_ * axis);
  out.geometric_normal = out.normal;
  // Of |q|: 8 for `distance` and z, 5 for the direction of the axis, 9 for e off the horizontal, 5 for the
  // products in `off`, 6 for cosine, sine and slope, 3 for the sum; of the radius the last two.
  out.error = kRoundoff * (40 * rayshade::length(q) + 12 * std::fabs(radius_)) + 2 * storage_error(out.point);
  return out;
}

bool Wall::entering(const Ray& ray, const ShapeHit& hit) const {
  // The sign of the normal of surface_point() along the ray, times the distance from the axis.
  const Vec3 q = ray.at(hit.t) - origin_;
  const Vec3& axis = frame_.rows[2];
  const double z = dot(q, axis), along = dot(axis, ray.direction);
  const Vec3 radial = q - z * axis;
  const double distance = rayshade::length(radial);
  if (!(distance > 0)) return -sine_ * along < 0;
  const double nappe = radius_at(z) < 0 ? -1 : 1;
  return nappe * cosine_ * dot(radial, ray.direction) - sine_ * along * distance < 0;
}

Bounds3 Wall::bounds() const {
  const Vec3& axis = frame_.rows[2];
  const Bounds3 rims = join(disc_bounds(origin_, axis, std::fabs(radius_)),
                            disc_bounds(origin_ + length_ * axis, axis, std::fabs(end_radius_)));
  return grown(rims, 16 * kRoundoff * length_);
}

}  // namespace rayshade
