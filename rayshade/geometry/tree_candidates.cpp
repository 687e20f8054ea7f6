// SPDX-License-Identifier: MIT
#include "rayshade/geometry/tree_candidates.h"

#include <cmath>

#include "rayshade/geometry/hierarchy.h"

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
    : scene_(scene), group_(scene.groups[group]), first_(group_.first + group_.unbounded) {
  // Children come after their parents.
  const auto& nodes = group_.hierarchy->nodes();
  below_.assign(nodes.size(), 0);
  for (std::size_t i = nodes.size(); i-- > 0;) {
    for (int lane = 0; lane < Hierarchy::kWidth; ++lane) {
      if (nodes[i].opacity[lane] == 0) continue;
      const std::uint32_t child = nodes[i].child[lane];
      below_[i] += (child & Hierarchy::kLeafBit) != 0 ? Hierarchy::count(child) : below_[child];
    }
  }
}

std::uint32_t TreeCandidates::count() const { return group_.count - group_.unbounded; }
fas::Bounds TreeCandidates::bounds() const { return to_bounds(group_.bounds); }

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

int TreeCandidates::open(std::uint32_t subtree, Child (&out)[kMostChildren]) const {
  const Hierarchy& hierarchy = *group_.hierarchy;
  std::uint32_t node = 0;
  if (subtree != kWhole) {
    const std::uint32_t place = subtree & ~kSubtree;
    const std::uint32_t child = hierarchy.nodes()[place / 4].child[place % 4];
    if ((child & Hierarchy::kLeafBit) != 0) {
      const auto count = static_cast<int>(Hierarchy::count(child));
      for (int i = 0; i < count; ++i) out[i].entry = Hierarchy::first(child) + static_cast<std::uint32_t>(i);
      return count;
    }
    node = child;
  }
  const Hierarchy::Node& in = hierarchy.nodes()[node];
  const Vec3 center = group_.bounds.center();
  int count = 0;
  for (int lane = 0; lane < Hierarchy::kWidth; ++lane) {
    if (in.opacity[lane] == 0) continue;
    Child& child = out[count++];
    child.entry = kSubtree | (node * 4 + static_cast<std::uint32_t>(lane));
    child.below = (in.child[lane] & Hierarchy::kLeafBit) != 0 ? Hierarchy::count(in.child[lane])
                                                              : below_[in.child[lane]];
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<std::size_t>(axis);
      child.box.lo[i] = center[axis] + static_cast<double>(in.planes[0][axis][lane]);
      child.box.hi[i] = center[axis] + static_cast<double>(in.planes[1][axis][lane]);
    }
  }
  return count;
}

}  // namespace rayshade
