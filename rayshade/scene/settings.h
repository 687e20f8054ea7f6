// SPDX-License-Identifier: MIT
// What a scene says about viewing and rendering (language.md 3.4 and 4): only what was written is set. The
// program merges these with its options into RenderSettings (resolve_settings), where every value is present.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "rayshade/math/vec.h"
#include "rayshade/scene/location.h"

namespace rayshade {

enum class FilterKind : std::uint8_t { kBox, kGauss };
/// Where the samples of a pixel lie, and which pixels get how many.
enum class SamplingKind : std::uint8_t {
  kOriginal,  ///< jittered grids, refined by contrast (shading.md 7)
  kSobol,     ///< scrambled low-discrepancy points, until their estimated error is small
};
enum class Eye : std::uint8_t { kCenter, kLeft, kRight };
enum class EffectKind : std::uint8_t { kFog, kMist, kFogDeck };

/// One atmosphere effect (shading.md 6).
struct AtmosphereEffect {
  EffectKind kind = EffectKind::kFog;
  Color color, thickness;
  double zero = 0, scale = 1;       ///< mist
  double altitude = 0, offset = 0;  ///< fogdeck
  Vec3 noise_scale{1, 1, 1};
  double chaos_scale = 0;
  int octaves = 0;
};

/// Values written in the scene; "first wins" and "last wins" are already applied (language.md 4), -1 where it
/// means unset is already dropped.
struct SceneSettings {
  std::optional<Vec3> eye, look, up;
  std::optional<double> horizontal_fov, vertical_fov;
  std::optional<double> aperture, focal_distance, eye_separation;
  std::optional<std::array<int, 2>> screen;
  std::optional<std::array<int, 4>> window;   ///< minx maxx miny maxy
  std::optional<std::array<double, 4>> crop;  ///< left right bottom top
  std::optional<int> samples;                 ///< per side
  std::optional<bool> jitter;
  std::optional<FilterKind> filter;
  std::optional<double> filter_width;
  std::optional<Color> contrast, cutoff;
  std::optional<int> max_depth;
  std::optional<Color> background;
  bool toggle_transparent_shadows = false;  ///< an odd number of `shadowtransp`
  std::optional<std::string> output;        ///< outfile
  bool verbose = false, quiet = false;
  std::optional<int> report_frequency;
  std::optional<std::string> report_file;
  std::optional<double> shutter, start_time, frame_length;
  std::optional<int> frames;
  std::optional<Color> ambient_light;
  std::optional<double> atmosphere_index;
  std::vector<AtmosphereEffect> effects;  ///< in the order written; applied last to first
  Location screen_location, window_location, samples_location;  ///< for messages after parsing
};

/// The same values given as options; they win over the scene.
struct SettingsOverrides {
  std::optional<std::array<int, 2>> screen;
  std::optional<std::array<int, 4>> window;
  std::optional<std::array<double, 4>> crop;
  std::optional<int> samples;
  std::optional<SamplingKind> sampling;
  std::optional<double> tolerance;
  std::optional<bool> jitter;
  std::optional<FilterKind> filter;
  std::optional<Color> contrast, cutoff;
  std::optional<int> max_depth;
  bool toggle_transparent_shadows = false;
  bool no_shadows = false;
  bool flip_normals = false;
  std::optional<double> eye_separation;
  Eye eye = Eye::kCenter;
  int first_frame = 0;
  std::optional<int> frames;
  std::uint64_t seed = 0;
};

/// Everything that determines the picture besides the objects, lights and files.
struct RenderSettings {
  Vec3 eye{0, -10, 0}, look{0, 0, 0}, up{0, 0, 1};
  double horizontal_fov = 45, vertical_fov = 45;
  double aperture = 0;
  std::optional<double> focal_distance;  ///< unset: the eye to look distance, after the stereo shift
  double eye_separation = 0;
  Eye stereo = Eye::kCenter;
  int width = 512, height = 512;                       ///< the screen
  int min_x = 0, max_x = 511, min_y = 0, max_y = 511;  ///< the window, inclusive, rows from the top
  int samples = 3;                                     ///< per side, 1..64
  SamplingKind sampling = SamplingKind::kOriginal;
  /// kSobol: the estimated standard error of a channel below which a pixel gets no more samples; 0: never.
  double tolerance = 0.01;
  bool jitter = true;  ///< kOriginal
  FilterKind filter = FilterKind::kBox;
  double filter_width = 1;
  Color contrast{0.2, 0.15, 0.3};
  Color cutoff{0.002, 0.002, 0.002};
  int max_depth = 5;
  Color background;
  bool shadows = true;
  bool transparent_shadows = true;
  bool flip_normals = false;
  double shutter = 0, start_time = 0, frame_length = 1;
  int first_frame = 0, frames = 1;
  Color ambient_light{1, 1, 1};
  double atmosphere_index = 1;
  std::vector<AtmosphereEffect> effects;
  std::uint64_t seed = 0;

  bool sobol() const { return sampling == SamplingKind::kSobol; }
  /// Columns and rows into which sample numbers divide lens, extended lights and gloss: 1 under kSobol,
  /// whose points are spread over the pixel by themselves.
  int strata() const { return sobol() ? 1 : samples; }
  double frame_start(int frame) const { return start_time + frame * frame_length; }
  int window_width() const { return max_x - min_x + 1; }
  int window_height() const { return max_y - min_y + 1; }
};

/// A combination of settings that cannot be rendered (window outside the screen, view along up, samples out
/// of range, absurd sizes, stereo without eye separation ...).
struct SettingsError : std::runtime_error {
  explicit SettingsError(const std::string& what, Location where = {})
      : std::runtime_error(what), location(where) {}
  Location location;
};

/// Merges and checks (language.md 4, 6.1, 8; shading.md 1). Throws SettingsError.
RenderSettings resolve_settings(const SceneSettings& scene, const SettingsOverrides& options);

}  // namespace rayshade
