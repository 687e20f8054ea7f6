// SPDX-License-Identifier: MIT
#include "rayshade/geometry/resolve.h"

#include <algorithm>
#include <limits>

namespace rayshade {
namespace {

constexpr double kUnit = std::numeric_limits<double>::epsilon();

/// Calls `f` with the shape of a primitive leaf.
template <class F>
auto with_shape(const CompiledScene& scene, const Leaf& leaf, const F& f) {
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
    case LeafKind::kTorus:
      return f(scene.tori[leaf.shape]);
    case LeafKind::kTriangle:
      return f(scene.triangles[leaf.shape]);
    case LeafKind::kSmoothTriangle:
      return f(scene.smooth_triangles[leaf.shape]);
    case LeafKind::kUvTriangle:
      return f(scene.uv_triangles[leaf.shape]);
    case LeafKind::kPolygon:
      return f(scene.polygons[leaf.shape]);
    case LeafKind::kBlob:
      return f(scene.blobs[leaf.shape]);
    default:
      return f(scene.height_fields[leaf.shape]);
  }
}

const AffinePair& placement_of(const CompiledScene& scene, const Leaf& leaf, double time,
                               TraceScratch& scratch) {
  return leaf.animated ? scratch.motion.placement(scene, leaf.placement, time)
                       : scene.placements[leaf.placement].map;
}

/// The ray taken through the instances of a hit and the placement of its leaf; false where none of them moves
/// it.
bool to_primitive(const CompiledScene& scene, const Hit& hit, Ray& ray, TraceScratch& scratch) {
  bool moved = false;
  const auto descend = [&](const Leaf& leaf) {
    if (leaf.placement == kNone) return;
    ray = transformed(ray, placement_of(scene, leaf, ray.time, scratch).inverse);
    moved = true;
  };
  for (std::uint32_t i = 0; i < hit.instances.count; ++i) descend(scene.leaves[hit.instances.leaves[i]]);
  descend(scene.leaves[hit.leaf]);
  return moved;
}

/// Largest growth of a vector (by a bound that is at most 3 times too large).
double norm(const Affine& map) {
  const auto row = [](const Vec3& v) { return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z); };
  return std::max({row(map.rows[0]), row(map.rows[1]), row(map.rows[2])});
}

/// Bound on the sums that a point takes part in.
double magnitude(const Affine& map, const Vec3& p) {
  return max_abs(std::fabs(p.x) * abs(map.rows[0]) + std::fabs(p.y) * abs(map.rows[1]) +
                 std::fabs(p.z) * abs(map.rows[2]) + abs(map.translation));
}

/// Turns both normals toward the origin of the ray (objects.md 1.11 step 4); whether it enters.
bool face_origin(const Vec3& direction, const Hit& hit, bool smooth, Vec3& normal, Vec3& geometric_normal) {
  double k = dot(direction, normal);
  if (smooth) {
    const double facet = dot(direction, geometric_normal);
    if ((k <= 0 && facet > 0) || (k >= 0 && facet < 0)) k = facet;
  }
  if (k > 0) {
    normal = -normal;
    geometric_normal = -geometric_normal;
  }
  return hit.flag == EnterFlag::kUnset ? !(k > 0) : hit.flag == EnterFlag::kEntering;
}

}  // namespace

PathWalk::PathWalk(const CompiledScene& scene, const Hit& hit, double time, TraceScratch& scratch)
    : scene_(scene),
      hit_(hit),
      time_(time),
      scratch_(scratch),
      node_(scene.leaves[hit.leaf].path),
      instances_left_(hit.instances.count) {}

bool PathWalk::next(PathLevel& level) {
  while (node_ == kNone) {
    if (instances_left_ == 0) return false;
    node_ = scene_.leaves[hit_.instances.leaves[--instances_left_]].path;
  }
  const PathNode& node = scene_.path_nodes[node_];
  level = {};
  if (node.transform != kNone) {
    level.map = scene_.scene->transforms[node.transform].animated()
                    ? &scratch_.motion.level(scene_, node.transform, time_)
                    : &scene_.level_transforms[node.transform];
  }
  if (node.textures != kNone) {
    level.textures = &scene_.scene->texture_lists[node.textures];
    level.texture_list = node.textures;
  }
  level.surface = node.surface;
  node_ = node.parent;
  return true;
}

LocalHit resolve_local(const CompiledScene& scene, const Hit& hit, const Ray& world_ray,
                       TraceScratch& scratch) {
  LocalHit out;
  out.ray = world_ray;
  const bool moved = to_primitive(scene, hit, out.ray, scratch);
  const Leaf& leaf = scene.leaves[hit.leaf];
  const SurfacePoint surface =
      with_shape(scene, leaf, [&](const auto& shape) { return shape.surface_point(out.ray, hit.shape); });
  out.t = hit.shape.t;
  // As the original does: only rays that pass a transform are made unit (objects.md 1.9).
  if (moved) {
    out.t *= length(out.ray.direction);
    out.ray.direction = normalize(out.ray.direction);
  }
  out.point = surface.point;
  out.normal = surface.normal;
  out.geometric_normal = surface.geometric_normal;
  out.error = surface.error;
  out.smooth = surface.smooth;
  out.entering = face_origin(out.ray.direction, hit, surface.smooth, out.normal, out.geometric_normal);
  return out;
}

