// SPDX-License-Identifier: MIT
// From a hit to the surface and the normal that shading uses: textures applied level by level, from the
// primitive outward (textures.md 1.2). Pure functions of their arguments; the stored surfaces and textures
// never change, so any number of threads may call them at once, each with its own scratch.
#pragma once

#include <array>

#include "rayshade/geometry/resolve.h"
#include "rayshade/scene/surface.h"
#include "rayshade/texture/compiled_textures.h"

namespace rayshade {

/// Where gloss gets its random numbers: two uniform numbers in [0, 1) for each gloss texture met at one hit.
/// Whoever shades derives from this and answers from the address of the sample (rule 6); nothing is drawn
/// where no gloss is.
class GlossDraws {
 public:
  /// The numbers of the nth gloss texture on the way outward, counting from 0. A function: the same n, the
  /// same answer.
  virtual std::array<double, 2> operator()(unsigned nth) const = 0;

 protected:
  ~GlossDraws() = default;
};

/// What a texture may know of the sample that is being traced.
struct SampleContext {
  int sample_number = -1;  ///< of the eye ray, within its pixel; negative: unknown (shading.md 7.6)
  int samples_per_side = 1;
  const GlossDraws* gloss = nullptr;  ///< none: the middle of each stratum
};

/// A hit ready to be shaded. world.normal is not of unit length where fbmbump left it so (textures.md D2).
struct TexturedHit {
  WorldHit world;
  Surface surface;
};

/// Surface, point, normals and flags of a hit with all textures on its path applied. `world_ray` is the ray
/// that found the hit; its time is that of moving textures. Throws MotionError where an animated transform is
/// degenerate.
void evaluate_hit(const CompiledScene& scene, const CompiledTextures& textures, const Hit& hit,
                  const Ray& world_ray, const SampleContext& sample, TraceScratch& scratch, TexturedHit& out);

/// The same of a hit that has textures, without copying a surface that none of them changes: returns that of
/// the scene, or `textured`, which then holds it.
const Surface& evaluate_textured_hit(const CompiledScene& scene, const CompiledTextures& textures,
                                     const Hit& hit, const Ray& world_ray, const SampleContext& sample,
                                     TraceScratch& scratch, WorldHit& world, Surface& textured);

/// The same of any hit. (What the shading of millions of hits asks for.)
inline const Surface& evaluate_hit(const CompiledScene& scene, const CompiledTextures& textures,
                                   const Hit& hit, const Ray& world_ray, const SampleContext& sample,
                                   TraceScratch& scratch, WorldHit& world, Surface& textured) {
  if (has_textures(scene, hit))
    return evaluate_textured_hit(scene, textures, hit, world_ray, sample, scratch, world, textured);
  resolve_world(scene, hit, world_ray, scratch, world);
  return surface_of(scene, hit);
}

/// What a shadow ray needs of a transparent surface that it passes (shading.md 5).
struct Transmittance {
  Color color;            ///< transparency times body, textured
  double extinction = 1;  ///< textured
  bool entering = true;   ///< not meaningful where extinction is 1
};

/// The same surface as evaluate_hit, but only the textures that can change what passes through it are
/// evaluated. Whether the surface casts a transparent shadow at all is decided by the caller from the surface
/// before texturing.
Transmittance evaluate_transmittance(const CompiledScene& scene, const CompiledTextures& textures,
                                     const Hit& hit, const Ray& world_ray, TraceScratch& scratch);

}  // namespace rayshade
