// SPDX-License-Identifier: MIT
// The procedural textures as functions of numbers (textures.md 3): no scene, no surface record, so that each
// can be checked against its formula. `q` is the point in texture space.
#pragma once

#include <array>

#include "rayshade/math/vec.h"
#include "rayshade/texture/noise.h"

namespace rayshade {

/// Which of the two surfaces a checker shows: true for the second. Integers <= 0 belong to the cell below
/// them.
bool checker_is_odd(const Vec3& q);

/// Share of the second surface of a blotch; 0 where there is none. May slightly exceed 1.
double blotch_share(const Vec3& q, double mix);

/// fBm and the numbers that it needs.
struct FbmParameters {
  double omega = 0.5, lambda = 2;
  int octaves = 0;
  double at(const Vec3& q) const { return fbm(q, omega, lambda, octaves); }
};

/// The value that fbm multiplies the colours by; not limited.
double fbm_value(const Vec3& q, const FbmParameters& parameters, double offset, double scale,
                 double threshold);

Color wood_color(const Vec3& q);

/// The normal of gloss for a, b in [0, 1), stratified by the number of the sample within its pixel where that
/// is known (sample_number >= 0).
Vec3 gloss_normal(const Vec3& n, double glossiness, const std::array<double, 2>& draws, int sample_number,
                  int samples_per_side);

/// How opaque the sky is, 0 to 1.
double sky_intensity(const Vec3& q, const FbmParameters& parameters, double exponent, double opaque_threshold,
                     double transparent_threshold);

struct CloudParameters {
  FbmParameters fbm;
  double h = 0;
  double scale = 0;
  double threshold = 0, limb_threshold = 0;  ///< cthresh, lthresh
  double transparency_scale = 0;             ///< tscale
};
struct CloudValue {
  double transparency = 1, diffuse = 0, ambient = 0;  ///< transparency is set, the others are factors
};
/// Clouds on a unit sphere seen along a ray of unit direction from `origin`; nothing is seen from within the
/// sphere.
CloudValue cloud_value(const Vec3& q, const Vec3& origin, const Vec3& direction,
                       const CloudParameters& parameters);

enum class StripePart { kField, kBand, kBevel };
struct StripeValue {
  StripePart part = StripePart::kField;
  double fu = 0, fv = 0;  ///< slopes of a bevel
};
/// Where (u, v) lies in the unit square of a stripe: on its band, on its bevel or in the untouched field.
StripeValue stripe_value(double u, double v, double width, double bump);

/// Index into the colour map of mount: height, bent by turbulence, less where the surface is steep.
int mount_index(const Vec3& q, double turbulence, double slope, double normal_z);

/// Index into the colour map of marble and fbm.
int color_index(double value);

}  // namespace rayshade
