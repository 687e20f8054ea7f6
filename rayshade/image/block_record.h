// SPDX-License-Identifier: MIT
// A finished block as a sealed record: the payload of journals and of messages between the ranks of a
// cluster. The bytes do not depend on the machine's byte order.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "rayshade/image/frame_buffer.h"
#include "rayshade/image/record.h"

namespace rayshade {

struct BlockRecord {
  int frame = 0;
  PixelStorage storage = PixelStorage::kByte;
  EncodedBlock block;
};

/// Whether pixels are packed (zlib, at its fastest) where that makes the record smaller: worth it where bytes
/// are dearer than processor time.
enum class RecordPacking : std::uint8_t { kPlain, kDeflate };

/// Bytes of pixels and layers of one pixel.
std::size_t recorded_pixel_size(PixelStorage storage, std::size_t layers);

/// The whole record. Throws std::invalid_argument where the pixels, layers or odd pixels of the block have
/// not the sizes that it announces.
std::string encode_block_record(int frame, const EncodedBlock& block, PixelStorage storage,
                                RecordPacking packing = RecordPacking::kPlain);

/// The block of a record's payload. Nothing, whatever the bytes, where they are no block, or one of more than
/// `limit` bytes of pixels and layers; no more memory than that (and a byte a pixel that says which are odd)
/// is ever taken.
std::optional<BlockRecord> decode_block_payload(std::string_view payload, std::uint64_t limit);

/// Of a record with nothing after it.
std::optional<BlockRecord> decode_block_record(std::string_view record, std::uint64_t limit);

/// The part of a block within a rectangle of the picture that it covers.
EncodedBlock cut_block(const EncodedBlock& block, PixelStorage storage, std::int64_t x, std::int64_t y,
                       std::int64_t width, std::int64_t height);

}  // namespace rayshade
