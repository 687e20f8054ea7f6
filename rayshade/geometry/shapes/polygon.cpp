// SPDX-License-Identifier: MIT
#include "rayshade/geometry/shapes/polygon.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "rayshade/geometry/shapes/flat.h"

namespace rayshade {

Polygon::Polygon(const shape::Polygon& polygon, bool flip) : point_(polygon.points.front()) {
  // Newell's sum, relative to the first vertex so that a polygon far from the origin keeps its accuracy, and
  // summed with what each addition rounds away, so that many vertices cost nothing.
  Vec3 n, lost, sizes;
  double swept = 0;  // how far n goes if every vertex is off by a unit of its distance from the first
  const std::size_t count = polygon.points.size();
  Vec3 before = polygon.points[count - 2] - point_, previous = polygon.points[count - 1] - point_;
  for (const Vec3& vertex : polygon.points) {
    const Vec3 current = vertex - point_;
    const Vec3 difference = previous - current, sum = previous + current;
    const Vec3 term{difference.y * sum.z, difference.z * sum.x, difference.x * sum.y};
    const Vec3 next = n + term, part = next - n;
    lost += (n - (next - part)) + (term - part);
    n = next;
    sizes += abs(term);
    swept += length(previous) * length(current - before);
    bounds_.add(vertex);
    before = previous;
    previous = current;
  }
  n += lost;
  normal_ = normalize(flip ? -n : n);
  // Three roundings for every term; n is the sum of cross products of neighbours, so a vertex that is off by
  // delta moves it by delta x (next - before).
  normal_error_ = kNormalizeError + kRoundoff * (1 + (3 * length(sizes) + swept) / length(n));

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
  make_buckets();
  bounds_ =
      grown(bounds_, (16 * kRoundoff + 4 * normal_error_) * (corners.largest_extent() + max_abs(point_)));
}

/// Edges by the range of v that they span: flat, so that a polygon of thousands of vertices is two
/// allocations.
struct Polygon::Buckets {
  double low, scale;
  std::vector<std::uint32_t> first;  ///< of each bucket in `edges`; one more at the end
  std::vector<std::uint32_t> edges;  ///< number of the edge's end vertex

  /// Monotonic in v, so that an edge stands in every bucket between those of its ends.
  std::size_t of(double v) const {
    const double place = (v - low) * scale;
    const auto last = static_cast<double>(first.size() - 2);
    return static_cast<std::size_t>(place > 0 ? std::min(place, last) : 0);
  }
};

void Polygon::make_buckets() {
  constexpr std::size_t kFewVertices = 12;
  const std::size_t count = vertices_.size();
  const double height = hi_.v - lo_.v;
  if (count <= kFewVertices || !(height > 0)) return;
  auto buckets = std::make_shared<Buckets>();
  buckets->low = lo_.v;
  buckets->scale = static_cast<double>(count) / height;
  if (!std::isfinite(buckets->scale)) return;
  buckets->first.assign(count + 1, 0);
  const auto each = [&](const auto& visit) {
    for (std::size_t i = 0; i < count; ++i) {
      const double a = vertices_[i == 0 ? count - 1 : i - 1].v, b = vertices_[i].v;
      if (a == b) continue;  // never crossed
      for (std::size_t k = buckets->of(std::min(a, b)); k <= buckets->of(std::max(a, b)); ++k) visit(k, i);
    }
  };
  std::size_t total = 0;
  each([&](std::size_t k, std::size_t) { ++buckets->first[k + 1], ++total; });
  // A zigzag of tall edges would fill every bucket with all of them; then a loop does as well.
  if (total > 8 * count) return;
  for (std::size_t k = 0; k < count; ++k) buckets->first[k + 1] += buckets->first[k];
  buckets->edges.resize(total);
  std::vector<std::uint32_t> next(buckets->first.begin(), buckets->first.end() - 1);
  each([&](std::size_t k, std::size_t i) { buckets->edges[next[k]++] = static_cast<std::uint32_t>(i); });
  buckets_ = std::move(buckets);
}

/// The sum of quadrants that objects.md 4.5 speaks of is four times the number of signed crossings of the
/// half-line from c to the right. A step crosses it only if its ends lie on different sides of v = c.v, and
/// then: with both ends to the right it does, with both to the left it does not, otherwise the sign of the
/// cross product says so, as it says for opposite quadrants which way round the step goes (upward a positive
/// sign is a crossing, downward the other). So only edges that span c.v need to be looked at.
bool Polygon::winds_around(Point2 c) const {
  int winding = 0;
  const auto step = [&](Point2 p, Point2 q) {
    // Without branches: which way they go cannot be foreseen.
    const bool up = q.v >= c.v, right = p.u >= c.u;
    const bool spans = (p.v >= c.v) != up, mixed = right != (q.u >= c.u);
    const bool side = ((q.u - p.u) * (c.v - p.v) - (q.v - p.v) * (c.u - p.u) > 0) == up;
    const bool crosses = spans & ((mixed & side) | (!mixed & right));
    winding += static_cast<int>(crosses) * (2 * static_cast<int>(up) - 1);
  };
  if (buckets_) {
    const std::size_t k = buckets_->of(c.v);
    for (std::uint32_t at = buckets_->first[k]; at < buckets_->first[k + 1]; ++at) {
      const std::uint32_t i = buckets_->edges[at];
      step(vertices_[i == 0 ? vertices_.size() - 1 : i - 1], vertices_[i]);
    }
  } else {
    Point2 p = vertices_.back();
    for (const Point2 q : vertices_) {
      step(p, q);
      p = q;
    }
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
