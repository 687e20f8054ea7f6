// SPDX-License-Identifier: MIT
// Fog, mist and fog decks (shading.md 6).
#pragma once

#include <vector>

#include "rayshade/geometry/ray.h"
#include "rayshade/scene/settings.h"

namespace rayshade {

/// att(x, T) of shading.md 6 for one channel: the share of light left after length x, T the half distance.
double attenuation(double length, double thickness);

/// The colour of a ray after the effects, applied last to first. `distance` is kFar for a ray that hits
/// nothing; `end` is its end point.
Color apply_atmosphere(const std::vector<AtmosphereEffect>& effects, const Color& color, const Ray& ray,
                       double distance, const Vec3& end);

}  // namespace rayshade
