// SPDX-License-Identifier: MIT
// The walk outward (textures.md 1.2), and each texture put to work on the record of one hit.
#include "rayshade/texture/apply.h"

#include <optional>

#include "rayshade/math/fused.h"
#include "rayshade/texture/image_texture.h"
#include "rayshade/texture/noise.h"
#include "rayshade/texture/procedural.h"
#include "rayshade/texture/surface_ops.h"

namespace rayshade {
namespace {

/// An alpha below this leaves the point untouched (textures.md 6.2).
constexpr double kInvisible = 0.001;

/// What the textures of one hit read and write.
struct Evaluation {
  const CompiledScene& scene;
  const Hit& hit;
  const LocalHit& local;  ///< in the space of the primitive, whatever level is being textured
  const SampleContext& sample;
  Moment moment;
  Vec3 point, normal;  ///< in the space outside the node whose textures are applied
  Surface& surface;
  /// Primitive space -> that space; none: the identity. Kept up to date only where it is needed.
  std::optional<AffinePair> frame = std::nullopt;
  unsigned gloss_count = 0;
};

/// The transform of a texture at this moment, and the point in its space.
struct TextureSpace {
  const AffinePair* map = nullptr;  ///< null: the identity
  std::optional<AffinePair> moving;
  Vec3 q;

