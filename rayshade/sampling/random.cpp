// SPDX-License-Identifier: MIT
// The only file that knows Random123.
#include "rayshade/sampling/random.h"

#include <Random123/philox.h>

namespace rayshade {
namespace {

r123::Philox4x32::ctr_type draw(const RandomKey& key, std::uint64_t dimension) {
  // For one frame the key is a bijection of the seed, and the counter holds pixel, sample and dimension in
  // full: two different addresses of a picture never share a block.
  const auto frame = static_cast<std::uint64_t>(static_cast<std::uint32_t>(key.frame));
  const std::uint64_t stream = mix64(key.seed ^ mix64(frame + 0x2545f4914f6cdd1du));
  const std::uint64_t place = std::uint64_t{key.x & 0xffffffu} << 40 |
                              std::uint64_t{key.y & 0xffffffu} << 16 | std::uint64_t{key.sample & 0xffffu};
  const r123::Philox4x32::ctr_type counter = {
      {static_cast<std::uint32_t>(place), static_cast<std::uint32_t>(place >> 32),
       static_cast<std::uint32_t>(dimension), static_cast<std::uint32_t>(dimension >> 32)}};
  const r123::Philox4x32::key_type keys = {
      {static_cast<std::uint32_t>(stream), static_cast<std::uint32_t>(stream >> 32)}};
  return r123::Philox4x32()(counter, keys);
}

double unit53(std::uint32_t high, std::uint32_t low) {
  return static_cast<double>((std::uint64_t{high} << 32 | low) >> 11) * 0x1p-53;
}

}  // namespace

double uniform(const RandomKey& key, std::uint64_t dimension) {
  const auto bits = draw(key, dimension);
  return unit53(bits[0], bits[1]);
}

std::array<double, 2> uniform2(const RandomKey& key, std::uint64_t dimension) {
  const auto bits = draw(key, dimension);
  return {unit53(bits[0], bits[1]), unit53(bits[2], bits[3])};
}

std::array<double, 4> uniform4(const RandomKey& key, std::uint64_t dimension) {
  const auto bits = draw(key, dimension);
  return {bits[0] * 0x1p-32, bits[1] * 0x1p-32, bits[2] * 0x1p-32, bits[3] * 0x1p-32};
}

std::array<std::uint32_t, 4> philox_block(const std::array<std::uint32_t, 4>& counter,
                                          const std::array<std::uint32_t, 2>& key) {
  const auto out = r123::Philox4x32()({{counter[0], counter[1], counter[2], counter[3]}}, {{key[0], key[1]}});
  return {out[0], out[1], out[2], out[3]};
}

}  // namespace rayshade
