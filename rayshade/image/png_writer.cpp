// SPDX-License-Identifier: MIT
// PNG by libpng. libpng reports errors by longjmp, so no function below that calls it has an object with a
// destructor between its setjmp and the calls; exceptions of the sink are carried across as exception_ptr.
#include <png.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <exception>

#include "rayshade/image/writers.h"

namespace rayshade::detail {
namespace {

struct Target {
  Sink* sink = nullptr;
  std::exception_ptr thrown;
  char message[200] = {};
};

void on_write(png_structp png, png_bytep data, png_size_t size) {
  auto* const target = static_cast<Target*>(png_get_io_ptr(png));
  bool failed = false;
  try {
    target->sink->write(data, size);
  } catch (...) {
    target->thrown = std::current_exception();
    failed = true;
  }
  if (failed) png_error(png, "write failed");
}

void on_flush(png_structp) {}

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  auto* const target = static_cast<Target*>(png_get_error_ptr(png));
  std::snprintf(target->message, sizeof target->message, "%s", message);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

class PngFile {
 public:
  explicit PngFile(Sink& sink) {
    target_.sink = &sink;
    png_ = png_create_write_struct(PNG_LIBPNG_VER_STRING, &target_, on_error, on_warning);
    info_ = png_ != nullptr ? png_create_info_struct(png_) : nullptr;
    if (info_ == nullptr) {
      png_destroy_write_struct(&png_, &info_);
      throw std::bad_alloc();
    }
    png_set_write_fn(png_, &target_, on_write, on_flush);
  }
  ~PngFile() { png_destroy_write_struct(&png_, &info_); }
  PngFile(const PngFile&) = delete;
  PngFile& operator=(const PngFile&) = delete;

  void begin(const PngHeader& header, png_text* text, int text_count) {
    if (!begin_guarded(header, text, text_count)) rethrow();
  }
  void row(const std::uint8_t* data, int filter) {
    if (!row_guarded(data, filter)) rethrow();
  }
  void end() {
    if (!end_guarded()) rethrow();
  }

 private:
  bool begin_guarded(const PngHeader& header, png_text* text, int text_count) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_user_limits(png_, 0x7fffffff, 0x7fffffff);
    png_set_IHDR(png_, info_, static_cast<png_uint_32>(header.width), static_cast<png_uint_32>(header.height),
                 header.depth, header.channels == 4 ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (header.srgb) {
      png_set_sRGB(png_, info_, PNG_sRGB_INTENT_PERCEPTUAL);
    } else if (header.file_gamma > 0) {
      png_set_gAMA(png_, info_, header.file_gamma);
    }
    png_set_text(png_, info_, text, text_count);
    png_set_compression_level(png_, kLevel);
    png_set_compression_buffer_size(png_, std::size_t{1} << 16);
    // libpng reserves what filters need when the first row comes, from what is allowed by then.
    png_set_filter(png_, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB | PNG_FILTER_UP);
    png_write_info(png_, info_);
    return true;
  }
  bool row_guarded(const std::uint8_t* data, int filter) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_filter(png_, PNG_FILTER_TYPE_BASE, filter);
    png_write_row(png_, data);
    return true;
  }
  bool end_guarded() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_write_end(png_, nullptr);
    return true;
  }
  [[noreturn]] void rethrow() {
    if (target_.thrown) std::rethrow_exception(target_.thrown);
    throw WriteError(std::string("PNG: ") + target_.message);
  }

  // Measured on rendered pictures: level 6 takes three times as long as 1 and saves a tenth or so of the
  // bytes.
  static constexpr int kLevel = 1;

  Target target_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

// Size of a difference modulo 256, read as a signed byte.
std::uint64_t magnitude(int difference) {
  const auto byte = static_cast<std::uint8_t>(difference);
  return byte < 128U ? byte : 256U - byte;
}

// The sum of absolute differences to the left and to the upper neighbour tells which of the two filters
// leaves the smaller numbers; a seventh of the samples tells it as well as all.
int choose_filter(const std::uint8_t* row, const std::uint8_t* above, std::size_t size, std::size_t pixel) {
  std::uint64_t left = 0, up = 0;
  for (std::size_t i = pixel; i < size; i += 7) {
    left += magnitude(row[i] - row[i - pixel]);
    up += magnitude(row[i] - above[i]);
  }
  return up <= left ? PNG_FILTER_UP : PNG_FILTER_SUB;
}

bool is_ascii(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 128; });
}

class FrameRows : public PngRows {
 public:
  FrameRows(const FrameBuffer& picture, bool alpha)
      : picture_(picture), alpha_(alpha), row_(picture.row_bytes()) {}

  void read(std::int64_t y, std::uint8_t* out) override {
    picture_.read_row(y, row_.data());
    const std::size_t sample = pixel_size(picture_.storage()) / 4;
    if (sample == 2 && std::endian::native == std::endian::little)
      for (std::size_t i = 0; i < row_.size(); i += 2) std::swap(row_[i], row_[i + 1]);
    const std::size_t kept = (alpha_ ? 4 : 3) * sample;
    for (std::size_t i = 0; i < row_.size(); i += 4 * sample, out += kept) std::copy_n(&row_[i], kept, out);
  }

 private:
  const FrameBuffer& picture_;
  bool alpha_;
  std::vector<std::uint8_t> row_;
};

}  // namespace

void write_png(const PngHeader& header, PngRows& rows, Sink& sink) {
  std::vector<png_text> text(header.text.size());
  std::vector<std::string> keys;
  keys.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto& [key, value] = header.text[i];
    keys.push_back(key.substr(0, 79));
    text[i].compression = is_ascii(value) ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
    text[i].key = keys.back().data();
    text[i].text = const_cast<char*>(value.c_str());  // libpng copies it
  }
  PngFile file(sink);
  file.begin(header, text.data(), static_cast<int>(text.size()));
  const std::size_t pixel = static_cast<std::size_t>(header.channels * header.depth / 8);
  const std::size_t size = static_cast<std::size_t>(header.width) * pixel;
  std::vector<std::uint8_t> row(size), above(size);
  for (std::int64_t y = 0; y < header.height; ++y) {
    rows.read(y, row.data());
    file.row(row.data(), choose_filter(row.data(), above.data(), size, pixel));
    std::swap(row, above);
  }
  file.end();
}

void write_png(const FrameBuffer& picture, const PictureInfo& info, Sink& sink) {
  const ColorEncoding& encoding = picture.encoder().encoding();
  PngHeader header;
  header.width = picture.width();
  header.height = picture.height();
  header.depth = picture.storage() == PixelStorage::kWord ? 16 : 8;
  header.channels = info.alpha ? 4 : 3;
  header.srgb = info.tag_encoding && encoding.srgb;
  if (info.tag_encoding && !encoding.srgb && encoding.gamma != 1) {
    const double exponent = gamma_exponent(encoding.gamma);
    // Beyond these limits no viewer would make sense of it.
    if (exponent >= 0.01 && exponent <= 100) header.file_gamma = exponent;
  }
  header.text = info.provenance;
  FrameRows rows(picture, info.alpha);
  write_png(header, rows, sink);
}

}  // namespace rayshade::detail
