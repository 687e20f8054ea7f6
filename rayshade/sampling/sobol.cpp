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

double fraction(std::uint32_t reversed_bits) { return reversed(reversed_bits) * 0x1p-32; }

/// Where a sample stands in the order of a sequence, and what scrambles its digits.
struct Sequence {
  std::uint64_t keys;
  std::uint32_t place;
  Sequence(std::uint64_t stream, std::uint64_t dimension, std::uint32_t index) {
    const std::uint64_t order = mix64(stream ^ dimension);
    keys = mix64(order + 0x9e3779b97f4a7c15u);
    place = owen_scramble(index, static_cast<std::uint32_t>(order >> 32));
  }
  double first() const { return fraction(permuted(place, static_cast<std::uint32_t>(keys))); }
  double second() const {
    return fraction(permuted(second_reversed(place), static_cast<std::uint32_t>(keys >> 32)));
  }
};

constexpr int kFurther = 3, kIndexBits = 16, kByte = 256;

/// What each value of the low and of the high byte of an index contributes to the further dimensions,
/// reversed.
struct FurtherDimensions {
  std::uint32_t of_byte[kFurther][2][kByte];
};

constexpr FurtherDimensions further_dimensions() {
  // Degree, coefficients and first direction numbers of the primitive polynomials.
  struct Polynomial {
    int degree;
    std::uint32_t inner;
    std::uint32_t first[3];
  };
  constexpr Polynomial kPolynomials[kFurther] = {{2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}, {3, 2, {1, 1, 1}}};
  FurtherDimensions out{};
  for (int dimension = 0; dimension < kFurther; ++dimension) {
    const Polynomial& p = kPolynomials[dimension];
    std::uint32_t direction[kIndexBits] = {};
    for (int i = 0; i < kIndexBits; ++i) {
      if (i < p.degree) {
        direction[i] = p.first[i] << (31 - i);
        continue;
      }
      direction[i] = direction[i - p.degree] ^ direction[i - p.degree] >> p.degree;
      for (int k = 1; k < p.degree; ++k)
        if ((p.inner >> (p.degree - 1 - k) & 1) != 0) direction[i] ^= direction[i - k];
    }
    for (int half = 0; half < 2; ++half)
      for (int value = 0; value < kByte; ++value)
        for (int bit = 0; bit < 8; ++bit)
          if ((value >> bit & 1) != 0)
            out.of_byte[dimension][half][value] ^= reversed(direction[8 * half + bit]);
  }
  return out;
}

constexpr FurtherDimensions kFurtherDimensions = further_dimensions();

std::uint32_t further_reversed(int dimension, std::uint32_t index) {
  const auto& table = kFurtherDimensions.of_byte[dimension];
  return table[0][index % kByte] ^ table[1][index / kByte % kByte];
}

}  // namespace

std::uint64_t pixel_stream(std::uint64_t seed, int frame, std::uint32_t x, std::uint32_t y) {
  const auto number = static_cast<std::uint64_t>(static_cast<std::uint32_t>(frame));
  return mix64(mix64(seed ^ mix64(number + 0x8cb92ba72f3d8dd7u)) + (std::uint64_t{x} << 32 | y));
}

std::array<std::uint32_t, 2> sobol_bits(std::uint32_t index) {
  return {reversed(index), reversed(second_reversed(index))};
}

std::array<std::uint32_t, 3> sobol_bits_further(std::uint32_t index) {
  return {reversed(further_reversed(0, index)), reversed(further_reversed(1, index)),
          reversed(further_reversed(2, index))};
}

std::uint32_t owen_scramble(std::uint32_t bits, std::uint32_t key) {
  return reversed(permuted(reversed(bits), key));
}

std::array<double, 2> sobol2(std::uint64_t stream, std::uint64_t dimension, std::uint32_t index) {
  const Sequence sequence(stream, dimension, index);
  return {sequence.first(), sequence.second()};
}

std::array<double, 5> sobol5(std::uint64_t stream, std::uint64_t dimension, std::uint32_t index) {
  const Sequence sequence(stream, dimension, index);
  // Higher digits of the shuffled index would do nothing but scramble what is scrambled anyway.
  std::array<double, 5> out{sequence.first(), sequence.second()};
  std::uint64_t keys = mix64(sequence.keys);
  for (int i = 0; i < kFurther; ++i) {
    const std::uint32_t bits =
        permuted(further_reversed(i, sequence.place), static_cast<std::uint32_t>(keys));
    out.at(2 + static_cast<std::size_t>(i)) = fraction(bits);
    keys = i == 0 ? keys >> 32 : mix64(keys);
  }
  return out;
}

}  // namespace rayshade
