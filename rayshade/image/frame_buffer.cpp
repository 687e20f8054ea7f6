// SPDX-License-Identifier: MIT
#include "rayshade/image/frame_buffer.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "rayshade/math/clones.h"

namespace rayshade {
namespace {

// One row of a block, from linear colours to the stored form.
void encode_pixels(const double* rgba, std::size_t count, PixelStorage storage, const ColorEncoder& encoder,
                   std::uint8_t* out) {
  switch (storage) {
    case PixelStorage::kByte:
      encoder.bytes(rgba, count, out);
      return;
    case PixelStorage::kWord:
      // Rows start at multiples of 8 bytes, in the picture as in an EncodedBlock.
      encoder.words(rgba, count, reinterpret_cast<std::uint16_t*>(out));
      return;
    case PixelStorage::kFloat: {
      auto* const floats = reinterpret_cast<float*>(out);
      for (std::size_t i = 0; i < 4 * count; ++i) floats[i] = static_cast<float>(rgba[i]);
      return;
    }
    case PixelStorage::kExponential:
      for (std::size_t i = 0; i < count; ++i, rgba += 4, out += 5) {
        const auto bytes = encoder.exponential(rgba[0], rgba[1], rgba[2]);
        std::copy(bytes.begin(), bytes.end(), out);
        out[4] = to_byte(rgba[3]);
      }
      return;
  }
}

/// Whether all values are numbers from 0 to the largest finite one.
RAYSHADE_CLONES("avx2") bool all_usual(std::span<const double> values) {
  std::int64_t unusual = 0;
  for (const double v : values)
    unusual |= (v >= 0 ? 0 : 1) | (v <= std::numeric_limits<double>::max() ? 0 : 1);
  return unusual == 0;
}

/// As EncodedBlock::odd.
std::vector<std::uint8_t> odd_pixels(std::span<const double> rgba) {
  std::vector<std::uint8_t> odd;
  if (all_usual(rgba)) return odd;
  for (std::size_t i = 0; i + 3 < rgba.size(); i += 4) {
    const double* const p = &rgba[i];
    unsigned oddities = 0;
    for (int c = 0; c < 3; ++c) {
      if (std::isnan(p[c])) oddities |= kNotANumber;
      if (p[c] < 0) oddities |= kNegative;
      if (std::isinf(p[c])) oddities |= kInfinite;
    }
    if (oddities == 0) continue;
    odd.resize(rgba.size() / 4);
    odd[i / 4] = static_cast<std::uint8_t>(oddities);
  }
  return odd;
}

std::size_t area(std::int64_t width, std::int64_t height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

void check_spans(const PixelBlock& block) {
  constexpr std::int64_t kLimit = std::numeric_limits<std::int32_t>::max();
  if (block.width < 0 || block.height < 0 || block.width > kLimit || block.height > kLimit)
    throw std::invalid_argument("pixel block of an impossible size");
  if (block.rgba.size() != 4 * area(block.width, block.height))
    throw std::invalid_argument("pixel block whose colours do not match its size");
  for (const auto& layer : block.layers)
    if (layer.size() != area(block.width, block.height))
      throw std::invalid_argument("pixel block whose layers do not match its size");
}

const FrameBufferOptions& checked(const FrameBufferOptions& options) {
  constexpr std::int64_t kLimit = std::numeric_limits<std::int32_t>::max();
  if (options.width < 1 || options.height < 1 || options.width > kLimit || options.height > kLimit)
    throw std::invalid_argument(fmt::format("a picture of {} x {} pixels", options.width, options.height));
  return options;
}

}  // namespace

std::size_t pixel_size(PixelStorage storage) {
  switch (storage) {
    case PixelStorage::kByte:
      return 4;
    case PixelStorage::kWord:
      return 8;
    case PixelStorage::kFloat:
      return 16;
    case PixelStorage::kExponential:
      return 5;
  }
  return 0;
}

void PixelStatistics::add(std::uint8_t oddities) {
  not_a_number += (oddities & kNotANumber) != 0;
  negative += (oddities & kNegative) != 0;
  infinite += (oddities & kInfinite) != 0;
}

PixelStatistics count_odd(std::span<const std::uint8_t> odd) {
  PixelStatistics seen;
  for (const std::uint8_t oddities : odd) seen.add(oddities);
  return seen;
}

EncodedBlock encode_block(const PixelBlock& block, PixelStorage storage, const ColorEncoder& encoder) {
  check_spans(block);
  EncodedBlock out{block.x, block.y, block.width, block.height, {}, {}, odd_pixels(block.rgba)};
  out.pixels.resize(area(block.width, block.height) * pixel_size(storage));
  encode_pixels(block.rgba.data(), area(block.width, block.height), storage, encoder, out.pixels.data());
  out.layers.reserve(block.layers.size());
  for (const auto& layer : block.layers) out.layers.emplace_back(layer.begin(), layer.end());
  return out;
}

FrameBuffer::FrameBuffer(const FrameBufferOptions& options)
    : width_(checked(options).width),
      height_(options.height),
      storage_(options.storage),
      pixel_size_(pixel_size(options.storage)),
      encoder_(options.encoding),
      layer_names_(options.layers),
      words_per_row_((options.width + 63) / 64) {
  const std::uint64_t pixels = area(width_, height_);
  const std::uint64_t per_pixel = pixel_size_ + sizeof(float) * layer_names_.size();
  if (pixels > std::numeric_limits<std::int64_t>::max() / per_pixel)
    throw std::invalid_argument(fmt::format("a picture of {} x {} pixels", width_, height_));
  const std::string directory =
      pixels * per_pixel > options.spill_threshold ? options.spill_directory : std::string{};
  pixels_ = MappedMemory(pixels * pixel_size_, directory);
  layers_ = MappedMemory(pixels * sizeof(float) * layer_names_.size(), directory);
  present_bits_ = MappedMemory(area(words_per_row_, height_) * sizeof(std::uint64_t));
}

int FrameBuffer::layer_index(const std::string& name) const {
  const auto found = std::find(layer_names_.begin(), layer_names_.end(), name);
  return found == layer_names_.end() ? -1 : static_cast<int>(found - layer_names_.begin());
}

std::uint8_t* FrameBuffer::pixel(std::int64_t x, std::int64_t y) {
  return pixels_.data() + (area(y, width_) + static_cast<std::size_t>(x)) * pixel_size_;
}

float* FrameBuffer::layer_pixel(std::size_t layer, std::int64_t x, std::int64_t y) {
  return reinterpret_cast<float*>(layers_.data()) + layer * area(width_, height_) + area(y, width_) +
         static_cast<std::size_t>(x);
}

void FrameBuffer::check(std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height) const {
  if (x < 0 || y < 0 || width < 0 || height < 0 || width > width_ || height > height_ || x > width_ - width ||
      y > height_ - height)
    throw std::invalid_argument(
        fmt::format("a block of {} x {} at ({}, {}) does not fit a picture of {} x {}", width, height, x, y,
                    width_, height_));
}

void FrameBuffer::put(const PixelBlock& block) {
  check_spans(block);
  check(block.x, block.y, block.width, block.height);
  if (block.layers.size() != layer_names_.size())
    throw std::invalid_argument("pixel block with other layers than the picture");
  const std::vector<std::uint8_t> odd = odd_pixels(block.rgba);
  const std::size_t width = static_cast<std::size_t>(block.width);
  {
    const std::shared_lock lock(rows_);
    for (std::int64_t row = 0; row < block.height; ++row) {
      const std::size_t start = static_cast<std::size_t>(row) * width;
      encode_pixels(block.rgba.data() + 4 * start, width, storage_, encoder_, pixel(block.x, block.y + row));
      for (std::size_t i = 0; i < block.layers.size(); ++i)
        std::copy_n(block.layers[i].data() + start, width, layer_pixel(i, block.x, block.y + row));
    }
  }
  mark(block.x, block.y, block.width, block.height, odd);
}

void FrameBuffer::put(const EncodedBlock& block) {
  check(block.x, block.y, block.width, block.height);
  const std::size_t pixels = area(block.width, block.height);
  const bool layers_fit = block.layers.size() == layer_names_.size() &&
                          std::all_of(block.layers.begin(), block.layers.end(),
                                      [&](const auto& l) { return l.size() == pixels; });
  const bool odd_fits = block.odd.empty() || block.odd.size() == pixels;
  if (block.pixels.size() != pixels * pixel_size_ || !layers_fit || !odd_fits)
    throw std::invalid_argument("encoded block of another size or form than the picture's");
  const std::size_t width = static_cast<std::size_t>(block.width);
  {
    const std::shared_lock lock(rows_);
    for (std::int64_t row = 0; row < block.height; ++row) {
      const std::size_t start = static_cast<std::size_t>(row) * width;
      std::copy_n(block.pixels.data() + start * pixel_size_, width * pixel_size_,
                  pixel(block.x, block.y + row));
      for (std::size_t i = 0; i < block.layers.size(); ++i)
        std::copy_n(block.layers[i].data() + start, width, layer_pixel(i, block.x, block.y + row));
    }
  }
  mark(block.x, block.y, block.width, block.height, block.odd);
}

void FrameBuffer::mark(std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height,
                       std::span<const std::uint8_t> odd) {
  auto* const bits = reinterpret_cast<std::uint64_t*>(present_bits_.data());
  std::int64_t fresh = 0;
  PixelStatistics seen;
  for (std::int64_t row = y; row < y + height; ++row) {
    for (std::int64_t begin = x; begin < x + width;) {
      const std::int64_t end = std::min((begin / 64 + 1) * 64, x + width);
      const std::uint64_t mask = (~std::uint64_t{0} >> (64 - (end - begin))) << (begin % 64);
      std::atomic_ref<std::uint64_t> word(bits[row * words_per_row_ + begin / 64]);
      std::uint64_t newly = mask & ~word.fetch_or(mask, std::memory_order_acq_rel);
      fresh += std::popcount(newly);
      if (odd.empty()) newly = 0;
      for (; newly != 0; newly &= newly - 1) {
        const std::int64_t column = begin / 64 * 64 + std::countr_zero(newly);
        seen.add(odd[static_cast<std::size_t>((row - y) * width + column - x)]);
      }
      begin = end;
    }
  }
  if (fresh == 0) return;
  if (seen != PixelStatistics{}) {
    const std::lock_guard lock(statistics_mutex_);
    statistics_.not_a_number += seen.not_a_number;
    statistics_.negative += seen.negative;
    statistics_.infinite += seen.infinite;
  }
  present_.fetch_add(fresh, std::memory_order_acq_rel);
}

bool FrameBuffer::is_present(std::int64_t x, std::int64_t y) const { return is_present(x, y, 1, 1); }

bool FrameBuffer::is_present(std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height) const {
  return present(x, y, width, height) == width * height;
}

std::int64_t FrameBuffer::present(std::int64_t x, std::int64_t y, std::int64_t width,
                                  std::int64_t height) const {
  auto* const bits = reinterpret_cast<std::uint64_t*>(present_bits_.data());
  std::int64_t count = 0;
  for (std::int64_t row = y; row < y + height; ++row) {
    for (std::int64_t begin = x; begin < x + width;) {
      const std::int64_t end = std::min((begin / 64 + 1) * 64, x + width);
      const std::uint64_t mask = (~std::uint64_t{0} >> (64 - (end - begin))) << (begin % 64);
      const std::atomic_ref<std::uint64_t> word(bits[row * words_per_row_ + begin / 64]);
      count += std::popcount(word.load(std::memory_order_acquire) & mask);
      begin = end;
    }
  }
  return count;
}

bool FrameBuffer::row_complete(std::int64_t y) const { return is_present(0, y, width_, 1); }

PixelStatistics FrameBuffer::statistics() const {
  const std::lock_guard lock(statistics_mutex_);
  return statistics_;
}

const std::uint8_t* FrameBuffer::row(std::int64_t y) const {
  return pixels_.data() + static_cast<std::size_t>(y) * row_bytes();
}

const float* FrameBuffer::layer_row(int layer, std::int64_t y) const {
  return reinterpret_cast<const float*>(layers_.data()) +
         static_cast<std::size_t>(layer) * area(width_, height_) + area(y, width_);
}

void FrameBuffer::read_row(std::int64_t y, std::uint8_t* out) const {
  const std::lock_guard lock(rows_);
  std::memcpy(out, row(y), row_bytes());
}

void FrameBuffer::read_layer_row(int layer, std::int64_t y, float* out) const {
  const std::lock_guard lock(rows_);
  std::memcpy(out, layer_row(layer, y), static_cast<std::size_t>(width_) * sizeof(float));
}

void FrameBuffer::clear() {
  pixels_.clear();
  layers_.clear();
  present_bits_.clear();
  present_ = 0;
  statistics_ = {};
}

}  // namespace rayshade
