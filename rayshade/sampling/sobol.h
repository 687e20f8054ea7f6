// SPDX-License-Identifier: MIT
// Scrambled low-discrepancy points: the first dimensions of Sobol's sequence (I. M. Sobol', 1967), each
// digit permuted as the digits before it say (A. B. Owen, "Randomly permuted (t,m,s)-nets and
// (t,s)-sequences", 1995), the permutations being hashes (B. Burley, "Practical hash-based Owen scrambling",
// JCGT 9(4), 2020, with the hash of N. Vegdahl).
//
// Every purpose of a pixel has a sequence of its own, visited in an order of its own, shuffled so that each
// aligned run of 2^k samples remains a (0, k, 2)-net: one point in each of 2^k boxes of equal area, whatever
// their proportions. Between purposes and between pixels there is no relation, so that their errors do not
// add up. But what an eye ray needs, place in the pixel, place on the lens and moment, comes from the five
// dimensions of one sequence: an edge that moves, or is out of focus, crosses them all, and is resolved as
// well as they are stratified together.
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

/// The third to fifth dimensions, for an index below 2^16 (direction numbers of S. Joe and F. Y. Kuo,
/// "Constructing Sobol sequences with better two-dimensional projections", SIAM J. Sci. Comput. 30, 2008).
std::array<std::uint32_t, 3> sobol_bits_further(std::uint32_t index);

/// Point number `index`, below 2^16, of the sequence of eye rays of a pixel: the first two are what sobol2
/// would give, and all five are stratified together.
std::array<double, 5> sobol5(std::uint64_t stream, std::uint64_t dimension, std::uint32_t index);

/// Point number `index` of the sequence for `dimension` (random.h): uniform in [0, 1)^2, multiples of 2^-32.
std::array<double, 2> sobol2(std::uint64_t stream, std::uint64_t dimension, std::uint32_t index);

}  // namespace rayshade
