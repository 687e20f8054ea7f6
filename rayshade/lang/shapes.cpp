// SPDX-License-Identifier: MIT
// See shapes.h.
#include "rayshade/lang/shapes.h"

#include <algorithm>
#include <utility>

namespace rayshade::lang {
namespace {

/// Areas below this share of the square of the extent are rounding errors of points on one line.
constexpr double kFlat = 1e-15;

/// Twice the area, as a vector; zero where the corners lie on one line within rounding.
Vec3 area_normal(const Vec3 (&p)[3]) {
  const Vec3 a = p[1] - p[0], b = p[2] - p[1];
  const Vec3 normal = cross(a, b);
  return length(normal) <= kFlat * length(a) * length(b) ? Vec3{} : normal;
}

/// Newell's normal relative to the first vertex; zero where the polygon has no area within rounding.
Vec3 area_normal(const std::vector<Vec3>& points) {
  Vec3 sum;
  double parts = 0, extent = 0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Vec3 a = points[i] - points[0], b = points[i + 1] - points[0];
    const Vec3 part = cross(a, b);
    sum += part;
    parts += length(part);
    extent = std::max({extent, length_squared(a), length_squared(b)});
  }
  return length(sum) <= std::max(10 * kFlat * parts, kFlat * extent) ? Vec3{} : sum;
}

bool equal_radii(double a, double b) {
  const double difference = std::fabs(a - b), size = std::max(std::fabs(a), std::fabs(b));
  // The original's tolerance holds for cones of ordinary size; smaller ones must differ in proportion.
  return difference <= 1e-12 * size || (size >= 1e-2 && difference < kEpsilon);
}

}  // namespace

NodeId Shapes::drop(const Span& at, const char* why) {
  context_.messages.warning(at, std::string(why) + "; it is dropped");
  return drop_quietly();
}

/// A dropped primitive still uses up its surface and is no mistake.
NodeId Shapes::drop_quietly() { return objects_.degenerate(); }

template <typename Shape>
NodeId Shapes::store(NodeKind kind, const Span& at, std::deque<Shape>& pool, Shape shape) {
  pool.push_back(std::move(shape));
  return objects_.primitive(kind, pool.size() - 1, at);
}

NodeId Shapes::plane(const Span& at, const Vec3& point, const Vec3& normal) {
  if (degenerate(length(normal))) return drop(at, "degenerate plane: its normal has no length");
  return store(NodeKind::kPlane, at, context_.scene.planes, {point, normal});
}

NodeId Shapes::sphere(const Span& at, double radius, const Vec3& center) {
  if (degenerate(radius)) return drop(at, "degenerate sphere: its radius must be positive");
  return store(NodeKind::kSphere, at, context_.scene.spheres, {radius, center});
}

