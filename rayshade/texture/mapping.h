// SPDX-License-Identifier: MIT
// From a point to (u, v) and tangents: the spherical, cylindrical and planar mappings (textures.md 5.3
// to 5.5). The uv mapping belongs to the primitives; what all mappings have in common is in apply.cpp.
#pragma once

#include <stdexcept>

#include "rayshade/geometry/ray.h"
#include "rayshade/math/affine.h"
#include "rayshade/scene/texture.h"

namespace rayshade {

/// A mapping whose axes do not span space. what() is the message.
struct DegenerateMapping : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A mapping with its axes made orthonormal (planar: inverted) once.
class CompiledMapping {
 public:
  CompiledMapping() = default;
  /// Throws DegenerateMapping.
  explicit CompiledMapping(const Mapping& mapping);

  MappingKind kind() const { return kind_; }
  /// Coordinates and tangents at a point of model space. Not for kUv.
  TextureCoordinates at(const Vec3& x) const;

 private:
  TextureCoordinates spherical(const Vec3& x) const;
  TextureCoordinates cylindrical(const Vec3& x) const;
  TextureCoordinates planar(const Vec3& x) const;
  /// Tangents of a sphere around the origin of the mapping; zero at its poles.
  void sphere_tangents(const Vec3& from_origin, TextureCoordinates& out) const;

  MappingKind kind_ = MappingKind::kUv;
  bool explicit_axes_ = false;
  Vec3 origin_;
  Vec3 up_{0, 0, 1}, u_axis_{1, 0, 0}, v_axis_{0, 1, 0};  ///< unit; for planar the tangents
  Affine planar_inverse_;
};

}  // namespace rayshade
