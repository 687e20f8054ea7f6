// SPDX-License-Identifier: MIT
// MurmurHash3 x64 128, written for any byte order.
#include "rayshade/scene/hash128.h"

#include <fmt/format.h>

#include <bit>
#include <cstddef>
#include <cstring>

namespace rayshade {
namespace {

constexpr std::uint64_t kFirst = 0x87c37b91114253d5u;
constexpr std::uint64_t kSecond = 0x4cf5ad432745937fu;

/// Up to eight bytes as a little-endian number, whatever the byte order of the machine.
std::uint64_t word(std::string_view bytes) {
  std::uint64_t out = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) out = out << 8 | static_cast<unsigned char>(bytes[i]);
  return out;
}

/// The same of exactly eight, which is what a long text mostly consists of.
std::uint64_t whole_word(const char* bytes) {
  std::uint64_t out = 0;
  std::memcpy(&out, bytes, sizeof out);
  if constexpr (std::endian::native == std::endian::big) out = word({bytes, sizeof out});
  return out;
}

std::uint64_t scrambled_first(std::uint64_t k) { return std::rotl(k * kFirst, 31) * kSecond; }
std::uint64_t scrambled_second(std::uint64_t k) { return std::rotl(k * kSecond, 33) * kFirst; }

std::uint64_t finished(std::uint64_t k) {
  k = (k ^ k >> 33) * 0xff51afd7ed558ccdu;
  k = (k ^ k >> 33) * 0xc4ceb9fe1a85ec53u;
  return k ^ k >> 33;
}

}  // namespace

Hash128 hash128(std::string_view bytes, std::uint32_t seed) {
  const std::size_t size = bytes.size();
  std::uint64_t a = seed, b = seed;
  for (; bytes.size() >= 16; bytes.remove_prefix(16)) {
    a ^= scrambled_first(whole_word(bytes.data()));
    a = (std::rotl(a, 27) + b) * 5 + 0x52dce729u;
    b ^= scrambled_second(whole_word(bytes.data() + 8));
    b = (std::rotl(b, 31) + a) * 5 + 0x38495ab5u;
  }
  if (bytes.size() > 8) b ^= scrambled_second(word(bytes.substr(8)));
  if (!bytes.empty()) a ^= scrambled_first(word(bytes.substr(0, 8)));
  a ^= size;
  b ^= size;
  a += b;
  b += a;
  a = finished(a);
  b = finished(b);
  a += b;
  b += a;
  return {a, b};
}

std::string Hash128::text() const { return fmt::format("{:016x}{:016x}", first, second); }

}  // namespace rayshade