NodeId Shapes::box(const Span& at, const Vec3& a, const Vec3& b) {
  const Vec3 lo{std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
  const Vec3 hi{std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
  const Vec3 extent = hi - lo;
  if (degenerate(extent.x) || degenerate(extent.y) || degenerate(extent.z)) {
    return drop(at, "degenerate box: it has no extent along an axis");
  }
  return store(NodeKind::kBox, at, context_.scene.boxes, {lo, hi});
}

NodeId Shapes::disc(const Span& at, double radius, const Vec3& center, const Vec3& normal) {
  if (degenerate(radius)) return drop(at, "degenerate disc: its radius must be positive");
  if (degenerate(length(normal))) return drop(at, "degenerate disc: its normal has no length");
  return store(NodeKind::kDisc, at, context_.scene.discs, {radius, center, normal});
}

NodeId Shapes::cylinder(const Span& at, double radius, const Vec3& bottom, const Vec3& top) {
  if (degenerate(radius)) return drop(at, "invalid cylinder: its radius must be positive");
  if (degenerate(length(top - bottom))) return drop(at, "degenerate cylinder: it has no length");
  return store(NodeKind::kCylinder, at, context_.scene.cylinders, {radius, bottom, top});
}

NodeId Shapes::cone(const Span& at, double bottom_radius, const Vec3& bottom, double top_radius,
                    const Vec3& top) {
  if (equal_radii(bottom_radius, top_radius)) return cylinder(at, bottom_radius, bottom, top);
  if (degenerate(length(top - bottom))) return drop(at, "degenerate cone: it has no length");
  return store(NodeKind::kCone, at, context_.scene.cones, {bottom_radius, bottom, top_radius, top});
}

NodeId Shapes::torus(const Span& at, double swept, double tube, const Vec3& center, const Vec3& axis) {
  if (degenerate(swept) || degenerate(tube)) return drop(at, "degenerate torus: its radii must be positive");
  if (degenerate(length(axis))) return drop(at, "degenerate torus: its axis has no length");
  return store(NodeKind::kTorus, at, context_.scene.tori, {swept, tube, center, axis});
}

NodeId Shapes::triangle(const Span& at, const Vec3& p1, const Vec3& p2, const Vec3& p3) {
  const shape::Triangle shape{{p1, p2, p3}};
  if (degenerate(length(area_normal(shape.p)))) {
    context_.messages.advice(at, "degenerate triangle: it has no area; it is dropped");
    return drop_quietly();
  }
  return store(NodeKind::kTriangle, at, context_.scene.triangles, shape);
}

bool Shapes::check_smooth(const Span& at, const Vec3 (&p)[3], const Vec3 (&n)[3]) {
  const Vec3 face = area_normal(p);
  if (degenerate(length(face))) {
    context_.messages.advice(at, "degenerate triangle: it has no area; it is dropped");
    return false;
  }
  if (degenerate(length(n[0])) || degenerate(length(n[1])) || degenerate(length(n[2]))) {
    drop(at, "degenerate vertex normal: a normal of this triangle has no length");
    return false;
  }
  if (!context_.options.flip_normals && dot(normalize(n[0]), normalize(face)) < 0) {
    context_.messages.advice(
        at, "inconsistent triangle normals: the first vertex normal is trusted, not the face");
  }
  return true;
}

NodeId Shapes::smooth_triangle(const Span& at, const Vec3& p1, const Vec3& n1, const Vec3& p2, const Vec3& n2,
                               const Vec3& p3, const Vec3& n3) {
  const shape::SmoothTriangle shape{{p1, p2, p3}, {n1, n2, n3}};
  if (!check_smooth(at, shape.p, shape.n)) return drop_quietly();
  return store(NodeKind::kSmoothTriangle, at, context_.scene.smooth_triangles, shape);
}

void Shapes::corner(const Vec3& point, const Vec3& normal, double u, double v) {
  corners_.p[corner_count_] = point;
  corners_.n[corner_count_] = normal;
  corners_.u[corner_count_] = u;
  corners_.v[corner_count_] = v;
  corner_count_ = (corner_count_ + 1) % 3;
}

NodeId Shapes::uv_triangle(const Span& at) {
  corner_count_ = 0;
  if (!check_smooth(at, corners_.p, corners_.n)) return drop_quietly();
  return store(NodeKind::kUvTriangle, at, context_.scene.uv_triangles, corners_);
}

NodeId Shapes::polygon(const Span& at) {
  // The work area keeps its memory; the scene gets a vector of just the size.
  shape::Polygon shape{std::vector<Vec3>(points_.begin(), points_.end())};
  points_.clear();
  if (shape.points.size() < 3) return drop(at, "degenerate polygon: it needs at least three points");
  if (degenerate(length(area_normal(shape.points)))) return drop(at, "degenerate polygon: it has no area");
  return store(NodeKind::kPolygon, at, context_.scene.polygons, std::move(shape));
}

NodeId Shapes::blob(const Span& at, double threshold) {
  shape::Blob shape{threshold, std::vector<shape::Metaball>(balls_.begin(), balls_.end())};
  balls_.clear();
  if (shape.balls.empty()) return drop(at, "blob field not correct: it has no metaballs");
  const bool bad = std::any_of(shape.balls.begin(), shape.balls.end(), [](const shape::Metaball& ball) {
    return degenerate(ball.strength) || degenerate(ball.radius);
  });
  if (bad) return drop(at, "degenerate metaball in blob: strength and radius must be positive");
  return store(NodeKind::kBlob, at, context_.scene.blobs, std::move(shape));
}

NodeId Shapes::height_field(const Span& at, Name file, const Span& file_span) {
  if (file.size == 0) context_.messages.error(file_span, "a file name must not be empty");
  shape::HeightField shape{{std::string(file.view()), context_.sources.locate(file_span)}};
  return store(NodeKind::kHeightField, at, context_.scene.height_fields, std::move(shape));
}

void Shapes::recover() {
  corner_count_ = 0;
  points_.clear();
  balls_.clear();
}

}  // namespace rayshade::lang
