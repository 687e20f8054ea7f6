// SPDX-License-Identifier: MIT
// What shading did, and what it found unnecessary (architecture law 4). One per thread, added up at the end.
#pragma once

#include <cstdint>

namespace rayshade {

struct ShadingCounts {
  std::uint64_t eye_rays = 0;
  std::uint64_t shadow_rays = 0;  ///< light tests actually made
  std::uint64_t reflected_rays = 0;
  std::uint64_t transmitted_rays = 0;
  std::uint64_t shaded_hits = 0;
  std::uint64_t shadow_hits = 0;        ///< shadow rays whose way met something
  std::uint64_t transparent_walks = 0;  ///< shadow rays that were followed through transparent surfaces
  std::uint64_t total_reflections = 0;
  // What the intersector was asked; a shadow ray through transparent surfaces asks several times:
  std::uint64_t nearest_queries = 0;
  std::uint64_t occlusion_queries = 0;
  // Skipped because it could not change the picture:
  std::uint64_t skipped_back_lights = 0;  ///< light behind an opaque surface
  std::uint64_t skipped_dark_lights =
      0;  ///< light or surface response exactly black, or outside the spot's cone
  std::uint64_t skipped_unshadowed = 0;  ///< noshadow light or surface, or -n
  std::uint64_t skipped_cutoff = 0;      ///< secondary rays below the cutoff
  std::uint64_t skipped_depth = 0;       ///< hits at the maximum depth that would have spawned more
  std::uint64_t skipped_textures = 0;    ///< hits with no texture on their path

  void add(const ShadingCounts& o) {
    eye_rays += o.eye_rays;
    shadow_rays += o.shadow_rays;
    reflected_rays += o.reflected_rays;
    transmitted_rays += o.transmitted_rays;
    shaded_hits += o.shaded_hits;
    shadow_hits += o.shadow_hits;
    transparent_walks += o.transparent_walks;
    total_reflections += o.total_reflections;
    nearest_queries += o.nearest_queries;
    occlusion_queries += o.occlusion_queries;
    skipped_back_lights += o.skipped_back_lights;
    skipped_dark_lights += o.skipped_dark_lights;
    skipped_unshadowed += o.skipped_unshadowed;
    skipped_cutoff += o.skipped_cutoff;
    skipped_depth += o.skipped_depth;
    skipped_textures += o.skipped_textures;
  }
  std::uint64_t queries() const { return nearest_queries + occlusion_queries; }
  std::uint64_t total_rays() const { return eye_rays + shadow_rays + reflected_rays + transmitted_rays; }
};

}  // namespace rayshade
