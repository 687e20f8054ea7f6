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
void locate_axis(double u, std::uint32_t size, std::uint32_t& pixel, double& fraction) {
  const double scaled = (u - std::floor(u)) * size;
  pixel = 0;
  fraction = 0;
  if (!(scaled < size)) return;
  pixel = static_cast<std::uint32_t>(scaled);
  fraction = scaled - pixel;
}

Texel weighted(const Texel& texel, double weight) { return {texel.color * weight, texel.alpha * weight}; }

void add(Texel& sum, const Texel& texel) {
  sum.color += texel.color;
  sum.alpha += texel.alpha;
}

}  // namespace

TextureImage::TextureImage(std::uint32_t width, std::uint32_t height, int channels, bool has_alpha,
                           int maximum, std::vector<std::uint16_t> samples)
    : width_(width), height_(height), channels_(channels), has_alpha_(has_alpha), maximum_(maximum) {
  if (maximum <= 255) {
    narrow_.assign(samples.begin(), samples.end());
  } else {
    wide_ = std::move(samples);
  }
}

TextureImage::Position TextureImage::locate(double u, double v) const {
  Position p;
  locate_axis(u, width_, p.x, p.fx);
  locate_axis(v, height_, p.y, p.fy);
  return p;
}

TextureImage::Position TextureImage::right_of(Position p) const {
  p.x = p.x + 1 == width_ ? 0 : p.x + 1;
  return p;
}

TextureImage::Position TextureImage::above(Position p) const {
  p.y = p.y + 1 == height_ ? 0 : p.y + 1;
  return p;
}

Texel TextureImage::pixel(std::uint32_t x, std::uint32_t y) const {
  const std::size_t stride = static_cast<std::size_t>(channels_) + (has_alpha_ ? 1 : 0);
  const std::size_t first = (static_cast<std::size_t>(y) * width_ + x) * stride;
  Texel texel;
  texel.color.r = sample(first) / maximum_;
  texel.color.g = channels_ == 3 ? sample(first + 1) / maximum_ : texel.color.r;
  texel.color.b = channels_ == 3 ? sample(first + 2) / maximum_ : texel.color.r;
  if (has_alpha_) texel.alpha = sample(first + stride - 1) / maximum_;
  return texel;
}

Texel TextureImage::at(const Position& p, bool smooth) const {
  if (!smooth) return pixel(p.x, p.y);
  const Position right = right_of(p), up = above(p);
  Texel sum = weighted(pixel(p.x, p.y), (1 - p.fx) * (1 - p.fy));
  add(sum, weighted(pixel(right.x, p.y), p.fx * (1 - p.fy)));
  add(sum, weighted(pixel(p.x, up.y), (1 - p.fx) * p.fy));
  add(sum, weighted(pixel(right.x, up.y), p.fx * p.fy));
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
