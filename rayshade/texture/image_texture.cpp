// SPDX-License-Identifier: MIT
// Image look-up and combination.
#include "rayshade/texture/image_texture.h"

#include <cmath>

#include "rayshade/texture/surface_ops.h"

namespace rayshade {
namespace {

/// Tile sizes nearer to zero than this count as zero, alphas nearer to 0 or 1 as 0 or 1.
constexpr double kTileZero = 0.001;
constexpr double kAlphaZero = 0.001;

/// Pixel and fraction of a wrapped coordinate. Exactly 1, which a tiny negative coordinate wraps to, is the
/// first pixel (textures.md D13), as is what is not finite.
void locate_axis(double u, std::int64_t size, std::int64_t& pixel, double& fraction) {
  const double scaled = (u - std::floor(u)) * static_cast<double>(size);
  pixel = 0;
  fraction = 0;
  if (!(scaled < static_cast<double>(size))) return;
  pixel = static_cast<std::int64_t>(scaled);
  fraction = scaled - static_cast<double>(pixel);
}

Texel pixel_of(const Image& image, std::int64_t x, std::int64_t y) {
  const double first = image.value(x, y, 0);
  if (image.channels != 3) return {{first, first, first}, image.alpha(x, y)};
  return {{first, image.value(x, y, 1), image.value(x, y, 2)}, image.alpha(x, y)};
}

void add_weighted(Texel& sum, const Texel& texel, double weight) {
  sum.color += texel.color * weight;
  sum.alpha += texel.alpha * weight;
}

}  // namespace

TexelPosition locate_texel(const Image& image, double u, double v) {
  TexelPosition p;
  locate_axis(u, image.width, p.x, p.fx);
  locate_axis(v, image.height, p.y, p.fy);
  return p;
}

TexelPosition texel_right_of(const Image& image, TexelPosition position) {
  position.x = position.x + 1 == image.width ? 0 : position.x + 1;
  return position;
}

TexelPosition texel_above(const Image& image, TexelPosition position) {
  position.y = position.y + 1 == image.height ? 0 : position.y + 1;
  return position;
}

Texel texel_at(const Image& image, const TexelPosition& p, bool smooth) {
  if (!smooth) return pixel_of(image, p.x, p.y);
  const std::int64_t right = texel_right_of(image, p).x, above = texel_above(image, p).y;
  Texel sum{{}, 0};
  add_weighted(sum, pixel_of(image, p.x, p.y), (1 - p.fx) * (1 - p.fy));
  add_weighted(sum, pixel_of(image, right, p.y), p.fx * (1 - p.fy));
  add_weighted(sum, pixel_of(image, p.x, above), (1 - p.fx) * p.fy);
  add_weighted(sum, pixel_of(image, right, above), p.fx * p.fy);
  return sum;
}

bool tile_draws(double u, double v, double tu, double tv) {
  const bool zero_u = std::fabs(tu) < kTileZero, zero_v = std::fabs(tv) < kTileZero;
  if (zero_u && zero_v) return true;
  if (tu < -kTileZero && tv < -kTileZero && (u > -tu || u < 0 || v > -tv || v < 0)) return true;
  if (tu > kTileZero && (u > tu || u < 0)) return false;
  if (tv > kTileZero && (v > tv || v < 0)) return false;
  if (tu < -kTileZero && 0 < u && u < -tu) return false;
  if (tv < -kTileZero && 0 < v && v < -tv) return false;
  return true;
}

bool component_takes(ImageComponent component, int channels) {
  switch (component) {
    case ImageComponent::kColor:
    case ImageComponent::kAmbient:
    case ImageComponent::kDiffuse:
    case ImageComponent::kSpecular:
    case ImageComponent::kBody:
      return channels == 1 || channels == 3;
    case ImageComponent::kReflect:
    case ImageComponent::kTransp:
    case ImageComponent::kSpecpow:
    case ImageComponent::kBump:
    case ImageComponent::kIndex:
      return channels == 1;
  }
  return false;
}

void apply_texel(const Texel& texel, const ImageOptions& options, const Surface* replacement,
                 Surface& surface) {
  const double low = options.range_low, span = options.range_high - options.range_low;
  const double value = low + texel.color.r * span;
  const Color color{low + texel.color.r * span, low + texel.color.g * span, low + texel.color.b * span};
  Surface base = options.component == ImageComponent::kColor && replacement ? *replacement : surface;
  switch (options.component) {
    case ImageComponent::kColor:  // the range is not applied here (textures.md D11)
      base.ambient *= texel.color;
      base.diffuse *= texel.color;
      base.specular *= texel.color;
      break;
    case ImageComponent::kAmbient:
      base.ambient *= color;
      break;
    case ImageComponent::kDiffuse:
      base.diffuse *= color;
      break;
    case ImageComponent::kSpecular:
      base.specular *= color;
      break;
    case ImageComponent::kBody:
      base.body *= color;
      break;
    case ImageComponent::kReflect:
      base.reflectance *= value;
      break;
    case ImageComponent::kTransp:
      base.transparency *= value;
      break;
    case ImageComponent::kSpecpow:
      base.specular_exponent *= value;
      break;
    case ImageComponent::kIndex:
      base.index *= value;
      break;
    case ImageComponent::kBump:
      return;
  }
  if (texel.alpha < 1 - kAlphaZero) {
    blend(surface, base, 1 - texel.alpha, texel.alpha);
  } else {
    surface = base;
  }
}

}  // namespace rayshade
