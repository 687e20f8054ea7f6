// SPDX-License-Identifier: MIT
// Random numbers as functions (rule 3): each is a hash of where it is needed, so that threads, blocks, ranks
// and skipped rays cannot change it. The hash is Philox4x32-10 (Salmon, Moraes, Dror, Shaw, "Parallel random
// numbers: as easy as 1, 2, 3", SC 2011): the seed and the frame make its key; pixel, sample and dimension
// make its counter.
//
// A dimension is an address too (rule 6): the path of the ray through its tree, the purpose of the number,
// and which light (or texture) it is for. Two calls with equal arguments give equal numbers.
#pragma once

#include <array>
#include <cstdint>

namespace rayshade {

/// What a random number is for.
enum class Purpose : std::uint8_t {
  kSampleChoice,  ///< which sample a pixel gets that is not fully sampled
  kPixel,         ///< place within the cell: U, V
  kTime,          ///< moment within the time slice
  kLens,          ///< place within the lens cell: p, q
  kLight,         ///< place on light number `which`
  kGloss,         ///< gloss texture number `which` on the way outward
};

/// Bijective mixing of 64 bits: every input bit changes each output bit with probability one half. (The
/// finaliser "Mix13" of D. Stafford, as in SplitMix64.)
constexpr std::uint64_t mix64(std::uint64_t v) {
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9u;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebu;
  return v ^ (v >> 31);
}

/// The path of every eye ray.
inline constexpr std::uint64_t kRootPath = 0;

/// The path of the secondary ray number `which` that leaves the end of the ray with the path `path`.
constexpr std::uint64_t child_path(std::uint64_t path, std::uint64_t which) {
  return mix64(mix64(path + 0x9e3779b97f4a7c15u) + which);
}

/// The dimension of a number: for one path, different purposes and lights have different dimensions.
constexpr std::uint64_t dimension(std::uint64_t path, Purpose purpose, std::uint64_t which = 0) {
  return mix64(path ^ mix64((which << 8 | static_cast<std::uint64_t>(purpose)) + 0xd1b54a32d192ed03u));
}

/// The sample that numbers are for. `x` and `y` are screen coordinates, `sample` is the index within the
/// pixel (0 to 4,095); coordinates count modulo 2^24, samples modulo 2^16.
struct RandomKey {
  std::uint64_t seed = 0;
  int frame = 0;
  std::uint32_t x = 0, y = 0;
  std::uint32_t sample = 0;
};

/// One number, uniform in [0, 1), a multiple of 2^-53.
double uniform(const RandomKey& key, std::uint64_t dimension);
/// Two independent numbers for the price of one; the first is uniform(key, dimension).
std::array<double, 2> uniform2(const RandomKey& key, std::uint64_t dimension);
/// Four independent numbers for the price of one, multiples of 2^-32.
std::array<double, 4> uniform4(const RandomKey& key, std::uint64_t dimension);

/// Philox4x32-10 itself.
std::array<std::uint32_t, 4> philox_block(const std::array<std::uint32_t, 4>& counter,
                                          const std::array<std::uint32_t, 2>& key);

}  // namespace rayshade
