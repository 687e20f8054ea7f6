// SPDX-License-Identifier: MIT
// A 128-bit name for bytes: MurmurHash3 x64 128 (A. Appleby). Well mixed and fast; no protection against
// forgery, which nothing here needs.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rayshade {

struct Hash128 {
  std::uint64_t first = 0, second = 0;
  bool operator==(const Hash128&) const = default;
  /// 32 hexadecimal digits.
  std::string text() const;
};

Hash128 hash128(std::string_view bytes, std::uint32_t seed = 0);

}  // namespace rayshade
