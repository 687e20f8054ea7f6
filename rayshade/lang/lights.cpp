// SPDX-License-Identifier: MIT
// See lights.h.
#include "rayshade/lang/lights.h"

#include <fmt/format.h>

#include <utility>

namespace rayshade::lang {

void Lights::point(const Vec3& position) {
  work_.kind = LightKind::kPoint;
  work_.position = position;
}

void Lights::directional(const Vec3& direction, const Span& span) {
  work_.kind = LightKind::kDirectional;
  work_.position = direction;
  if (max_abs(direction) == 0)
    context_.messages.error(span, "a directional light needs a direction other than 0 0 0");
}

void Lights::extended(double radius, const Vec3& center) {
  work_.kind = LightKind::kExtended;
  work_.radius = radius;
  work_.position = center;
}

void Lights::spot(const Vec3& from, const Vec3& to, double exponent, const Span& span) {
  work_.kind = LightKind::kSpot;
  work_.position = from;
  work_.target = to;
  work_.exponent = exponent;
  if (degenerate(length(to - from)))
    context_.messages.error(span, "a spot light must not point at its own position");
}

void Lights::spot(const Vec3& from, const Vec3& to, double exponent, double inner, double outer,
                  const Span& span) {
  spot(from, to, exponent, span);
  work_.inner = inner;
  work_.outer = outer;
  if (inner > outer) {
    context_.messages.error(
        span,
        fmt::format("the inner angle of a spot light ({}) must not exceed the outer one ({})", inner, outer));
  }
}

void Lights::area(const Vec3& corner, const Vec3& u_end, int u_samples, const Vec3& v_end, int v_samples,
                  const Span& span) {
  work_.kind = LightKind::kArea;
  work_.position = corner;
  work_.u_end = u_end;
  work_.v_end = v_end;
  work_.u_samples = u_samples;
  work_.v_samples = v_samples;
  if (u_samples < 1 || v_samples < 1) {
    context_.messages.error(span, "an area light needs at least one sample along each edge");
  } else if (static_cast<double>(u_samples) * v_samples > kMostAreaSamples) {
    context_.messages.error(span, fmt::format("an area light can have at most {} samples", kMostAreaSamples));
  }
  if (degenerate(length(u_end - corner)) || degenerate(length(v_end - corner))) {
    context_.messages.error(span,
                            "an edge of this area light has no length (its ends are points, not vectors)");
  }
}

void Lights::finish(const Color& intensity, const Span& span) {
  work_.intensity = intensity;
  work_.location = context_.sources.locate(span);
  context_.scene.lights.push_back(std::exchange(work_, Light()));
}

}  // namespace rayshade::lang
