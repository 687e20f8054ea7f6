// SPDX-License-Identifier: MIT
// Lattice noise and its sums (textures.md 2), bit for bit those of the original: functions of the point
// alone, with the order of every sum as specified. Periodic with period 4096 in each axis. A coordinate that
// is not finite gives NaN; nothing here is undefined for any input. Used by the textures and by the fogdeck
// atmosphere.
#pragma once

#include "rayshade/math/vec.h"

namespace rayshade {

/// More octaves than this are not summed: their share is far below rounding, and a huge count must not hang.
inline constexpr int kMaxOctaves = 1000;

/// Value-plus-gradient noise, about -1.16 to 1.15, mean about 0.
double noise3(const Vec3& point);
/// Three decorrelated noises; the first is noise3 up to the last bit. Not a derivative, not normalised.
Vec3 dnoise3(const Vec3& point);

/// Sum over i < octaves of 2^-i noise3(2^i point). Fewer than one octave gives 0, here and below.
double chaos(const Vec3& point, int octaves);
/// The same of the magnitude of each noise (fogdeck, shading.md 6).
double abs_chaos(const Vec3& point, int octaves);
/// Sum of omega^i noise3(lambda^i point): fractional Brownian motion.
double fbm(const Vec3& point, double omega, double lambda, int octaves);
/// The same of dnoise3; ends after the term for which omega^(i+1) < kEpsilon.
Vec3 vfbm(const Vec3& point, double omega, double lambda, int octaves);
/// Veins, 0 to 1.
double marble(const Vec3& point);

/// omega of fbm for the H and lambda of a scene: lambda^(-(1 + 2H) / 2).
double fbm_omega(double h, double lambda);

/// The constants of the windy texture (textures.md 3.12), except its strength.
struct WindyParameters {
  double wind_scale = 0, chaos_scale = 0, bump_scale = 0;  ///< wscale, cscale, bscale
  double frequency_scale = 0, height_scale = 0;            ///< tscale, hscale
  double offset = 0;
  int octaves = 0;
};
/// The bump vector b of the windy texture, not yet multiplied by its strength.
Vec3 windy_bump(const Vec3& point, const WindyParameters& parameters);

}  // namespace rayshade
