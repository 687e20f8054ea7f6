// SPDX-License-Identifier: MIT
#include "rayshade/image/block_record.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace rayshade {
namespace {

constexpr std::int64_t kLargestSide = std::numeric_limits<std::int32_t>::max();

/// Bytes of the numbers whose order depends on the machine; 1: none.
std::size_t word_size(PixelStorage storage) {
  return storage == PixelStorage::kWord ? 2 : storage == PixelStorage::kFloat ? 4 : 1;
}

/// Between the machine's order and little-endian, either way.
void swap_words(char* data, std::size_t size, std::size_t word) {
  if constexpr (std::endian::native == std::endian::little) return;
  for (std::size_t i = 0; i + word <= size; i += word) std::reverse(data + i, data + i + word);
}

/// Pixels, then layer after layer, then what is odd about pixels if any is, as they are recorded.
std::string plain_bytes(const EncodedBlock& block, PixelStorage storage) {
  std::string out(reinterpret_cast<const char*>(block.pixels.data()), block.pixels.size());
  swap_words(out.data(), out.size(), word_size(storage));
  const std::size_t pixels = out.size();
  for (const std::vector<float>& layer : block.layers)
    out.append(reinterpret_cast<const char*>(layer.data()), layer.size() * sizeof(float));
  swap_words(out.data() + pixels, out.size() - pixels, sizeof(float));
  out.append(reinterpret_cast<const char*>(block.odd.data()), block.odd.size());
  return out;
}

/// Packed bytes, if they are fewer.
std::optional<std::string> deflated(const std::string& plain) {
  // zlib counts in unsigned long in its one-call functions: any block fits where that has 64 bits.
  uLongf size = compressBound(static_cast<uLong>(plain.size()));
  std::string out(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(plain.data()),
                static_cast<uLong>(plain.size()), Z_BEST_SPEED) != Z_OK ||
      size >= plain.size())
    return {};
  out.resize(size);
  return out;
}

bool inflate_to(std::string_view packed, std::string& plain) {
  auto size = static_cast<uLongf>(plain.size());
  auto used = static_cast<uLong>(packed.size());
  return uncompress2(reinterpret_cast<Bytef*>(plain.data()), &size,
                     reinterpret_cast<const Bytef*>(packed.data()), &used) == Z_OK &&
         size == plain.size() && used == packed.size();
}

bool is_storage(PixelStorage storage) {
  return storage == PixelStorage::kByte || storage == PixelStorage::kWord ||
         storage == PixelStorage::kFloat || storage == PixelStorage::kExponential;
}

bool fits(std::int64_t start, std::int64_t length) {
  return start >= 0 && length >= 1 && start <= kLargestSide && length <= kLargestSide - start;
}

}  // namespace

std::size_t recorded_pixel_size(PixelStorage storage, std::size_t layers) {
  return pixel_size(storage) + layers * sizeof(float);
}

std::string encode_block_record(int frame, const EncodedBlock& block, PixelStorage storage,
                                RecordPacking packing) {
  if (!fits(block.x, block.width) || !fits(block.y, block.height))
    throw std::invalid_argument("block record: no such rectangle");
  const auto pixels = static_cast<std::size_t>(block.width) * static_cast<std::size_t>(block.height);
  if (block.pixels.size() != pixels * pixel_size(storage) ||
      std::ranges::any_of(block.layers, [&](const auto& layer) { return layer.size() != pixels; }) ||
      (!block.odd.empty() && block.odd.size() != pixels))
    throw std::invalid_argument("block record: the block has not the bytes that it announces");
  const PixelStatistics seen = count_odd(block.odd);
  if ((seen == PixelStatistics{}) != block.odd.empty())
    throw std::invalid_argument("block record: odd pixels, none of which is odd");
  const std::string plain = plain_bytes(block, storage);
  const std::optional<std::string> packed =
      packing == RecordPacking::kDeflate ? deflated(plain) : std::optional<std::string>();
  const std::string& data = packed ? *packed : plain;
  RecordWriter out(RecordKind::kBlock, 64 + data.size());
  out.number(std::int32_t{frame});
  out.number(storage);
  out.number(packed ? RecordPacking::kDeflate : RecordPacking::kPlain);
  out.number(static_cast<std::uint16_t>(block.layers.size()));
  for (const std::int64_t value : {block.x, block.y, block.width, block.height})
    out.number(static_cast<std::uint32_t>(value));
  for (const std::uint64_t count : {seen.not_a_number, seen.negative, seen.infinite}) out.number(count);
  out.bytes(data.data(), data.size());
  return out.seal();
}

