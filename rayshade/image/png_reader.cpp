// SPDX-License-Identifier: MIT
// PNG by libpng, as raw code values: palettes and transparency expanded, gamma and profiles left alone.
// Errors come by longjmp: no function that calls libpng has an object with a destructor of its own.
#include <fmt/format.h>
#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstring>

#include "rayshade/image/reader.h"
#include "rayshade/image/readers.h"

namespace rayshade::detail {
namespace {

struct Source {
  std::string_view bytes;
  char message[200] = {};
};

void on_read(png_structp png, png_bytep out, png_size_t size) {
  auto* const source = static_cast<Source*>(png_get_io_ptr(png));
  if (source->bytes.size() < size) png_error(png, "the file is cut off");
  std::memcpy(out, source->bytes.data(), size);
  source->bytes.remove_prefix(size);
}

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  auto* const source = static_cast<Source*>(png_get_error_ptr(png));
  std::snprintf(source->message, sizeof source->message, "%s", message);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

class PngInput {
 public:
  explicit PngInput(std::string_view bytes) {
    source_.bytes = bytes;
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source_, on_error, on_warning);
    info_ = png_ != nullptr ? png_create_info_struct(png_) : nullptr;
    if (info_ == nullptr) {
      png_destroy_read_struct(&png_, &info_, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(png_, &source_, on_read);
  }
  ~PngInput() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngInput(const PngInput&) = delete;
  PngInput& operator=(const PngInput&) = delete;

  void header() {
    if (!header_guarded()) fail();
  }
  void rows(png_bytepp rows) {
    if (!rows_guarded(rows)) fail();
  }

  std::int64_t width() const { return png_get_image_width(png_, info_); }
  std::int64_t height() const { return png_get_image_height(png_, info_); }
  int depth() const { return png_get_bit_depth(png_, info_); }
  int type() const { return png_get_color_type(png_, info_); }
  std::size_t row_bytes() const { return png_get_rowbytes(png_, info_); }
  int file_bits_per_pixel() const { return file_bits_; }

 private:
  bool header_guarded() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_user_limits(png_, 0x7fffffff, 0x7fffffff);
    png_set_chunk_malloc_max(png_, 1 << 24);
    png_read_info(png_, info_);
    file_bits_ = png_get_bit_depth(png_, info_) * png_get_channels(png_, info_);
    png_set_expand(png_);
    if (std::endian::native == std::endian::little) png_set_swap(png_);
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    return true;
  }
  bool rows_guarded(png_bytepp rows) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_image(png_, rows);
    return true;
  }
  [[noreturn]] void fail() const { throw ImageError(fmt::format("broken PNG: {}", source_.message)); }

  Source source_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  int file_bits_ = 0;
};

}  // namespace

Image read_png(std::string_view bytes) {
  PngInput input(bytes);
  input.header();
  Image image;
  image.width = input.width();
  image.height = input.height();
  // Deflate cannot shrink data below 1/1032.
  const std::int64_t most_bits = static_cast<std::int64_t>(bytes.size()) * 1032 * 8;
  check_size(image.width, image.height, most_bits / input.file_bits_per_pixel());
  image.channels = (input.type() & PNG_COLOR_MASK_COLOR) != 0 ? 3 : 1;
  image.has_alpha = (input.type() & PNG_COLOR_MASK_ALPHA) != 0;
  image.depth = input.depth();

  const std::size_t samples = static_cast<std::size_t>(image.width * image.height) *
                              static_cast<std::size_t>(image.samples_per_pixel());
  png_bytep data = nullptr;
  if (image.depth == 16) {
    image.words.resize(samples);
    data = reinterpret_cast<png_bytep>(image.words.data());
  } else {
    image.bytes.resize(samples);
    data = image.bytes.data();
  }
  const std::size_t row_bytes = input.row_bytes();
  if (row_bytes * static_cast<std::size_t>(image.height) !=
      samples * static_cast<std::size_t>(image.depth / 8))
    throw ImageError("broken PNG: rows of an unexpected length");
  // From the bottom, so that no flip is needed.
  std::vector<png_bytep> rows(static_cast<std::size_t>(image.height));
  for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = data + (rows.size() - 1 - y) * row_bytes;
  input.rows(rows.data());
  return image;
}

}  // namespace rayshade::detail
