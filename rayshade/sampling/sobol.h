// SPDX-License-Identifier: MIT
// Scrambled low-discrepancy points: the first two dimensions of Sobol's sequence (I. M. Sobol', 1967), each
// digit permuted as the digits before it say (A. B. Owen, "Randomly permuted (t,m,s)-nets and
// (t,s)-sequences", 1995), the permutations being hashes (B. Burley, "Practical hash-based Owen scrambling",
// JCGT 9(4), 2020, with the hash of N. Vegdahl).
//
// Every purpose of a pixel has a sequence of its own, visited in an order of its own, shuffled so that each
// aligned run of 2^k samples remains a (0, k, 2)-net: one point in each of 2^k boxes of equal area, whatever
// their proportions. Between purposes and between pixels there is no relation, so that their errors do not
// add up.
#pragma once

#include <array>
#include <cstdint>

#include "rayshade/sampling/random.h"

namespace rayshade {

/// The sequences of one pixel: a hash of seed, frame and pixel.
std::uint64_t pixel_stream(std::uint64_t seed, int frame, std::uint32_t x, std::uint32_t y);

/// Point number `index` of Sobol's first two dimensions, unscrambled, as fractions of 2^32.
std::array<std::uint32_t, 2> sobol_bits(std::uint32_t index);

/// Permutes the digits of the fraction `bits` / 2^32, each as the more significant ones and `key` say.
std::uint32_t owen_scramble(std::uint32_t bits, std::uint32_t key);

/// Point number `index` of the sequence for `dimension` (random.h): uniform in [0, 1)^2, multiples of 2^-32.
std::array<double, 2> sobol2(std::uint64_t stream, std::uint64_t dimension, std::uint32_t index);

}  // namespace rayshade
