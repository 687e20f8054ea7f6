// SPDX-License-Identifier: MIT
#include "rayshade/shading/atmosphere.h"

#include "rayshade/math/functions.h"
#include "rayshade/texture/noise.h"

namespace rayshade {
namespace {

constexpr double kLogHalf = -0.69314718;  // exactly these digits (shading.md 0)

Color fade(const Color& color, const AtmosphereEffect& effect, double length) {
  const Color left{attenuation(length, effect.thickness.r), attenuation(length, effect.thickness.g),
                   attenuation(length, effect.thickness.b)};
  const Color one{1, 1, 1};
  return left * color + (one - left) * effect.color;
}

/// Optical length through mist, whose density falls with height (shading.md 6).
double mist_length(const AtmosphereEffect& effect, const Ray& ray, double distance, const Vec3& end) {
  const double g0 = fn::exp(effect.zero - ray.origin.z / effect.scale);
  const double g1 = fn::exp(effect.zero - end.z / effect.scale);
  const double delta = (end.z - ray.origin.z) / effect.scale;
  return std::fabs(delta) > kEpsilon ? distance * ((g0 - g1) / delta) : distance * g1;
}

Color apply_fog_deck(const AtmosphereEffect& effect, const Color& color, const Ray& ray, double distance) {
  if (std::fabs(ray.direction.z) < kEpsilon) return color;
  const double w = (effect.altitude - ray.origin.z) / ray.direction.z;
  if (w < kEpsilon || w > distance) return color;
  const Vec3 crossing = ray.at(w);
  const Vec3 q{crossing.x * effect.noise_scale.x, crossing.y * effect.noise_scale.y,
               crossing.z * effect.noise_scale.z};
  double density = effect.offset;
  if (effect.chaos_scale != 0) density += effect.chaos_scale * abs_chaos(q, effect.octaves);
  if (density < kEpsilon) return color;
  return fade(color, effect, (distance - w) * density);
}

}  // namespace

double attenuation(double length, double thickness) {
  if (thickness < kEpsilon) return 0;
  const double y = kLogHalf * length / thickness;
  // An overflow to infinity, and the 0 * infinity of a mist that does, must leave nothing.
  if (!(y >= -10)) return 0;
  return fn::exp(y);
}

Color apply_atmosphere(const std::vector<AtmosphereEffect>& effects, const Color& color, const Ray& ray,
                       double distance, const Vec3& end) {
  Color out = color;
  for (auto effect = effects.rbegin(); effect != effects.rend(); ++effect) {
    switch (effect->kind) {
      case EffectKind::kFog:
        out = fade(out, *effect, distance);
        break;
      case EffectKind::kMist:
        out = fade(out, *effect, mist_length(*effect, ray, distance, end));
        break;
      case EffectKind::kFogDeck:
        out = apply_fog_deck(*effect, out, ray, distance);
        break;
    }
  }
  return out;
}

}  // namespace rayshade