  TextureSpace(const CompiledTexture& texture, const Evaluation& e) : q(e.point) {
    if (!texture.transformed) return;
    map = &texture.transform;
    if (texture.animated) {
      const Affine forward = texture.source->transform.at(e.moment);
      const auto inverted = inverse(forward);
      if (!inverted) throw MotionError("singular matrix", texture.source->location, e.moment.time);
      map = &moving.emplace(AffinePair{forward, *inverted});
    }
    q = map->inverse.point(e.point);
  }
  TextureSpace(const TextureSpace&) = delete;
  TextureSpace& operator=(const TextureSpace&) = delete;
};

/// (u, v) of the common procedure of all mappings (textures.md 5.1 steps 1 to 3). The tangents are still
/// those of the mapping itself.
TextureCoordinates map_point(const CompiledTexture& texture, const TextureSpace& space, const Evaluation& e) {
  TextureCoordinates c;
  if (texture.mapping.kind() == MappingKind::kUv) {
    // The inverse of the frame first and the texture's transform after it: the original's order (D4).
    Vec3 x = e.frame ? e.frame->inverse.point(space.q) : space.q;
    if (space.map) x = space.map->forward.point(x);
    c = texture_coordinates(e.scene, e.hit, x, e.local.geometric_normal);
  } else {
    c = texture.mapping.at(e.point);
  }
  if (space.map) {
    const Vec3 uv = space.map->inverse.point({c.u, c.v, 0});
    c.u = uv.x;
    c.v = uv.y;
  }
  return c;
}

/// Step 4: takes the tangents to model space, with the linear part of the texture's transform mixed in. The
/// frame is one factor too many for those mappings that are in model space already (D8).
void finish_tangents(const TextureSpace& space, const Evaluation& e, TextureCoordinates& c) {
  Vec3 du = c.du, dv = c.dv, g = e.local.geometric_normal;
  if (e.frame) {
    const Affine& frame = e.frame->forward;
    du = frame.vector(du), dv = frame.vector(dv), g = frame.vector(g);
  }
  const Affine linear = space.map ? space.map->forward : Affine{};
  const auto tangent = [&](const Vec3& row) {
    return normalize_above_epsilon(row.x * du + row.y * dv + row.z * g);
  };
  c.du = tangent(linear.rows[0]);
  c.dv = tangent(linear.rows[1]);
}

void tint(Surface& surface, const Color& color) {
  surface.diffuse *= color;
  surface.ambient *= color;
}
void tint(Surface& surface, double value) { tint(surface, {value, value, value}); }

/// By the colour map where there is one, else by the value itself.
void tint_mapped(const CompiledTexture& texture, double value, Surface& surface) {
  if (texture.colors) {
    tint(surface, (*texture.colors)[static_cast<std::size_t>(color_index(value))]);
  } else {
    tint(surface, value);
  }
}

void apply_cloud(const CompiledTexture& texture, const TextureSpace& space, Evaluation& e) {
  const double* a = texture.source->arguments;
  Vec3 origin = e.local.ray.origin, direction = e.local.ray.direction;
  if (space.map) {  // forward, on top of the object's inverse: D5
    origin = space.map->forward.point(origin);
    direction = normalize_above_epsilon(space.map->forward.vector(direction));
  }
  const CloudValue value =
      cloud_value(space.q, origin, direction, {texture.fbm, a[1], a[0], a[3], a[4], a[5]});
  e.surface.transparency = value.transparency;
  e.surface.diffuse *= value.diffuse;
  e.surface.ambient *= value.ambient;
}

void apply_stripe(const CompiledTexture& texture, const TextureSpace& space, Evaluation& e) {
  const double* a = texture.source->arguments;
  TextureCoordinates c = map_point(texture, space, e);
  const StripeValue value = stripe_value(c.u, c.v, a[0], a[1]);
  if (value.part == StripePart::kBand) {
    e.surface = texture.source->surface;
  } else if (value.part == StripePart::kBevel) {
    finish_tangents(space, e, c);
    e.normal = make_bump(e.normal, c.du, c.dv, value.fu, value.fv);
  }
}

void apply_gloss(const CompiledTexture& texture, Evaluation& e) {
  const unsigned nth = e.gloss_count++;
  std::array<double, 2> draws{0.5, 0.5};
  if (e.sample.gloss) draws = (*e.sample.gloss)(nth);
  e.normal = gloss_normal(e.normal, texture.source->arguments[0], draws, e.sample.sample_number,
                          e.sample.samples_per_side);
}

void apply_image(const CompiledTexture& texture, const TextureSpace& space, Evaluation& e) {
  const ImageOptions& options = texture.source->image;
  const Image& image = *texture.image;
  TextureCoordinates c = map_point(texture, space, e);
  if (!tile_draws(c.u, c.v, options.tile_u, options.tile_v)) return;
  const TexelPosition here = locate_texel(image, c.u, c.v);
  const Texel texel = texel_at(image, here, options.smooth);
  if (image.has_alpha && texel.alpha < kInvisible) return;
  if (options.component != ImageComponent::kBump) {
    apply_texel(texel, options, options.has_surface ? &texture.source->surface : nullptr, e.surface);
    return;
  }
  const double height = texel.color.r;
  const double right = texel_at(image, texel_right_of(image, here), options.smooth).color.r;
  const double above = texel_at(image, texel_above(image, here), options.smooth).color.r;
  const double low = options.range_low, span = options.range_high - options.range_low;
  finish_tangents(space, e, c);
  e.normal = make_bump(e.normal, c.du, c.dv, low + (right - height) * span, low + (above - height) * span);
}

void apply_texture(const CompiledTexture& texture, Evaluation& e) {
  const TextureSpace space(texture, e);
  const Texture& source = *texture.source;
  const double* a = source.arguments;
  switch (source.kind) {
    case TextureKind::kChecker:
      if (checker_is_odd(space.q)) e.surface = source.surface;
      break;
    case TextureKind::kBlotch: {
      const double share = blotch_share(space.q, a[0]);
      blend(e.surface, source.surface, 1 - share, share);
      break;
    }
    case TextureKind::kBump:
      e.normal = normalize_above_epsilon(e.normal + a[0] * dnoise3(space.q));
      break;
    case TextureKind::kMarble:
      tint_mapped(texture, marble(space.q), e.surface);
      break;
    case TextureKind::kFbm:
      tint_mapped(texture, fbm_value(space.q, texture.fbm, a[0], a[1], a[4]), e.surface);
      break;
    case TextureKind::kFbmBump:
      e.normal += Vec3{a[0], a[0], a[0]} +
                  a[1] * vfbm(space.q, texture.fbm.omega, texture.fbm.lambda, texture.fbm.octaves);
      break;
    case TextureKind::kWood:
      tint(e.surface, wood_color(space.q));
      break;
    case TextureKind::kGloss:
      apply_gloss(texture, e);
      break;
    case TextureKind::kCloud:
      apply_cloud(texture, space, e);
      break;
    case TextureKind::kSky: {
      const double intensity = sky_intensity(space.q, texture.fbm, a[0], a[3], a[4]);
      e.surface.transparency = 1 - intensity;
      tint(e.surface, intensity);
      break;
    }
    case TextureKind::kStripe:
      apply_stripe(texture, space, e);
      break;
    case TextureKind::kWindy: {
      const WindyParameters parameters{a[1], a[2], a[3], a[4], a[5], a[6], source.octaves};
      e.normal = normalize_above_epsilon(e.normal + a[0] * windy_bump(space.q, parameters));
      break;
    }
    case TextureKind::kMount: {
      const int index = mount_index(space.q, a[0], a[1], e.normal.z);
      const Color& color = (*texture.colors)[static_cast<std::size_t>(index)];
      tint(e.surface, color);
      e.surface.specular *= color;
      break;
    }
    case TextureKind::kImage:
      apply_image(texture, space, e);
      break;
  }
}

PathNeeds needs_of(const CompiledScene& scene, const CompiledTextures& textures, const Hit& hit, double time,
                   TraceScratch& scratch, bool transmission_only) {
  const std::uint32_t path = scene.leaves[hit.leaf].path;
  if (hit.instances.count == 0) return path == kNone ? PathNeeds{} : textures.needs(path, transmission_only);
  PathNeeds needs;
  PathWalk walk(scene, hit, time, scratch);
  PathLevel level;
  for (unsigned i = 1; walk.next(level); ++i) {
    if (level.texture_list == kNone) continue;
    const CompiledTextureList& list = textures.list(level.texture_list);
    if (transmission_only && !list.changes_transmission) continue;
    needs.levels = i;
    needs.frame = needs.frame || list.needs_frame;
  }
  return needs;
}

/// Takes the frame one level outward.
void extend_frame(Evaluation& e, const AffinePair& map) {
  if (!e.frame) {
    e.frame = map;
    return;
  }
  e.frame->forward = then(e.frame->forward, map.forward);
  e.frame->inverse = then(map.inverse, e.frame->inverse);
}

/// The point that textures see: along the ray, in fused arithmetic. On a surface in a plane at which a
/// texture changes, its rounding shows (D20).
Vec3 textured_point(const LocalHit& local) {
  return fused::add_scaled(local.ray.origin, local.t, local.ray.direction);
}

}  // namespace

void evaluate_hit(const CompiledScene& scene, const CompiledTextures& textures, const Hit& hit,
                  const Ray& world_ray, const SampleContext& sample, TraceScratch& scratch,
                  TexturedHit& out) {
  const Surface& surface =
      evaluate_hit(scene, textures, hit, world_ray, sample, scratch, out.world, out.surface);
  if (&surface != &out.surface) out.surface = surface;
}

const Surface& evaluate_textured_hit(const CompiledScene& scene, const CompiledTextures& textures,
                                     const Hit& hit, const Ray& world_ray, const SampleContext& sample,
                                     TraceScratch& scratch, WorldHit& world, Surface& textured) {
  const PathNeeds needs = needs_of(scene, textures, hit, world_ray.time, scratch, false);
  if (needs.levels == 0) {
    resolve_world(scene, hit, world_ray, scratch, world);
    return surface_of(scene, hit);
  }
  const LocalHit local = resolve_local(scene, hit, world_ray, scratch);
  textured = surface_of(scene, hit);
  Evaluation e{scene,        hit,     local, sample, {world_ray.time, scene.frame}, textured_point(local),
               local.normal, textured};
  Vec3 geometric = local.geometric_normal;
  Vec3 exact = local.point;
  double error = local.error;
  PathWalk walk(scene, hit, world_ray.time, scratch);
  PathLevel level;
  while (walk.next(level)) {
    if (level.map) {
      e.point = level.map->forward.point(e.point);
      const Vec3 inner = exact;
      exact = level.map->forward.point(inner);
      error = carried_error(error, *level.map, inner, exact);
      e.normal = level.map->normal(e.normal);
      geometric = level.map->normal(geometric);
      if (needs.frame) extend_frame(e, *level.map);
    }
    if (level.texture_list == kNone) continue;
    for (const CompiledTexture& texture : textures.list(level.texture_list).textures)
      apply_texture(texture, e);
  }
  world.point = exact;
  world.normal = e.normal;
  world.geometric_normal = geometric;
  world.error = error;
  world.smooth = local.smooth;
  world.entering = local.entering;
  return textured;
}

Transmittance evaluate_transmittance(const CompiledScene& scene, const CompiledTextures& textures,
                                     const Hit& hit, const Ray& world_ray, TraceScratch& scratch) {
  const PathNeeds needs =
      has_textures(scene, hit) ? needs_of(scene, textures, hit, world_ray.time, scratch, true) : PathNeeds{};
  if (needs.levels == 0) {
    // Where nothing is lost on the way, it does not matter which side this is.
    const Surface& s = surface_of(scene, hit);
    if (s.extinction == 1) return {s.body * s.transparency, 1, true};
  }
  const LocalHit local = resolve_local(scene, hit, world_ray, scratch);
  const auto result = [&local](const Surface& s) {
    return Transmittance{s.body * s.transparency, s.extinction, local.entering};
  };
  if (needs.levels == 0) return result(surface_of(scene, hit));
  // Nothing that changes transmission reads the shading normal, so it is not carried outward.
  const SampleContext sample;
  Surface textured = surface_of(scene, hit);
  Evaluation e{scene,        hit,     local, sample, {world_ray.time, scene.frame}, textured_point(local),
               local.normal, textured};
  PathWalk walk(scene, hit, world_ray.time, scratch);
  PathLevel level;
  for (unsigned i = 0; i < needs.levels && walk.next(level); ++i) {
    if (level.map) {
      e.point = level.map->forward.point(e.point);
      if (needs.frame) extend_frame(e, *level.map);
    }
    if (level.texture_list == kNone) continue;
    for (const CompiledTexture& texture : textures.list(level.texture_list).textures) {
      if (texture.changes_transmission) apply_texture(texture, e);
    }
  }
  return result(textured);
}

}  // namespace rayshade
