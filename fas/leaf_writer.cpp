// SPDX-License-Identifier: MIT
#include "fas/leaf_writer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

namespace fas {
namespace {

std::uint8_t to_byte(double x) { return static_cast<std::uint8_t>(x < 0 ? 0 : x > 255 ? 255 : x); }

/// The half-planes of a candidate, for coordinates q - 128 in 256ths of the cell. The larger factor becomes
/// 127; what rounding the factors may change within the cell, and the extent of one 256th, goes into the
/// offset.
void quantise_cuts(const Area& area, const Part& part, std::int8_t (&ab)[6], std::int16_t (&c)[3]) {
  for (int k = 0; k < 3; ++k) {
    ab[2 * k] = ab[2 * k + 1] = 0;
    c[k] = std::numeric_limits<std::int16_t>::max();
    if (k >= area.cuts) continue;
    const double step = part.size / 256;
    double a = area.cut[k][0] * step, b = area.cut[k][1] * step;
    const double offset = area.cut[k][2] + area.cut[k][0] * part.x + area.cut[k][1] * part.y;
    const double rounding = 0x1p-46 * (std::fabs(area.cut[k][2]) + std::fabs(area.cut[k][0] * part.x) +
                                       std::fabs(area.cut[k][1] * part.y));
    const double largest = std::max(std::fabs(a), std::fabs(b));
    if (!(largest > 0)) continue;
    const double factor = 127 / largest;
    a *= factor;
    b *= factor;
    const double ra = std::nearbyint(a), rb = std::nearbyint(b);
    const double most = (offset + rounding) * factor + 128 * (a + b) + std::max(a, 0.0) + std::max(b, 0.0) +
                        128.5 * (std::fabs(a - ra) + std::fabs(b - rb)) + 1;
    if (!(most < 32767)) continue;
    ab[2 * k] = static_cast<std::int8_t>(ra);
    ab[2 * k + 1] = static_cast<std::int8_t>(rb);
    c[k] = static_cast<std::int16_t>(std::max(-32768.0, std::ceil(most)));
  }
}

}  // namespace

std::size_t leaf_bytes(std::uint32_t candidates, bool cuts) {
  std::size_t bytes = sizeof(Leaf);
  for (std::uint32_t left = candidates; left > 0;) {
    const std::uint32_t size = std::min<std::uint32_t>(left, Block::kMost);
    left -= size;
    // Not even what does not matter may be read while another thread writes it.
    bytes += left > 0 ? Block::bytes(size, cuts) : Block::readable(size, cuts);
  }
  return bytes;
}

void write_leaf(std::byte* memory, std::span<const Area> areas, std::span<const std::uint32_t> order,
                const Part& part, const LeafForm& form) {
  const auto n = static_cast<std::uint32_t>(areas.size());
  const bool cuts = form.cuts;
  Leaf* leaf = new (memory) Leaf;
  leaf->count = n;
  leaf->cuts = cuts ? 1 : 0;
  leaf->final = form.final ? 1 : 0;
  leaf->depth = static_cast<std::uint16_t>(form.depth);
  leaf->work.store(0, std::memory_order_relaxed);
  leaf->splitting.store(0, std::memory_order_relaxed);
  const double first = n > 0 ? areas[order[0]].z0 : 0, last = n > 0 ? areas[order[n - 1]].z0 : 0;
  leaf->z0 = std::nextafter(static_cast<float>(first), -std::numeric_limits<float>::infinity());
  const double range = last - static_cast<double>(leaf->z0), z_scale = range > 0 ? 254 / range : 0;
  leaf->z_scale = z_scale < 1e30 ? static_cast<float>(z_scale) : 0;
  const double step = 256 / part.size;
  auto* block = reinterpret_cast<std::uint8_t*>(leaf + 1);
  for (std::uint32_t done = 0; done < n;) {
    const std::uint32_t size = std::min<std::uint32_t>(n - done, Block::kMost);
    const std::size_t s = Block::stride(size);
    std::uint8_t* cut_factors = block + Block::kAreaBytes * s;
    std::uint8_t* cut_offsets = cut_factors + 6 * s;
    auto* ids =
        reinterpret_cast<std::uint32_t*>(block + (Block::kAreaBytes + (cuts ? Block::kCutBytes : 0)) * s);
    for (std::size_t i = 0; i < s; ++i) {
      if (i >= size) {
        block[i] = block[2 * s + i] = block[4 * s + i] = 255;
        block[s + i] = block[3 * s + i] = 0;
        ids[i] = 0;
        if (cuts) {
          for (std::size_t k = 0; k < 6; ++k) cut_factors[k * s + i] = 0;
          for (std::size_t k = 0; k < 3; ++k)
            cut_offsets[2 * k * s + 2 * i] = cut_offsets[2 * k * s + 2 * i + 1] = 0;
        }
        continue;
      }
      const Area& a = areas[order[done + i]];
      block[i] = to_byte((a.x0 - part.x) * step);
      block[s + i] = to_byte((a.x1 - part.x) * step);
      block[2 * s + i] = to_byte((a.y0 - part.y) * step);
      block[3 * s + i] = to_byte((a.y1 - part.y) * step);
      // By the very formula of quantised(), which is monotonic.
      block[4 * s + i] = to_byte((a.z0 - leaf->z0) * leaf->z_scale);
      ids[i] = a.id;
      if (cuts) {
        std::int8_t ab[6];
        std::int16_t c[3];
        quantise_cuts(a, part, ab, c);
        for (std::size_t k = 0; k < 6; ++k) cut_factors[k * s + i] = static_cast<std::uint8_t>(ab[k]);
        for (std::size_t k = 0; k < 3; ++k)
          std::copy_n(reinterpret_cast<const std::uint8_t*>(&c[k]), 2, cut_offsets + 2 * k * s + 2 * i);
      }
    }
    block += Block::bytes(size, cuts);
    done += size;
  }
}

}  // namespace fas
