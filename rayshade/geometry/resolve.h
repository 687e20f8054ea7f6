// SPDX-License-Identifier: MIT
// From a hit to what shading and texturing need (objects.md 1.11, shading.md 3, textures.md 1.2 steps 1 and
// 2).
#pragma once

#include <algorithm>

#include "rayshade/geometry/intersector.h"

namespace rayshade {

/// The hit in the space of its primitive. Normals face the origin of the ray.
struct LocalHit {
  Ray ray;       ///< in primitive space, direction of unit length
  double t = 0;  ///< distance along `ray` (not the world distance)
  Vec3 point, normal, geometric_normal;
  double error = 0;  ///< primitive space
  bool smooth = false;
  bool entering = true;
};

/// One level of the way outward: a node's own transform at the time of the ray, its textures and surface.
struct PathLevel {
  const AffinePair* map = nullptr;  ///< null: the node has no transform
  const std::vector<Texture>* textures = nullptr;
  std::uint32_t texture_list = kNone;  ///< index in Scene::texture_lists
  std::uint32_t surface = kNone;       ///< index in Scene::surfaces
};

/// Walks from the primitive outward, across instances, to (not including) the world.
class PathWalk {
 public:
  PathWalk(const CompiledScene& scene, const Hit& hit, double time, TraceScratch& scratch);
  /// False when the world is reached. The pointers in `level` are valid until the next call with the same
  /// scratch.
  bool next(PathLevel& level);

 private:
  const CompiledScene& scene_;
  const Hit& hit_;
  double time_;
  TraceScratch& scratch_;
  std::uint32_t node_;
  std::uint32_t instances_left_;
};

/// Point and normals in primitive space, flipped, and the entering flag (CSG's flag respected).
LocalHit resolve_local(const CompiledScene& scene, const Hit& hit, const Ray& world_ray,
                       TraceScratch& scratch);
/// The surface of a hit before texturing: the first on its path, else the default surface (language.md 5).
const Surface& surface_of(const CompiledScene& scene, const Hit& hit);
/// (u, v) and tangents of the primitive at any point x of its space.
TextureCoordinates texture_coordinates(const CompiledScene& scene, const Hit& hit, const Vec3& x,
                                       const Vec3& facing_normal);
/// True where some node on the path has a texture.
bool has_textures_on_path(const CompiledScene& scene, const Hit& hit);
inline bool has_textures(const CompiledScene& scene, const Hit& hit) {
  return scene.has_textures && has_textures_on_path(scene, hit);
}

/// The point, normals and flags in world space, for hits without textures on their path (otherwise
/// rayshade/texture does it level by level).
struct WorldHit {
  Vec3 point, normal, geometric_normal;
  double error = 0;  ///< bound on the distance of `point` from the surface, in world units
  bool smooth = false;
  bool entering = true;
};
WorldHit resolve_world(const CompiledScene& scene, const Hit& hit, const Ray& world_ray,
                       TraceScratch& scratch);
void resolve_world(const CompiledScene& scene, const Hit& hit, const Ray& world_ray, TraceScratch& scratch,
                   WorldHit& out);
/// The error bound of a point after `map` has taken it from `inner` to `outer`.
double carried_error(double error, const AffinePair& map, const Vec3& inner, const Vec3& outer);

/// A ray that leaves a hit: its origin is moved off the surface by the error bound of the point, to the side
/// into which the ray goes, and it starts at `lo`. The one place that knows the tolerance of secondary rays
/// (rule 8): the original's absolute 1e-5 (4e-5 for shadows), shrunk in proportion for objects smaller than
/// one unit, so that small models keep their shadows, and never below what rounding needs, so that models far
/// away do not shadow themselves.
struct RayStart {
  Vec3 origin;
  double lo = 0;
};
/// What does not depend on the direction, for the many rays that leave one hit.
struct RayStarts {
  Vec3 point, normal;
  double step = 0;      ///< how far off the surface
  double rounding = 0;  ///< least lower limit, for directions of unit length
  double extent = 0;    ///< at most 1
  RayStarts() = default;
  RayStarts(const WorldHit& hit, double leaf_extent) { leave(hit, leaf_extent); }
  void leave(const WorldHit& hit, double leaf_extent);
  /// `length_of_direction`: 1 where it is known to be one to within rounding.
  RayStart toward(const Vec3& direction, double length_of_direction, bool shadow) const {
    const double off = dot(direction, normal) < 0 ? -step : step;
    const double tolerance = shadow ? kShadowTolerance : kRayTolerance;
    return {point + off * normal,
            std::max(tolerance * extent, length_of_direction > 0 ? rounding / length_of_direction : 0)};
  }

 private:
  /// Lower limits relative to the size of what is left, for rays and for shadow rays (objects.md 2).
  static constexpr double kRayTolerance = kEpsilon, kShadowTolerance = 4 * kEpsilon;
};

/// `extent`: largest extent of the leaf hit, in world units (leaf_extent).
RayStart secondary_start(const WorldHit& hit, const Vec3& direction, double extent, bool shadow);
/// Extent of the leaf of a hit in world units, for secondary_start.
double world_extent(const CompiledScene& scene, const Hit& hit);

}  // namespace rayshade
