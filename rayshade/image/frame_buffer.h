// SPDX-License-Identifier: MIT
// The picture while it is rendered: blocks arrive in any order and from any thread, writers pull rows (rule
// 11).
//
// A pixel is kept in exactly the form that its file will hold, so that a picture of 20,000 x 20,000 fits; the
// conversion happens on arrival (or earlier, on another machine: EncodedBlock). All indices are 64 bits wide.
// Which pixels have arrived is known for each pixel; those that have not are black with alpha 0.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <shared_mutex>
#include <span>
#include <string>
#include <vector>

#include "rayshade/image/encode.h"
#include "rayshade/image/mapped_memory.h"

namespace rayshade {

/// How one pixel is stored.
enum class PixelStorage : std::uint8_t {
  kByte,         ///< red, green, blue, alpha: 8 bits each, encoded
  kWord,         ///< the same with 16 bits in the machine's order
  kFloat,        ///< the same as 32-bit floats: linear colours, never encoded
  kExponential,  ///< r, g, b, exponent of shading.md 8.3, encoded, and an alpha byte
};

/// Bytes of one pixel: 4, 8, 16, 5.
std::size_t pixel_size(PixelStorage storage);

/// A rectangle of finished pixels, rows from the top, `rgba` holding 4 doubles (linear colour, alpha) for
/// each. `layers[i]` belongs to the i-th layer of the frame buffer, one float per pixel; empty where the
/// buffer has none.
struct PixelBlock {
  std::int64_t x = 0, y = 0;  ///< of the upper left pixel, counted within the picture (not the screen)
  std::int64_t width = 0, height = 0;
  std::span<const double> rgba;
  std::vector<std::span<const float>> layers;
};

/// What the stored form of a pixel need not tell any more, as bits.
enum PixelOddity : std::uint8_t { kNotANumber = 1, kNegative = 2, kInfinite = 4 };

/// What was noticed while pixels were converted.
struct PixelStatistics {
  std::uint64_t not_a_number = 0;  ///< pixels with a channel that is not a number
  std::uint64_t negative = 0;      ///< pixels with a channel below 0
  std::uint64_t infinite = 0;      ///< pixels with an infinite channel

  /// Counts a pixel with these oddities.
  void add(std::uint8_t oddities);
  bool operator==(const PixelStatistics&) const = default;
};

/// A block in the form in which the frame buffer keeps it: what a worker sends and a journal records. The
/// bytes do not depend on who made them, except that kWord and kFloat are in the machine's byte order.
struct EncodedBlock {
  std::int64_t x = 0, y = 0, width = 0, height = 0;
  std::vector<std::uint8_t> pixels;        ///< width * height * pixel_size(storage)
  std::vector<std::vector<float>> layers;  ///< as many as the frame buffer has
  /// A sum of PixelOddity for each pixel; empty where no pixel is odd.
  std::vector<std::uint8_t> odd;
};

/// The counts of EncodedBlock::odd.
PixelStatistics count_odd(std::span<const std::uint8_t> odd);

/// Converts a block. Throws std::invalid_argument where the spans do not have the sizes that the block
/// announces.
EncodedBlock encode_block(const PixelBlock& block, PixelStorage storage, const ColorEncoder& encoder);

struct FrameBufferOptions {
  std::int64_t width = 0, height = 0;
  PixelStorage storage = PixelStorage::kByte;
  ColorEncoding encoding;
  /// Names of float layers beside the colour ("depth.Z", "normal.X", "samples", "cost" ...). EXR files carry
  /// them as channels; any picture can have them written apart (layer_picture.h).
  std::vector<std::string> layers;
  /// Above this many bytes the pixels live in an unlinked file of `spill_directory` instead of anonymous
  /// memory.
  std::uint64_t spill_threshold = std::uint64_t{4} << 30;
  std::string spill_directory = "/var/tmp";
};

class FrameBuffer {
 public:
  /// Throws std::invalid_argument for a size below 1 or beyond 2^31 - 1, std::system_error where neither
  /// memory nor disk space is to be had.
  explicit FrameBuffer(const FrameBufferOptions& options);

  std::int64_t width() const { return width_; }
  std::int64_t height() const { return height_; }
  PixelStorage storage() const { return storage_; }
  const ColorEncoder& encoder() const { return encoder_; }
  const std::vector<std::string>& layers() const { return layer_names_; }
  /// Index of a layer, -1 if there is none of that name.
  int layer_index(const std::string& name) const;

  /// Stores a block. Thread-safe for disjoint blocks, and against the reading functions. A block that comes
  /// again replaces the first and is not counted twice. Throws std::invalid_argument for a block that does
  /// not fit.
  void put(const PixelBlock& block);
  void put(const EncodedBlock& block);

  /// Pixels that have arrived.
  std::int64_t present() const { return present_.load(std::memory_order_acquire); }
  bool complete() const { return present() == width_ * height_; }
  bool is_present(std::int64_t x, std::int64_t y) const;
  /// How many pixels of a rectangle within the picture have, and whether all have.
  std::int64_t present(std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height) const;
  bool is_present(std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height) const;
  /// Whether all pixels of a row have arrived.
  bool row_complete(std::int64_t y) const;
  /// Of the pixels that have arrived, each as it was when it came first.
  PixelStatistics statistics() const;

  std::size_t row_bytes() const { return static_cast<std::size_t>(width_) * pixel_size_; }
  /// The stored bytes of a row (0 = top). Valid as long as the buffer; the caller knows that nobody puts
  /// meanwhile.
  const std::uint8_t* row(std::int64_t y) const;
  const float* layer_row(int layer, std::int64_t y) const;
  /// Copies of the same, consistent while blocks still arrive.
  void read_row(std::int64_t y, std::uint8_t* out) const;
  void read_layer_row(int layer, std::int64_t y, float* out) const;

  /// Forgets every pixel, so that the next frame can use the same memory. Not while other threads use the
  /// buffer.
  void clear();

 private:
  void check(std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height) const;
  void mark(std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height,
            std::span<const std::uint8_t> odd);
  std::uint8_t* pixel(std::int64_t x, std::int64_t y);
  float* layer_pixel(std::size_t layer, std::int64_t x, std::int64_t y);

  std::int64_t width_, height_;
  PixelStorage storage_;
  std::size_t pixel_size_;
  ColorEncoder encoder_;
  std::vector<std::string> layer_names_;
  std::int64_t words_per_row_;
  MappedMemory pixels_, layers_, present_bits_;
  std::atomic<std::int64_t> present_{0};
  // Blocks are copied under the shared side, rows are read under the other.
  mutable std::shared_mutex rows_;
  mutable std::mutex statistics_mutex_;
  PixelStatistics statistics_;
};

}  // namespace rayshade
