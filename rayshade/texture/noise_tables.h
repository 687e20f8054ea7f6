// SPDX-License-Identifier: MIT
// The two tables of the noise (textures.md 2.1), computed by the compiler: a shuffle of 0..4095 by the 48-bit
// linear congruential generator, and CRC-16 sums read as numbers. Pictures depend on every entry; a test
// compares them with check sums. Internal to the texture layer.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <utility>

namespace rayshade::noise_tables {

inline constexpr int kPermutationSize = 4096;
inline constexpr int kGradientSize =
    267;  // hashes are below 256, and up to 12 numbers are read from there on

constexpr std::array<std::uint16_t, kPermutationSize> make_permutation() {
  std::array<std::uint16_t, kPermutationSize> p{};
  for (int i = 0; i < kPermutationSize; ++i) p[i] = static_cast<std::uint16_t>(i);
  std::uint64_t state = (std::uint64_t{1} << 16) + 0x330E;
  for (int i = kPermutationSize - 1; i >= 1; --i) {
    state = (state * 0x5DEECE66Du + 0xBu) & ((std::uint64_t{1} << 48) - 1);
    std::swap(p[i], p[state >> 36]);  // any of the 4096, not only those below i: the original's shuffle
  }
  return p;
}

/// CRC-16/ARC of the little-endian bytes of a double, three times over.
constexpr std::uint16_t checksum(double value) {
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(value);
  std::uint16_t crc = 0;
  for (int byte = 0; byte < 24; ++byte) {
    crc = static_cast<std::uint16_t>(crc ^ ((bits >> (8 * (byte % 8))) & 0xFF));
    for (int bit = 0; bit < 8; ++bit) {
      crc = static_cast<std::uint16_t>((crc & 1) ? (crc >> 1) ^ 0xA001 : crc >> 1);
    }
  }
  return crc;
}

constexpr std::array<double, kGradientSize> make_gradients() {
  std::array<double, kGradientSize> r{};
  for (int i = 0; i < kGradientSize; ++i) r[i] = checksum(i * 0.12345) * 2.0 / 65536 - 1;
  return r;
}

/// The last of the three look-ups needs only eight bits.
constexpr std::array<std::uint8_t, kPermutationSize> make_low_bytes() {
  const auto p = make_permutation();
  std::array<std::uint8_t, kPermutationSize> low{};
  for (int i = 0; i < kPermutationSize; ++i) low[i] = static_cast<std::uint8_t>(p[i] & 255);
  return low;
}

inline constexpr auto kPermutation = make_permutation();
inline constexpr auto kLowBytes = make_low_bytes();
inline constexpr auto kGradients = make_gradients();

}  // namespace rayshade::noise_tables
