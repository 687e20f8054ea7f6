// SPDX-License-Identifier: MIT
// Textures as written (textures.md 1.1, language.md 3.9). Passive: evaluation is in rayshade/texture.
#pragma once

#include <cstdint>
#include <string>

#include "rayshade/math/vec.h"
#include "rayshade/scene/location.h"
#include "rayshade/scene/surface.h"
#include "rayshade/scene/transform.h"

namespace rayshade {

enum class TextureKind : std::uint8_t {
  kChecker,
  kBlotch,
  kBump,
  kMarble,
  kFbm,
  kFbmBump,
  kWood,
  kGloss,
  kCloud,
  kSky,
  kStripe,
  kWindy,
  kMount,
  kImage,
};

/// A file that a scene names. `name` is empty where the optional file was left out.
struct FileReference {
  std::string name;
  Location location;
  bool given() const { return !name.empty(); }
};

enum class MappingKind : std::uint8_t { kUv, kSpherical, kCylindrical, kPlanar };

/// How a point becomes (u, v): textures.md 5.2 to 5.5. `explicit_axes` tells whether the three vectors were
/// written.
struct Mapping {
  MappingKind kind = MappingKind::kUv;
  bool explicit_axes = false;
  Vec3 origin;
  Vec3 up{0, 0, 1};  ///< up axis; v axis for planar
  Vec3 u_axis{1, 0, 0};
};

enum class ImageComponent : std::uint8_t {
  kColor,
  kAmbient,
  kDiffuse,
  kSpecular,
  kBody,
  kReflect,
  kTransp,
  kSpecpow,
  kBump,
  kIndex,
};

struct ImageOptions {
  ImageComponent component = ImageComponent::kColor;
  double tile_u = 0, tile_v = 0;
  double range_high = 1, range_low = 0;
  bool smooth = false;
  bool has_surface = false;  ///< textsurf was given; the surface is Texture::surface
};

/// One `texture` statement. The numeric arguments stand in the order of the grammar:
///   checker -; blotch mix; bump size; marble -; fbm offset scale H lambda thresh; fbmbump offset scale H
///   lambda; wood -; gloss glossiness; cloud scale H lambda cthresh lthresh tscale; sky scale H lambda
///   cthresh lthresh; stripe width bump; windy scale wscale cscale bscale tscale hscale offset; mount
///   turbulence slope; image -.
/// The truncated octave count, where there is one, is in `octaves`.
struct Texture {
  TextureKind kind = TextureKind::kChecker;
  double arguments[7] = {};
  int octaves = 0;
  Surface surface;     ///< second surface of checker, blotch, stripe; textsurf of image
  FileReference file;  ///< colour map of marble, fbm, mount; picture of image
  Mapping mapping;     ///< stripe and image
  ImageOptions image;
  TransformList transform;
  Location location;
};

}  // namespace rayshade
