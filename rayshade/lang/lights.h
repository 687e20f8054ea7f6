// SPDX-License-Identifier: MIT
// Lights (language.md 3.5, shading.md 4).
#pragma once

#include "rayshade/lang/context.h"

namespace rayshade::lang {

/// Sub-lights that one area light may have.
inline constexpr double kMostAreaSamples = 1e6;

class Lights {
 public:
  explicit Lights(Context& context) : context_(context) {}

  void ambient(const Color& intensity) { context_.scene.settings.ambient_light = intensity; }
  void point(const Vec3& position);
  void directional(const Vec3& direction, const Span& span);
  void extended(double radius, const Vec3& center);
  void spot(const Vec3& from, const Vec3& to, double exponent, const Span& span);
  void spot(const Vec3& from, const Vec3& to, double exponent, double inner, double outer, const Span& span);
  /// In the order of the statement: corner, end of the u edge, its samples, end of the v edge, its samples.
  void area(const Vec3& corner, const Vec3& u_end, int u_samples, const Vec3& v_end, int v_samples,
            const Span& span);
  void no_shadow() { work_.no_shadow = true; }
  void finish(const Color& intensity, const Span& span);
  /// Drops unfinished work, after a mistake.
  void recover() { work_ = Light(); }

 private:
  Context& context_;
  Light work_;
};

}  // namespace rayshade::lang
