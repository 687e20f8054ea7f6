// SPDX-License-Identifier: MIT
#include "rayshade/geometry/shapes/polygon.h"

#include "rayshade/geometry/shapes/flat.h"

namespace rayshade {

Polygon::Polygon(const shape::Polygon& polygon, bool flip) : point_(polygon.points.front()) {
  // Newell's sum, relative to the first vertex so that a polygon far from the origin keeps its accuracy.
  Vec3 n, sizes;
  Vec3 previous = polygon.points.back() - point_;
  for (const Vec3& vertex : polygon.points) {
    const Vec3 current = vertex - point_;
    const Vec3 difference = previous - current, sum = previous + current;
    const Vec3 term{difference.y * sum.z, difference.z * sum.x, difference.x * sum.y};
    n += term;
    sizes += abs(term);
    bounds_.add(vertex);
    previous = current;
  }
  const auto count = polygon.points.size();
  normal_ = normalize(flip ? -n : n);
  normal_error_ = kNormalizeError + kRoundoff * (static_cast<double>(count) + 8) * length(sizes) / length(n);

  const Vec3 m = abs(n);
  const int dropped = m.x >= m.y && m.x >= m.z ? 0 : m.y >= m.z ? 1 : 2;
  u_axis_ = dropped == 0 ? 1 : 0;
  v_axis_ = dropped == 2 ? 1 : 2;
  const Bounds3 corners = bounds_;
  lo_ = {corners.lo[u_axis_], corners.lo[v_axis_]};
  hi_ = {corners.hi[u_axis_], corners.hi[v_axis_]};
  vertices_.reserve(count);
  for (const Vec3& vertex : polygon.points) {
    vertices_.push_back({vertex[u_axis_], vertex[v_axis_]});
    // The surface is in the plane, also where the vertex is not.
    Vec3 projected = vertex;
    projected[dropped] -= dot(normal_, vertex - point_) / normal_[dropped];
    bounds_.add(projected);
  }
  bounds_ =
      grown(bounds_, (16 * kRoundoff + 4 * normal_error_) * (corners.largest_extent() + max_abs(point_)));
}

bool Polygon::winds_around(Point2 c) const {
  const auto quadrant = [c](Point2 p) {  // counter-clockwise from right and above
    const int left = !(p.u >= c.u), below = !(p.v >= c.v);
    return below ? 3 - left : left;
  };
  int winding = 0;
  Point2 p = vertices_.back();
  int from = quadrant(p);
  for (const Point2 q : vertices_) {
    const int to = quadrant(q);
    switch ((to - from) & 3) {
      case 1:
        ++winding;
        break;
      case 3:
        --winding;
        break;
      case 2:
        winding += (q.u - p.u) * (c.v - p.v) - (q.v - p.v) * (c.u - p.u) > 0 ? 2 : -2;
        break;
      default:
        break;
    }
    p = q;
    from = to;
  }
  return winding != 0;
}

Vec3 Polygon::corner(std::size_t i) const {
  const int w_axis = 3 - u_axis_ - v_axis_;
  Vec3 out;
  out[u_axis_] = vertices_[i].u;
  out[v_axis_] = vertices_[i].v;
  out[w_axis] = point_[w_axis] - (normal_[u_axis_] * (vertices_[i].u - point_[u_axis_]) +
                                  normal_[v_axis_] * (vertices_[i].v - point_[v_axis_])) /
                                     normal_[w_axis];
  return out;
}

bool Polygon::intersect(const Ray& ray, double lo, double hi, ShapeHit& hit) const {
  const double slope = dot(normal_, ray.direction);
  const double t = dot(normal_, point_ - ray.origin) / slope;
  if (!(t >= lo && t <= hi) || !hit_squarely(t, slope, 1, dot(ray.direction, ray.direction))) return false;
  if (!contains(ray.origin[u_axis_] + t * ray.direction[u_axis_],
                ray.origin[v_axis_] + t * ray.direction[v_axis_])) {
    return false;
  }
  hit.t = t;
  return true;
}

SurfacePoint Polygon::surface_point(const Ray& ray, const ShapeHit& hit) const {
  const OnPlane on = onto_plane(ray.at(hit.t), point_, normal_, normal_error_);
  return {on.point, normal_, normal_, on.error, false};
}

TextureCoordinates Polygon::texture_coordinates(const Vec3& x, const Vec3& /*facing_normal*/,
                                                const ShapeHit& /*hit*/) const {
  return {x.x, x.y, {1, 0, 0}, {0, 1, 0}};
}

}  // namespace rayshade
