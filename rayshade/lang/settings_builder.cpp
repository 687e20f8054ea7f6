// SPDX-License-Identifier: MIT
// See settings_builder.h.
#include "rayshade/lang/settings_builder.h"

#include <fmt/format.h>

#include <algorithm>

namespace rayshade::lang {
namespace {

/// The value, or nothing where -1 stands for "unset".
std::optional<double> unless_unset(double value) {
  return value == -1 ? std::nullopt : std::optional<double>(value);
}
std::optional<Color> unless_unset(const Color& value) {
  return value.r == -1 ? std::nullopt : std::optional<Color>(value);
}

}  // namespace

int checked_octaves(Context& context, int octaves, const Span& span) {
  if (octaves <= kMostOctaves) return std::max(octaves, 0);
  context.messages.error(
      span, fmt::format("{} octaves of noise are too many; at most {} are possible", octaves, kMostOctaves));
  return 1;
}

void Settings::eye(const Vec3& position, const Span& transforms, bool alone) {
  out_.eye = position;
  if (!alone) context_.messages.advice(transforms, "transforms after 'eyep' have no effect");
}

void Settings::fov(double horizontal) {
  out_.horizontal_fov = horizontal;
  out_.vertical_fov.reset();
}

void Settings::fov(double horizontal, double vertical) {
  out_.horizontal_fov = horizontal;
  out_.vertical_fov = unless_unset(vertical);
}

void Settings::focal_distance(double distance) { out_.focal_distance = unless_unset(distance); }
void Settings::eye_separation(double distance) { out_.eye_separation = unless_unset(distance); }

void Settings::screen(int width, int height, const Span& span) {
  out_.screen_location = context_.sources.locate(span);
  const RenderSettings defaults;
  if (width == -1 && height == -1) {
    out_.screen.reset();
  } else {
    out_.screen = {width == -1 ? defaults.width : width, height == -1 ? defaults.height : height};
  }
}

void Settings::window(int min_x, int max_x, int min_y, int max_y, const Span& span) {
  if (out_.window) return;  // the first one wins
  out_.window = {min_x, max_x, min_y, max_y};
  out_.window_location = context_.sources.locate(span);
}

void Settings::crop(double left, double right, double bottom, double top) {
  out_.crop = {left, right, bottom, top};
}

void Settings::samples(int per_side, const Span& span) {
  if (per_side == -1) return out_.samples.reset();
  if (per_side < 1 || per_side > kMostSamples) {
    context_.messages.error(span, fmt::format("'sample' must be 1 to {}, not {}", kMostSamples, per_side));
    return;
  }
  out_.samples = per_side;
  out_.samples_location = context_.sources.locate(span);
}

void Settings::samples(int per_side, bool jitter, const Span& span) {
  samples(per_side, span);
  out_.jitter = jitter;
}

void Settings::filter_width(double width) { out_.filter_width = unless_unset(width); }
void Settings::contrast(const Color& limit) { out_.contrast = unless_unset(limit); }
void Settings::cutoff(const Color& limit) { out_.cutoff = unless_unset(limit); }
void Settings::max_depth(int depth) { out_.max_depth = std::max(depth, 0); }

void Settings::outfile(Name name, const Span& span) {
  if (name.view().empty()) return context_.messages.error(span, "'outfile' needs the name of a file");
  if (context_.options.output_named)
    context_.messages.warning(span,
                              fmt::format("outfile '{}' is ignored: -O names the picture", name.view()));
  else if (out_.output)
    context_.messages.warning(
        span, fmt::format("outfile '{}' is ignored: the first one, '{}', holds", name.view(), *out_.output));
  if (out_.output) return;
  out_.output = name.view();
}

void Settings::report_frequency(int lines) { out_.report_frequency = std::max(std::abs(lines), 1); }

void Settings::report_file(Name name) {
  if (!out_.report_file) out_.report_file = name.view();
}

void Settings::frames(int count) { out_.frames = std::max(count, 1); }

void Settings::atmosphere(double index, const Span& span) {
  atmosphere();
  if (index > 0) {
    out_.atmosphere_index = index;
  } else {
    context_.messages.error(
        span, fmt::format("the index of refraction of the atmosphere must be above 0, not {}", index));
  }
}

void Settings::fog(const Color& color, const Color& thickness) {
  AtmosphereEffect effect;
  effect.kind = EffectKind::kFog;
  effect.color = color;
  effect.thickness = thickness;
  out_.effects.push_back(effect);
}

void Settings::mist(const Color& color, const Color& thickness, double zero, double scale) {
  AtmosphereEffect effect;
  effect.kind = EffectKind::kMist;
  effect.color = color;
  effect.thickness = thickness;
  effect.zero = zero;
  effect.scale = scale;
  out_.effects.push_back(effect);
}

void Settings::fogdeck(double altitude, double offset, const Vec3& scale, double chaos_scale, int octaves,
                       const Color& color, const Color& thickness, const Span& octaves_span) {
  AtmosphereEffect effect;
  effect.kind = EffectKind::kFogDeck;
  effect.color = color;
  effect.thickness = thickness;
  effect.altitude = altitude;
  effect.offset = offset;
  effect.noise_scale = scale;
  effect.chaos_scale = chaos_scale;
  effect.octaves = checked_octaves(context_, octaves, octaves_span);
  out_.effects.push_back(effect);
}

}  // namespace rayshade::lang
