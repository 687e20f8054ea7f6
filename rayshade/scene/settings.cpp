// SPDX-License-Identifier: MIT
// Scene settings and options become RenderSettings: defaults (language.md 4), window and crop (6.1), camera
// checks (8).
#include "rayshade/scene/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

namespace rayshade {
namespace {

constexpr int kMaxSide = 1000000;
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 40;
constexpr int kMaxSamples = 64;
constexpr double kGaussWidth = 1.8;

/// The sine of the smallest angle between view and up that still has a direction to the right: rounding of
/// unit vectors decides below.
constexpr double kParallel = 1e-12;

template <class T>
T choose(const std::optional<T>& option, const std::optional<T>& scene, const T& fallback) {
  return option ? *option : scene.value_or(fallback);
}

/// Where -1 stands for the default (language.md 4), in an option too: then the scene's value does not count.
Color choose_color(const std::optional<Color>& option, const std::optional<Color>& scene,
                   const Color& fallback) {
  const Color chosen = choose(option, scene, fallback);
  return chosen.r == -1 ? fallback : chosen;
}

void require_finite(double value, const char* what) {
  if (!std::isfinite(value)) throw SettingsError(fmt::format("{} is not a finite number", what));
}

void require_finite(const Vec3& value, const char* what) {
  if (!is_finite(value)) throw SettingsError(fmt::format("{} is not finite", what));
}

void require_finite(const Color& value, const char* what) {
  require_finite(Vec3{value.r, value.g, value.b}, what);
}

/// The window of language.md 6.1 along one axis: `crop` of `window`, truncated, both ends inclusive.
void crop_axis(double low, double high, int& first, int& last) {
  if (low > high) std::swap(low, high);
  low = std::clamp(low, 0.0, 1.0);
  high = std::clamp(high, 0.0, 1.0);
  const double begin = first, extent = static_cast<double>(last) - first;
  first = static_cast<int>(begin + low * extent);
  last = static_cast<int>(begin + high * extent);
}

void resolve_screen(const SceneSettings& scene, const SettingsOverrides& options, RenderSettings& out) {
  const auto screen = choose(options.screen, scene.screen, {out.width, out.height});
  const Location where = options.screen ? Location{} : scene.screen_location;
  if (screen[0] != -1) out.width = screen[0];
  if (screen[1] != -1) out.height = screen[1];
  if (out.width < 1 || out.height < 1) {
    throw SettingsError(fmt::format("the screen has no pixels ({} x {})", out.width, out.height), where);
  }
  if (out.width > kMaxSide || out.height > kMaxSide || std::int64_t{out.width} * out.height > kMaxPixels) {
    throw SettingsError(fmt::format("the screen is too large ({} x {})", out.width, out.height), where);
  }
}

void resolve_window(const SceneSettings& scene, const SettingsOverrides& options, RenderSettings& out) {
  const auto window = choose(options.window, scene.window, {0, out.width - 1, 0, out.height - 1});
  const auto crop = choose(options.crop, scene.crop, {0, 1, 0, 1});
  for (const double part : crop) require_finite(part, "crop");
  const Location where = options.window ? Location{} : scene.window_location;
  if (window[0] > window[1] || window[2] > window[3]) {
    throw SettingsError(fmt::format("the window is empty (columns {} to {}, rows {} to {})", window[0],
                                    window[1], window[2], window[3]),
                        where);
  }
  out.min_x = window[0];
  out.max_x = window[1];
  out.min_y = window[2];
  out.max_y = window[3];
  crop_axis(crop[0], crop[1], out.min_x, out.max_x);
  crop_axis(crop[2], crop[3], out.min_y, out.max_y);
  if (out.min_x < 0 || out.min_y < 0 || out.max_x >= out.width || out.max_y >= out.height) {
    throw SettingsError(
        fmt::format("the window (columns {} to {}, rows {} to {}) is not inside the {} x {} screen",
                    out.min_x, out.max_x, out.min_y, out.max_y, out.width, out.height),
        where);
  }
}

/// Checks one eye point; false where it has no basis.
bool has_basis(const Vec3& eye, const Vec3& look, const Vec3& up) {
  const Vec3 view = normalize(look - eye);
  return length(cross(view, normalize(up))) > kParallel;
}

void resolve_camera(const SceneSettings& scene, const SettingsOverrides& options, RenderSettings& out) {
  out.eye = scene.eye.value_or(out.eye);
  out.look = scene.look.value_or(out.look);
  out.up = scene.up.value_or(out.up);
  require_finite(out.eye, "eye point");
  require_finite(out.look, "look point");
  require_finite(out.up, "up vector");
  require_finite(out.look - out.eye, "view direction");
  out.horizontal_fov = scene.horizontal_fov.value_or(out.horizontal_fov);
  // Proportional in the angle, not in its tangent (language.md 8.1).
  out.vertical_fov = scene.vertical_fov.value_or(out.horizontal_fov * out.height / out.width);
  require_finite(out.horizontal_fov, "field of view");
  require_finite(out.vertical_fov, "field of view");
  out.aperture = scene.aperture.value_or(out.aperture);
  out.focal_distance = scene.focal_distance;
  require_finite(out.aperture, "aperture");
  if (out.focal_distance) require_finite(*out.focal_distance, "focal distance");
  if (max_abs(out.look - out.eye) == 0) throw SettingsError("the eye point is the look point");
  if (max_abs(out.up) == 0) throw SettingsError("the up vector is zero");
  if (!has_basis(out.eye, out.look, out.up))
    throw SettingsError("the view direction is parallel to the up vector");

  out.stereo = options.eye;
  auto separation = options.eye_separation ? options.eye_separation : scene.eye_separation;
  if (separation == -1) separation.reset();
  out.eye_separation = separation.value_or(0);
  require_finite(out.eye_separation, "eye separation");
  if (out.stereo == Eye::kCenter) return;
  if (!separation) throw SettingsError("a left or right eye needs an eye separation (eyesep or -E)");
  // The shift is perpendicular to up, so the shifted view cannot be parallel to it.
  const Vec3 right = normalize(cross(normalize(out.look - out.eye), normalize(out.up)));
  const Vec3 shift = (out.stereo == Eye::kLeft ? -0.5 : 0.5) * out.eye_separation * right;
  require_finite(out.eye + shift, "shifted eye point");
}

void resolve_sampling(const SceneSettings& scene, const SettingsOverrides& options, RenderSettings& out) {
  out.samples = choose(options.samples, scene.samples, out.samples);
  if (out.samples < 1 || out.samples > kMaxSamples) {
    throw SettingsError(fmt::format("sample {} is out of range: 1 to {} samples per side of a pixel",
                                    out.samples, kMaxSamples),
                        options.samples ? Location{} : scene.samples_location);
  }
  out.sampling = options.sampling.value_or(out.sampling);
  if (options.tolerance && !out.sobol()) throw SettingsError("a tolerance needs --sampling sobol");
  out.tolerance = options.tolerance.value_or(out.tolerance);
  if (!(out.tolerance >= 0) || out.tolerance > 1)
    throw SettingsError(fmt::format("tolerance {} is out of range: 0 to 1", out.tolerance));
  out.jitter = choose(options.jitter, scene.jitter, out.jitter);
  out.filter = choose(options.filter, scene.filter, out.filter);
  out.filter_width = scene.filter_width.value_or(out.filter == FilterKind::kGauss ? kGaussWidth : 1.0);
  require_finite(out.filter_width, "filter width");
  out.contrast = choose_color(options.contrast, scene.contrast, out.contrast);
  out.cutoff = choose_color(options.cutoff, scene.cutoff, out.cutoff);
  out.max_depth = std::max(0, choose(options.max_depth, scene.max_depth, out.max_depth));
}

void resolve_time(const SceneSettings& scene, const SettingsOverrides& options, RenderSettings& out) {
  out.shutter = scene.shutter.value_or(out.shutter);
  out.start_time = scene.start_time.value_or(out.start_time);
  out.frame_length = scene.frame_length.value_or(out.frame_length);
  require_finite(out.shutter, "shutter");
  require_finite(out.start_time, "start time");
  require_finite(out.frame_length, "frame length");
  out.shutter = std::max(out.shutter, 0.0);
  out.first_frame = options.first_frame;
  out.frames = std::max(1, choose(options.frames, scene.frames, out.frames));
  if (out.first_frame > std::numeric_limits<int>::max() - (out.frames - 1)) {
    throw SettingsError("the number of the last frame is too large");
  }
}

}  // namespace

RenderSettings resolve_settings(const SceneSettings& scene, const SettingsOverrides& options) {
  RenderSettings out;
  resolve_screen(scene, options, out);
  resolve_window(scene, options, out);
  resolve_camera(scene, options, out);
  resolve_sampling(scene, options, out);
  resolve_time(scene, options, out);
  out.background = scene.background.value_or(out.background);
  out.ambient_light = scene.ambient_light.value_or(out.ambient_light);
  out.atmosphere_index = scene.atmosphere_index.value_or(out.atmosphere_index);
  require_finite(out.background, "background");
  require_finite(out.ambient_light, "ambient light");
  require_finite(out.atmosphere_index, "index of the atmosphere");
  out.effects = scene.effects;
  out.shadows = !options.no_shadows;
  out.transparent_shadows = scene.toggle_transparent_shadows == options.toggle_transparent_shadows;
  out.flip_normals = options.flip_normals;
  out.seed = options.seed;
  return out;
}

}  // namespace rayshade
