// SPDX-License-Identifier: MIT
// In reversed bits, in which the hash permutes each bit as the lower ones say.
#include "rayshade/sampling/sobol.h"

namespace rayshade {
namespace {

constexpr std::uint32_t reversed(std::uint32_t v) {
  v = (v & 0x55555555u) << 1 | (v >> 1 & 0x55555555u);
  v = (v & 0x33333333u) << 2 | (v >> 2 & 0x33333333u);
  v = (v & 0x0f0f0f0fu) << 4 | (v >> 4 & 0x0f0f0f0fu);
  v = (v & 0x00ff00ffu) << 8 | (v >> 8 & 0x00ff00ffu);
  return v << 16 | v >> 16;
}

/// Adds, subtracts and multiplies by odd numbers only: what happens to a bit depends on lower bits alone.
constexpr std::uint32_t permuted(std::uint32_t v, std::uint32_t key) {
  v ^= v * 0x3d20adeau;
  v += key;
  v *= key >> 16 | 1u;
  v ^= v * 0x05526c56u;
  v ^= v * 0x53a22864u;
  return v;
}

/// The second dimension, reversed: the index times Pascal's triangle modulo 2, which is the product of these
/// steps.
constexpr std::uint32_t second_reversed(std::uint32_t v) {
  v ^= v >> 1 & 0x55555555u;
  v ^= v >> 2 & 0x33333333u;
  v ^= v >> 4 & 0x0f0f0f0fu;
  v ^= v >> 8 & 0x00ff00ffu;
  return v ^ v >> 16;
}

}  // namespace

std::uint64_t pixel_stream(std::uint64_t seed, int frame, std::uint32_t x, std::uint32_t y) {
  const auto number = static_cast<std::uint64_t>(static_cast<std::uint32_t>(frame));
  return mix64(mix64(seed ^ mix64(number + 0x8cb92ba72f3d8dd7u)) + (std::uint64_t{x} << 32 | y));
}

std::array<std::uint32_t, 2> sobol_bits(std::uint32_t index) {
  return {reversed(index), reversed(second_reversed(index))};
}

std::uint32_t owen_scramble(std::uint32_t bits, std::uint32_t key) {
  return reversed(permuted(reversed(bits), key));
}

std::array<double, 2> sobol2(std::uint64_t stream, std::uint64_t dimension, std::uint32_t index) {
  const std::uint64_t order = mix64(stream ^ dimension), digits = mix64(order + 0x9e3779b97f4a7c15u);
  const std::uint32_t place = owen_scramble(index, static_cast<std::uint32_t>(order >> 32));
  const std::uint32_t u = permuted(place, static_cast<std::uint32_t>(digits));
  const std::uint32_t v = permuted(second_reversed(place), static_cast<std::uint32_t>(digits >> 32));
  return {reversed(u) * 0x1p-32, reversed(v) * 0x1p-32};
}

}  // namespace rayshade
