// SPDX-License-Identifier: MIT
// Textures made ready for rays, once per scene: files read, constants computed, transforms inverted. Only
// texture lists that something in the compiled scene wears are prepared; a file is read once however often it
// is named. Immutable afterwards, so threads share it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "rayshade/geometry/compiled_scene.h"
#include "rayshade/image/color_map.h"
#include "rayshade/image/image.h"
#include "rayshade/scene/provider.h"
#include "rayshade/texture/mapping.h"
#include "rayshade/texture/procedural.h"

namespace rayshade {

/// A texture that cannot be used: a file that cannot be read, an image with the wrong channels, a degenerate
/// mapping.
struct TextureError : std::runtime_error {
  TextureError(const std::string& what, Location where) : std::runtime_error(what), location(where) {}
  Location location;
};

/// One texture of a list.
struct CompiledTexture {
  const Texture* source = nullptr;
  bool transformed = false;           ///< it has a transform
  bool animated = false;              ///< which varies with time, so that `transform` is not used
  AffinePair transform;               ///< texture space -> model space
  FbmParameters fbm;                  ///< fbm, fbmbump, cloud, sky
  CompiledMapping mapping;            ///< stripe, image
  const ColorMap* colors = nullptr;   ///< marble, fbm, mount; null without a map
  const Image* image = nullptr;       ///< image
  bool needs_frame = false;           ///< it asks for the map from the primitive to its own level
  bool changes_transmission = false;  ///< it may change transparency, body or extinction
};

struct CompiledTextureList {
  std::vector<CompiledTexture> textures;
  bool needs_frame = false;  ///< some texture of the list does
  bool changes_transmission = false;
};

/// How far outward the textures of a hit matter, and whether the map from its primitive must be kept.
struct PathNeeds {
  unsigned levels = 0;  ///< one more than the last level whose textures matter
  bool frame = false;
};

class CompiledTextures {
 public:
  CompiledTextures() = default;
  /// Throws TextureError. `scene` must outlive this. `unused`: compiles textures of objects that are not
  /// used, too, only to see if they are good.
  CompiledTextures(const CompiledScene& scene, Provider& provider, bool unused = false);
  CompiledTextures(CompiledTextures&&) = default;
  CompiledTextures& operator=(CompiledTextures&&) = default;

  /// The list of that index in Scene::texture_lists; it must be worn by a path node.
  const CompiledTextureList& list(std::uint32_t texture_list) const { return lists_[texture_list]; }
  /// Of hits on leaves with this path that went through no instance; `transmission_only`: only textures that
  /// change transmission matter.
  const PathNeeds& needs(std::uint32_t path, bool transmission_only) const {
    return needs_[transmission_only][path];
  }
  /// Bytes of images and colour maps, for the statistics.
  std::uint64_t bytes() const { return bytes_; }
  /// Files read.
  std::size_t files() const { return color_maps_.size() + images_.size(); }

 private:
  std::vector<CompiledTextureList> lists_;
  std::vector<PathNeeds> needs_[2];  ///< by path node
  std::vector<std::unique_ptr<ColorMap>> color_maps_;
  std::vector<std::unique_ptr<Image>> images_;
  std::uint64_t bytes_ = 0;
};

}  // namespace rayshade
