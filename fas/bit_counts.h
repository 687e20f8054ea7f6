// SPDX-License-Identifier: MIT
// A counter for each of 64 rays, added to by masks of rays.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace fas {

/// Bit i of plane k is bit k of the count of ray i, so that a mask is added in a step or two.
class BitCounts {
 public:
  static constexpr std::size_t kPlanes = 32;

  void clear() { used_ = 0; }
  /// One more for every ray of the mask.
  void add(std::uint64_t mask) {
    for (std::size_t k = 0; mask != 0 && k < kPlanes; ++k) {
      if (k == used_) planes_[used_++] = 0;
      const std::uint64_t carry = planes_[k] & mask;
      planes_[k] ^= mask;
      mask = carry;
    }
  }
  std::uint32_t of(std::size_t ray) const {
    std::uint64_t count = 0;
    for (std::size_t k = used_; k-- > 0;) count = 2 * count + (planes_[k] >> ray & 1);
    return static_cast<std::uint32_t>(count);
  }
  /// Adds all counts to those of `to`.
  void add_to(std::array<std::uint32_t, 64>& to) const {
    if (used_ > 8) {
      for (std::size_t ray = 0; ray < 64; ++ray) to[ray] += of(ray);
      return;
    }
    for (std::size_t first = 0; first < 64; first += 8) {
      std::uint64_t bytes = 0;  // eight counts
      for (std::size_t k = 0; k < used_; ++k) bytes += spread(planes_[k] >> first & 0xff) << k;
      for (std::size_t i = 0; i < 8; ++i) to[first + i] += static_cast<std::uint32_t>(bytes >> 8 * i & 0xff);
    }
  }
  /// The sum of all counts.
  std::uint64_t total() const {
    std::uint64_t sum = 0;
    for (std::size_t k = 0; k < used_; ++k) sum += static_cast<std::uint64_t>(std::popcount(planes_[k])) << k;
    return sum;
  }

 private:
  /// Bit i goes to the lowest bit of byte i.
  static std::uint64_t spread(std::uint64_t bits) {
    const std::uint64_t seven = (bits & 0x7f) * 0x02'0408'1020'4081 & 0x0101'0101'0101'0101;
    return seven | (bits >> 7 << 56);
  }

  std::array<std::uint64_t, kPlanes> planes_;  // NOLINT: only the first `used_` are meaningful
  std::size_t used_ = 0;
};

}  // namespace fas
