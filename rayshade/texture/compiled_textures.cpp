// SPDX-License-Identifier: MIT
// Reading the files of textures and computing their constants.
#include "rayshade/texture/compiled_textures.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "rayshade/image/reader.h"
#include "rayshade/texture/image_texture.h"

namespace rayshade {
namespace {

/// The files read so far, by name.
template <typename File>
using FileIndex = std::map<std::string, const File*>;

/// Whether a texture may change what passes through a surface.
bool changes_transmission(const Texture& texture) {
  switch (texture.kind) {
    case TextureKind::kChecker:
    case TextureKind::kBlotch:
    case TextureKind::kStripe:
    case TextureKind::kSky:
    case TextureKind::kCloud:
      return true;
    case TextureKind::kImage:
      switch (texture.image.component) {
        case ImageComponent::kColor:
          return texture.image.has_surface;
        case ImageComponent::kBody:
        case ImageComponent::kTransp:
          return true;
        default:
          return false;
      }
    default:
      return false;
  }
}

/// Whether a texture asks for the map from the primitive to its own level: uv mapping and tangents do.
bool needs_frame(const Texture& texture) {
  if (texture.kind == TextureKind::kStripe) return true;
  if (texture.kind != TextureKind::kImage) return false;
  return texture.mapping.kind == MappingKind::kUv || texture.image.component == ImageComponent::kBump;
}

/// H and lambda of the textures that sum fBm.
FbmParameters fbm_parameters(const Texture& texture) {
  const double* a = texture.arguments;
  switch (texture.kind) {
    case TextureKind::kFbm:
    case TextureKind::kFbmBump:
      return {fbm_omega(a[2], a[3]), a[3], texture.octaves};
    case TextureKind::kCloud:
    case TextureKind::kSky:
      return {fbm_omega(a[1], a[2]), a[2], texture.octaves};
    default:
      return {};
  }
}

bool uses_color_map(TextureKind kind) {
  return kind == TextureKind::kMarble || kind == TextureKind::kFbm || kind == TextureKind::kMount;
}

/// The content of a file; `what` says what it is good for.
Bytes read_file(const FileReference& file, std::string_view what, Provider& provider) {
  try {
    return provider.read(file.name);
  } catch (const ProviderError& error) {
    throw TextureError(fmt::format("Cannot open {} file \"{}\": {}.", what, file.name, error.what()),
                       file.location);
  }
}

ColorMap load_color_map(const FileReference& file, Provider& provider) {
  const Bytes text = read_file(file, "colormap", provider);
  try {
    return read_color_map(*text);
  } catch (const ColorMapError& error) {
    throw TextureError(fmt::format("{}, {}", file.name, error.what()), file.location);
  }
}

Image load_image(const FileReference& file, Provider& provider) {
  const Bytes bytes = read_file(file, "image", provider);
  try {
    return read_image(*bytes);
  } catch (const ImageError& error) {
    throw TextureError(fmt::format("Cannot read image \"{}\": {}.", file.name, error.what()), file.location);
  }
}

std::uint64_t bytes_of(const Image& image) {
  return image.bytes.size() + image.words.size() * sizeof(std::uint16_t) +
         image.floats.size() * sizeof(float);
}

void check_channels(const Image& image, const Texture& texture) {
  const ImageComponent component = texture.image.component;
  if (component_takes(component, image.channels)) return;
  throw TextureError(fmt::format("Image {} must have {}", texture.file.name,
                                 component_takes(component, 3) ? "1 or 3 channels" : "1 channel"),
                     texture.file.location);
}

}  // namespace

CompiledTextures::CompiledTextures(const CompiledScene& compiled, Provider& provider, bool unused) {
  const Scene& scene = *compiled.scene;
  FileIndex<ColorMap> tables;
  FileIndex<Image> images;

  const auto color_map = [&](const FileReference& file) {
    const ColorMap*& entry = tables[file.name];
    if (!entry) {
      color_maps_.push_back(std::make_unique<ColorMap>(load_color_map(file, provider)));
      entry = color_maps_.back().get();
      bytes_ += entry->size() * sizeof(Color);
    }
    return entry;
  };
  const auto image = [&](const FileReference& file) {
    const Image*& entry = images[file.name];
    if (!entry) {
      images_.push_back(std::make_unique<Image>(load_image(file, provider)));
      entry = images_.back().get();
      bytes_ += bytes_of(*entry);
    }
    return entry;
  };
  const auto compile = [&](const Texture& source) {
    CompiledTexture texture;
    texture.source = &source;
    texture.transformed = !source.transform.empty();
    texture.animated = source.transform.animated();
    if (texture.transformed && !texture.animated) {
      texture.transform.forward = source.transform.at({});
      const auto inverted = inverse(texture.transform.forward);
      if (!inverted) throw TextureError("Singular matrix.", source.location);
      texture.transform.inverse = *inverted;
    }
    texture.fbm = fbm_parameters(source);
    texture.needs_frame = needs_frame(source);
    texture.changes_transmission = changes_transmission(source);
    try {
      texture.mapping = CompiledMapping(source.mapping);
    } catch (const DegenerateMapping& error) {
      throw TextureError(error.what(), source.location);
    }
    if (uses_color_map(source.kind) && source.file.given()) texture.colors = color_map(source.file);
    if (source.kind == TextureKind::kMount && !texture.colors) {
      throw TextureError("Texture mount needs a colormap file.", source.location);
    }
    if (source.kind == TextureKind::kImage) {
      texture.image = image(source.file);
      check_channels(*texture.image, source);
    }
    return texture;
  };

  lists_.resize(scene.texture_lists.size());
  std::vector<bool> done(lists_.size());
  for (const PathNode& node : compiled.path_nodes) {
    if (node.textures == kNone || done[node.textures]) continue;
    done[node.textures] = true;
    CompiledTextureList& list = lists_[node.textures];
    for (const Texture& source : scene.texture_lists[node.textures]) {
      list.textures.push_back(compile(source));
      list.needs_frame = list.needs_frame || list.textures.back().needs_frame;
      list.changes_transmission = list.changes_transmission || list.textures.back().changes_transmission;
    }
  }
  for (std::size_t i = 0; unused && i < done.size(); ++i)
    for (const Texture& source : scene.texture_lists[i])
      if (!done[i]) compile(source);
  for (const bool transmission_only : {false, true}) {
    std::vector<PathNeeds>& needs = needs_[transmission_only];
    needs.reserve(compiled.path_nodes.size());
    for (const PathNode& node : compiled.path_nodes) {  // parents come first
      PathNeeds own;
      if (node.parent != kNone && needs[node.parent].levels > 0) {
        own = needs[node.parent];
        ++own.levels;
      }
      if (node.textures != kNone && (!transmission_only || lists_[node.textures].changes_transmission)) {
        own.levels = std::max(own.levels, 1u);
        own.frame = own.frame || lists_[node.textures].needs_frame;
      }
      needs.push_back(own);
    }
  }
}

}  // namespace rayshade
