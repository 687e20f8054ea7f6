// SPDX-License-Identifier: MIT
// A counter for each of 64 rays, added to by masks of rays.
#pragma once

#include <array>
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

 private:
  std::array<std::uint64_t, kPlanes> planes_;  // NOLINT: only the first `used_` are meaningful
  std::size_t used_ = 0;
};

}  // namespace fas