const Surface& surface_of(const CompiledScene& scene, const Hit& hit) {
  static const Surface kDefault = default_surface();
  std::uint32_t node = scene.leaves[hit.leaf].path;
  for (std::uint32_t left = hit.instances.count;; --left) {
    if (node != kNone && scene.path_surfaces[node] != kNone)
      return scene.scene->surfaces[scene.path_surfaces[node]];
    if (left == 0) return kDefault;
    node = scene.leaves[hit.instances.leaves[left - 1]].path;
  }
}

TextureCoordinates texture_coordinates(const CompiledScene& scene, const Hit& hit, const Vec3& x,
                                       const Vec3& facing_normal) {
  return with_shape(scene, scene.leaves[hit.leaf], [&](const auto& shape) {
    return shape.texture_coordinates(x, facing_normal, hit.shape);
  });
}

bool has_textures_on_path(const CompiledScene& scene, const Hit& hit) {
  const auto textured = [&](LeafId id) {
    const std::uint32_t path = scene.leaves[id].path;
    return path != kNone && scene.path_textured[path] != 0;
  };
  if (textured(hit.leaf)) return true;
  for (std::uint32_t i = 0; i < hit.instances.count; ++i) {
    if (textured(hit.instances.leaves[i])) return true;
  }
  return false;
}

// The error so far, the rounding of this map, and that of its inverse, through which every ray that asks for
// this surface goes, as seen from outside.
double carried_error(double error, const AffinePair& map, const Vec3& inner, const Vec3& outer) {
  return norm(map.forward) * (error + 8 * kUnit * magnitude(map.inverse, outer)) +
         8 * kUnit * magnitude(map.forward, inner);
}

WorldHit resolve_world(const CompiledScene& scene, const Hit& hit, const Ray& world_ray,
                       TraceScratch& scratch) {
  WorldHit out;
  resolve_world(scene, hit, world_ray, scratch, out);
  return out;
}

void resolve_world(const CompiledScene& scene, const Hit& hit, const Ray& world_ray, TraceScratch& scratch,
                   WorldHit& out) {
  const Leaf& own = scene.leaves[hit.leaf];
  if (own.placement == kNone && hit.instances.count == 0) {
    // Primitive space is the world's.
    const SurfacePoint surface =
        with_shape(scene, own, [&](const auto& shape) { return shape.surface_point(world_ray, hit.shape); });
    out.point = surface.point;
    out.normal = surface.normal;
    out.geometric_normal = surface.geometric_normal;
    out.error = surface.error;
    out.smooth = surface.smooth;
    out.entering = face_origin(world_ray.direction, hit, surface.smooth, out.normal, out.geometric_normal);
    return;
  }
  const LocalHit local = resolve_local(scene, hit, world_ray, scratch);
  out = {local.point, local.normal, local.geometric_normal, local.error, local.smooth, local.entering};
  const auto ascend = [&](const Leaf& leaf) {
    if (leaf.placement == kNone) return;
    const AffinePair& map = placement_of(scene, leaf, world_ray.time, scratch);
    const Vec3 inner = out.point;
    out.point = map.forward.point(inner);
    out.error = carried_error(out.error, map, inner, out.point);
    out.normal = map.normal(out.normal);
    out.geometric_normal = map.normal(out.geometric_normal);
  };
  ascend(scene.leaves[hit.leaf]);
  for (std::uint32_t i = hit.instances.count; i-- > 0;) ascend(scene.leaves[hit.instances.leaves[i]]);
}

double world_extent(const CompiledScene& scene, const Hit& hit) {
  if (hit.instances.count == 0 && hit.leaf < scene.leaf_extents.size()) return scene.leaf_extents[hit.leaf];
  const Leaf& leaf = scene.leaves[hit.leaf];
  const Bounds3 box = scene.shape_bounds(leaf);
  if (box.empty() || box.unbounded()) return scene.scale;
  Vec3 extent = box.extent();
  const auto ascend = [&](const Leaf& at) {
    if (at.placement == kNone) return;
    const Affine& map = scene.placements[at.placement].map.forward;
    extent = extent.x * abs(map.rows[0]) + extent.y * abs(map.rows[1]) + extent.z * abs(map.rows[2]);
  };
  ascend(leaf);
  for (std::uint32_t i = hit.instances.count; i-- > 0;) ascend(scene.leaves[hit.instances.leaves[i]]);
  return max_abs(extent);
}

}  // namespace rayshade
