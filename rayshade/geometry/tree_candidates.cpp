// SPDX-License-Identifier: MIT
#include "rayshade/geometry/tree_candidates.h"

namespace rayshade {
namespace {

using Form = fas::Geometry::Form;

fas::Point to_point(const Vec3& v) { return {v.x, v.y, v.z}; }
fas::Bounds to_bounds(const Bounds3& b) { return {to_point(b.lo), to_point(b.hi)}; }

void set_points(const Vec3 (&vertices)[3], fas::Geometry& out) {
  out.form = Form::kPolygon;
  for (const Vec3& p : vertices) out.points.push_back(to_point(p));
}

/// Whether a flat quadrilateral turns the same way at every corner.
bool is_convex(const std::vector<fas::Point>& p, const Vec3& normal) {
  int left = 0, right = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto& [ax, ay, az] = p[i];
    const auto& [bx, by, bz] = p[(i + 1) % p.size()];
    const auto& [cx, cy, cz] = p[(i + 2) % p.size()];
    const double turn = dot(cross({bx - ax, by - ay, bz - az}, {cx - bx, cy - by, cz - bz}), normal);
    left += turn > 0;
    right += turn < 0;
  }
  return left == 0 || right == 0;
}

void set_polygon(const Polygon& polygon, fas::Geometry& out) {
  out.form = Form::kPoints;
  for (std::size_t i = 0; i < polygon.corners(); ++i) out.points.push_back(to_point(polygon.corner(i)));
  if (polygon.corners() <= 4 && is_convex(out.points, polygon.normal())) out.form = Form::kPolygon;
}

/// Cylinder or cone: the hull of the balls at its ends holds the wall, unless it is a double cone.
void set_wall(const Wall& wall, fas::Geometry& out) {
  if (wall.start_radius() < 0 || wall.end_radius() < 0) return;
  out.form = Form::kSpheres;
  out.spheres = 2;
  out.center[0] = to_point(wall.origin());
  out.center[1] = to_point(wall.end());
  out.radius[0] = wall.start_radius();
  out.radius[1] = wall.end_radius();
}

void place(fas::Geometry& geometry, const Affine& map) {
  for (fas::Point& p : geometry.points) p = to_point(map.point({p[0], p[1], p[2]}));
}

}  // namespace

TreeCandidates::TreeCandidates(const CompiledScene& scene, std::uint32_t group)
    : HierarchyCandidates(*scene.groups[group].hierarchy,
                          scene.groups[group].count - scene.groups[group].unbounded),
      scene_(scene),
      first_(scene.groups[group].first + scene.groups[group].unbounded) {}

void TreeCandidates::geometry(std::uint32_t primitive, fas::Geometry& out) const {
  const LeafId id = first_ + primitive;
  const Leaf& leaf = scene_.leaves[id];
  out.form = Form::kBox;
  out.points.clear();
  out.one_sided = out.opaque = false;
  out.box = to_bounds(scene_.leaf_bounds(id, scene_.shutter, scene_.frame));
  if (leaf.animated) return;
  switch (leaf.kind) {
    case LeafKind::kSphere: {
      if (leaf.placement != kNone) return;
      const Sphere& sphere = scene_.spheres[leaf.shape];
      out.form = Form::kSpheres;
      out.spheres = 1;
      out.center[0] = to_point(sphere.center());
      out.radius[0] = sphere.radius();
      return;
    }
    case LeafKind::kCylinder:
      if (leaf.placement == kNone) set_wall(scene_.cylinders[leaf.shape].wall(), out);
      return;
    case LeafKind::kCone:
      if (leaf.placement == kNone) set_wall(scene_.cones[leaf.shape].wall(), out);
      return;
    case LeafKind::kTriangle:
      set_points(scene_.triangles[leaf.shape].vertices(), out);
      break;
    case LeafKind::kSmoothTriangle:
      set_points(scene_.smooth_triangles[leaf.shape].vertices(), out);
      break;
    case LeafKind::kUvTriangle:
      set_points(scene_.uv_triangles[leaf.shape].vertices(), out);
      break;
    case LeafKind::kPolygon:
      set_polygon(scene_.polygons[leaf.shape], out);
      break;
    default:
      return;
  }
  if (leaf.placement != kNone) place(out, scene_.placements[leaf.placement].map.forward);
}

}  // namespace rayshade
