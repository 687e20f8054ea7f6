// SPDX-License-Identifier: MIT
// Viewing and rendering items and the atmosphere (language.md 3.4, 3.10), with the rules of section 4 about
// who wins and about -1 as "unset".
#pragma once

#include "rayshade/lang/context.h"
#include "rayshade/lang/semantic.h"

namespace rayshade::lang {

/// Samples per side that a scene may ask for.
inline constexpr int kMostSamples = 64;
/// Octaves of noise: more of them change nothing that doubles can show, but take forever.
inline constexpr int kMostOctaves = 1000;

/// An octave count as it is used: negative ones are none (textures.md D15), absurd ones are reported.
int checked_octaves(Context& context, int octaves, const Span& span);

class Settings {
 public:
  explicit Settings(Context& context) : context_(context), out_(context.scene.settings) {}

  /// `alone`: no transforms follow.
  void eye(const Vec3& position, const Span& transforms, bool alone);
  void look(const Vec3& point) { out_.look = point; }
  void up(const Vec3& direction) { out_.up = direction; }
  void fov(double horizontal);
  void fov(double horizontal, double vertical);
  void aperture(double half_side) { out_.aperture = half_side; }
  void focal_distance(double distance);
  void eye_separation(double distance);
  void screen(int width, int height, const Span& span);
  void window(int min_x, int max_x, int min_y, int max_y, const Span& span);
  void crop(double left, double right, double bottom, double top);
  void samples(int per_side, const Span& span);
  void samples(int per_side, bool jitter, const Span& span);
  void filter(FilterKind kind) { out_.filter = kind; }
  void filter_width(double width);
  void contrast(const Color& limit);
  void cutoff(const Color& limit);
  void max_depth(int depth);
  void background(const Color& color) { out_.background = color; }
  void toggle_transparent_shadows() { out_.toggle_transparent_shadows = !out_.toggle_transparent_shadows; }
  void outfile(Name name, const Span& span);
  void verbose() { out_.verbose = true; }
  void quiet() { out_.quiet = true; }
  void report_frequency(int lines);
  void report_file(Name name);
  void shutter(double seconds) { out_.shutter = seconds; }
  void frames(int count);
  void start_time(double time) { out_.start_time = time; }
  void frame_length(double time) { out_.frame_length = time; }

  void atmosphere() { out_.effects.clear(); }
  void atmosphere(double index, const Span& span);
  void fog(const Color& color, const Color& thickness);
  void mist(const Color& color, const Color& thickness, double zero, double scale);
  void fogdeck(double altitude, double offset, const Vec3& scale, double chaos_scale, int octaves,
               const Color& color, const Color& thickness, const Span& octaves_span);

 private:
  Context& context_;
  SceneSettings& out_;
};

}  // namespace rayshade::lang
