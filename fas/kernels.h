// SPDX-License-Identifier: MIT
// The vector code of the hyper-trees, compiled for several instruction sets and chosen once by the processor
// at hand, so that one binary serves unlike machines. Integers only: every target and the scalar twins give
// the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

namespace fas {

/// Candidates of a leaf stand in blocks of at most 64, sorted by depth. With s = stride(n), a block is,
/// without gaps:
///
///   u8  u_lo[s] u_hi[s] v_lo[s] v_hi[s] z_lo[s]        the area in 256ths of the cell, and the nearest depth
///   s8  a0[s] b0[s] a1[s] b1[s] a2[s] b2[s]            only in leaves with cuts: half-planes
///   s16 c0[s] c1[s] c2[s]                                a (u - 128) + b (v - 128) + c >= 0
///   u32 id[s]
///
/// Places beyond n match nothing. Kernels read up to kPadding bytes beyond a block.
struct Block {
  static constexpr int kMost = 64;
  static constexpr std::size_t kPadding = 64;
  static constexpr std::size_t kAreaBytes = 5, kCutBytes = 12, kIdBytes = 4;
  static constexpr std::size_t stride(std::size_t n) { return (n + 7) & ~std::size_t{7}; }
  static constexpr std::size_t bytes(std::size_t n, bool cuts) {
    return stride(n) * (kAreaBytes + kIdBytes + (cuts ? kCutBytes : 0));
  }
  /// From the start of a block to where kernels may read: whole vectors of depths, or of the last offsets,
  /// are beyond the end of a block of eight.
  static constexpr std::size_t readable(std::size_t n, bool cuts) {
    const std::size_t last = stride(n) * (cuts ? kAreaBytes + 10 : kAreaBytes - 1) + kPadding;
    return last > bytes(n, cuts) ? last : bytes(n, cuts);
  }
};

/// Where a ray meets the plane of a leaf, in 256ths of its cell, and the depth it may reach.
struct Probe {
  std::uint8_t u = 0, v = 0, z = 255;
};

struct Kernels {
  /// Bit i: the area of candidate i of the block holds the probe (and, with cuts, it is within the
  /// half-planes).
  std::uint64_t (*match)(const std::uint8_t* block, int n, bool cuts, Probe probe);
  /// Candidate `i` of a block of stride `s` against `count` probes: bit k where it matches probe k. The
  /// arrays of probes have 64 places, of which those beyond `count` may hold anything.
  std::uint64_t (*match_rays)(const std::uint8_t* block, std::size_t s, std::size_t i, bool cuts,
                              const std::uint8_t* u, const std::uint8_t* v, const std::uint8_t* z, int count);
  const char* name;
};

/// Those for this processor.
const Kernels& kernels();
/// Those for the target that calls go to at present (dispatch.h), so that tests can go through all of them.
Kernels dispatched_kernels();
/// Plain C++, the twin that the others are tested against.
const Kernels& scalar_kernels();

}  // namespace fas
