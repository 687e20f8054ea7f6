// SPDX-License-Identifier: MIT
// The mappings' formulas, with the original's quirks: planar mapping ignores the origin, the tangent of
// cylindrical mapping is taken from the point instead of from the point relative to the origin (textures.md
// D7, D9).
#include "rayshade/texture/mapping.h"

#include <cmath>

#include "rayshade/math/functions.h"
#include "rayshade/texture/surface_ops.h"

namespace rayshade {
namespace {

/// The angle of a cosine as a fraction of a full turn; cosines beyond 1 by rounding give the ends.
double turn_of_cosine(double c) {
  if (c > 1) return 0;
  if (c < -1) return 0.5;
  return fn::acos(c) / (2 * fn::kPi);
}

}  // namespace

CompiledMapping::CompiledMapping(const Mapping& mapping)
    : kind_(mapping.kind), explicit_axes_(mapping.explicit_axes), origin_(mapping.origin) {
  if (kind_ == MappingKind::kUv || !explicit_axes_) {
    origin_ = {};
    return;
  }
  if (kind_ == MappingKind::kPlanar) {
    const Vec3 v = mapping.up, u = mapping.u_axis;
    const auto inverted = inverse(Affine{{u, v, cross(u, v)}, {}});
    if (!inverted) throw DegenerateMapping("Singular matrix.");
    planar_inverse_ = *inverted;
    u_axis_ = normalize(u);
    v_axis_ = normalize(v);
    return;
  }
  up_ = normalize(mapping.up);
  const Vec3 across = cross(up_, normalize(mapping.u_axis));
  // Unit vectors: the sine of their angle. Below this rounding decides the direction of the product.
  if (!(length(across) > 1e-10)) throw DegenerateMapping("Degenerate mapping vector.");
  v_axis_ = normalize(across);
  u_axis_ = normalize(cross(v_axis_, up_));
}

TextureCoordinates CompiledMapping::at(const Vec3& x) const {
  switch (kind_) {
    case MappingKind::kSpherical:
      return spherical(x);
    case MappingKind::kCylindrical:
      return cylindrical(x);
    case MappingKind::kPlanar:
      return planar(x);
    case MappingKind::kUv:
      break;
  }
  return {};
}

void CompiledMapping::sphere_tangents(const Vec3& from_origin, TextureCoordinates& out) const {
  out.du = cross(up_, from_origin);
  if (length(out.du) < kEpsilon) {
    out.du = out.dv = {};
    return;
  }
  out.du = normalize(out.du);
  out.dv = normalize(cross(from_origin, out.du));
}

TextureCoordinates CompiledMapping::spherical(const Vec3& x) const {
  TextureCoordinates out;
  const Vec3 from_origin = x - origin_;
  sphere_tangents(from_origin, out);
  if (length(from_origin) < kEpsilon) return out;
  const Vec3 e = normalize(from_origin);
  const double nx = dot(u_axis_, e), ny = dot(v_axis_, e), nz = dot(up_, e);
  const double phi = nz > 1 ? fn::kPi : nz < -1 ? 0 : fn::acos(-nz);
  out.v = phi / fn::kPi;
  if (std::fabs(out.v) < kEpsilon || std::fabs(out.v - 1) < kEpsilon) return out;
  const double theta = turn_of_cosine(nx / fn::sin(phi));
  out.u = ny > 0 ? theta : 1 - theta;
  return out;
}

TextureCoordinates CompiledMapping::cylindrical(const Vec3& x) const {
  TextureCoordinates out;
  const Vec3 w = x - origin_;
  const double nx = dot(u_axis_, w), ny = dot(v_axis_, w);
  out.v = dot(up_, w);
  const double r = std::sqrt(nx * nx + ny * ny);
  if (r < kEpsilon) {
    sphere_tangents(w, out);
    return out;
  }
  const double cosine = nx / r;
  out.u = std::fabs(cosine) > 1 ? 0.5 : fn::acos(cosine) / (2 * fn::kPi);
  if (ny < 0) out.u = 1 - out.u;
  out.dv = up_;
  out.du = normalize_above_epsilon(cross(up_, x));
  return out;
}

TextureCoordinates CompiledMapping::planar(const Vec3& x) const {
  if (!explicit_axes_) return {x.x, x.y, {1, 0, 0}, {0, 1, 0}};
  const Vec3 uv = planar_inverse_.vector(x);
  return {uv.x, uv.y, u_axis_, v_axis_};
}

}  // namespace rayshade