std::optional<BlockRecord> decode_block_payload(std::string_view payload, std::uint64_t limit) {
  RecordReader in(payload);
  BlockRecord out;
  out.frame = in.number<std::int32_t>();
  out.storage = in.number<PixelStorage>();
  const auto packing = in.number<RecordPacking>();
  const std::size_t layers = in.number<std::uint16_t>();
  EncodedBlock& block = out.block;
  for (std::int64_t* value : {&block.x, &block.y, &block.width, &block.height})
    *value = in.number<std::uint32_t>();
  PixelStatistics seen;
  for (std::uint64_t* count : {&seen.not_a_number, &seen.negative, &seen.infinite})
    *count = in.number<std::uint64_t>();
  if (!in.ok() || !is_storage(out.storage) || !fits(block.x, block.width) || !fits(block.y, block.height))
    return {};
  // Below 2^62 pixels: the division keeps the product from overflowing.
  const std::uint64_t pixels =
      static_cast<std::uint64_t>(block.width) * static_cast<std::uint64_t>(block.height);
  const std::size_t each = recorded_pixel_size(out.storage, layers);
  if (pixels > limit / each) return {};
  const bool any_odd = seen != PixelStatistics{};
  const std::uint64_t size = pixels * (each + (any_odd ? 1 : 0));
  std::string unpacked;
  std::string_view data = in.rest();
  if (packing == RecordPacking::kDeflate) {
    // Deflate makes at most 1032 bytes out of one: what announces more is not worth its memory.
    if (size / 1032 > data.size()) return {};
    unpacked.resize(size);
    if (!inflate_to(data, unpacked)) return {};
    data = unpacked;
  } else if (packing != RecordPacking::kPlain) {
    return {};
  }
  if (data.size() != size) return {};
  const std::size_t colors = pixels * pixel_size(out.storage);
  block.pixels.assign(data.begin(), data.begin() + static_cast<std::ptrdiff_t>(colors));
  swap_words(reinterpret_cast<char*>(block.pixels.data()), colors, word_size(out.storage));
  block.layers.resize(layers);
  for (std::size_t i = 0; i < layers; ++i) {
    std::vector<float>& layer = block.layers[i];
    layer.resize(pixels);
    std::memcpy(layer.data(), data.data() + colors + i * pixels * sizeof(float), pixels * sizeof(float));
    swap_words(reinterpret_cast<char*>(layer.data()), pixels * sizeof(float), sizeof(float));
  }
  if (any_odd) {
    block.odd.assign(data.end() - static_cast<std::ptrdiff_t>(pixels), data.end());
    if (count_odd(block.odd) != seen) return {};
  }
  return out;
}

std::optional<BlockRecord> decode_block_record(std::string_view record, std::uint64_t limit) {
  const std::optional<Record> opened = open_record(record);
  if (!opened || opened->kind != RecordKind::kBlock || opened->size != record.size()) return {};
  return decode_block_payload(opened->payload, limit);
}

EncodedBlock cut_block(const EncodedBlock& block, PixelStorage storage, std::int64_t x, std::int64_t y,
                       std::int64_t width, std::int64_t height) {
  if (width < 1 || height < 1 || x < block.x || y < block.y || x + width > block.x + block.width ||
      y + height > block.y + block.height)
    throw std::invalid_argument("cut_block: the rectangle is not within the block");
  EncodedBlock out;
  out.x = x;
  out.y = y;
  out.width = width;
  out.height = height;
  out.layers.resize(block.layers.size());
  const auto each = static_cast<std::int64_t>(pixel_size(storage));
  for (std::int64_t row = y - block.y; row < y - block.y + height; ++row) {
    const std::int64_t first = row * block.width + x - block.x;
    const auto pixels = block.pixels.begin() + first * each;
    out.pixels.insert(out.pixels.end(), pixels, pixels + width * each);
    for (std::size_t i = 0; i < block.layers.size(); ++i) {
      const auto values = block.layers[i].begin() + first;
      out.layers[i].insert(out.layers[i].end(), values, values + width);
    }
    if (block.odd.empty()) continue;
    const auto odd = block.odd.begin() + first;
    out.odd.insert(out.odd.end(), odd, odd + width);
  }
  if (count_odd(out.odd) == PixelStatistics{}) out.odd.clear();
  return out;
}

}  // namespace rayshade
