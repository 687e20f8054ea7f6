// SPDX-License-Identifier: MIT
// The lattice sums behind noise3 and dnoise3, for the processor at hand. Both forms give the same bits: the
// vector form does the scalar operations lane by lane and adds the corners in the same order. Internal to the
// texture layer; tests hold the forms against each other.
#pragma once

#include "rayshade/math/vec.h"

namespace rayshade {

struct NoiseKernel {
  double (*value)(const Vec3& point);  ///< noise3
  Vec3 (*vector)(const Vec3& point);   ///< dnoise3
};

/// For any processor.
NoiseKernel scalar_noise_kernel();
/// The fastest that this processor has.
NoiseKernel best_noise_kernel();

namespace noise_detail {

/// With AVX2: four corners of the cell at once.
double noise3_avx2(const Vec3& point);
Vec3 dnoise3_avx2(const Vec3& point);
double noise3_scalar(const Vec3& point);
Vec3 dnoise3_scalar(const Vec3& point);

}  // namespace noise_detail
}  // namespace rayshade
