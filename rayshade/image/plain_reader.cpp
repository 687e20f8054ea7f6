// SPDX-License-Identifier: MIT
// PGM and PPM (text and binary), PFM and the original's raw format: a header of text, then the samples.
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "rayshade/image/reader.h"
#include "rayshade/image/readers.h"

namespace rayshade::detail {
namespace {

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Reads the words of a header.
class Header {
 public:
  explicit Header(std::string_view bytes, std::size_t position) : bytes_(bytes), position_(position) {}

  /// The next unsigned number, behind blanks and comments ("# ..." to the end of the line).
  std::int64_t number(const char* what) {
    skip_blanks();
    if (position_ == bytes_.size() || !is_digit(bytes_[position_]))
      throw ImageError(fmt::format("the {} is missing", what));
    std::int64_t value = 0;
    for (; position_ < bytes_.size() && is_digit(bytes_[position_]); ++position_) {
      value = value * 10 + (bytes_[position_] - '0');
      if (value > 0x7fffffff) throw ImageError(fmt::format("the {} is too large", what));
    }
    return value;
  }
  /// Any word without blanks.
  std::string_view word() {
    skip_blanks();
    const std::size_t start = position_;
    while (position_ < bytes_.size() && !is_space(bytes_[position_])) ++position_;
    return bytes_.substr(start, position_ - start);
  }
  /// What follows the single blank at the header's end.
  std::string_view data() {
    if (position_ == bytes_.size()) return {};
    if (!is_space(bytes_[position_])) throw ImageError("no blank after the header");
    return bytes_.substr(position_ + 1);
  }

 private:
  void skip_blanks() {
    for (; position_ < bytes_.size(); ++position_) {
      if (bytes_[position_] == '#') {
        while (position_ < bytes_.size() && bytes_[position_] != '\n') ++position_;
        if (position_ == bytes_.size()) return;
      } else if (!is_space(bytes_[position_])) {
        return;
      }
    }
  }

  std::string_view bytes_;
  std::size_t position_;
};

/// Samples from 0 to `maximum` as an Image stores them: unchanged if the maximum is that of 8 or 16 bits,
/// otherwise spread over 16 bits.
class SampleStore {
 public:
  SampleStore(Image& image, std::int64_t maximum) : image_(image), maximum_(maximum) {
    const std::size_t count = static_cast<std::size_t>(image.width * image.height * image.channels);
    image.depth = maximum == 255 ? 8 : 16;
    if (image.depth == 8) {
      image.bytes.reserve(count);
    } else {
      image.words.reserve(count);
    }
  }
  void add(std::int64_t code) {
    if (code > maximum_) code = maximum_;
    if (image_.depth == 8) {
      image_.bytes.push_back(static_cast<std::uint8_t>(code));
    } else {
      image_.words.push_back(static_cast<std::uint16_t>((code * 65535 + maximum_ / 2) / maximum_));
    }
  }

 private:
  Image& image_;
  std::int64_t maximum_;
};

}  // namespace

Image read_pnm(std::string_view bytes) {
  const char type = bytes[1];
  const bool text = type == '2' || type == '3';
  Image image;
  image.channels = type == '2' || type == '5' ? 1 : 3;
  Header header(bytes, 2);
  image.width = header.number("width");
  image.height = header.number("height");
  const std::int64_t maximum = header.number("largest sample value");
  if (maximum < 1 || maximum > 65535) throw ImageError(fmt::format("a largest sample value of {}", maximum));

  const std::int64_t sample_size = maximum > 255 ? 2 : 1;
  // In text a sample is at least one digit and a blank, which the last one may lack.
  const std::int64_t length = static_cast<std::int64_t>(bytes.size());
  check_size(image.width, image.height,
             text ? (length + 1) / 2 / image.channels : length / sample_size / image.channels);
  const std::int64_t count = image.width * image.height * image.channels;
  if (text) {
    SampleStore store(image, maximum);
    for (std::int64_t i = 0; i < count; ++i) store.add(header.number("next sample"));
  } else {
    const std::string_view data = header.data();
    if (static_cast<std::int64_t>(data.size()) < count * sample_size)
      throw ImageError(fmt::format("the file is too short for {} x {} pixels", image.width, image.height));
    if (maximum == 255) {
      image.bytes.assign(data.begin(), data.begin() + count);
    } else {
      SampleStore store(image, maximum);
      const auto at = [&](std::int64_t i) {
        return static_cast<std::uint8_t>(data[static_cast<std::size_t>(i)]);
      };
      for (std::int64_t i = 0; i < count; ++i)
        store.add(sample_size == 1 ? at(i) : at(2 * i) << 8 | at(2 * i + 1));
    }
  }
  flip_rows(image);
  return image;
}

Image read_pfm(std::string_view bytes) {
  Image image;
  image.channels = bytes[1] == 'f' ? 1 : 3;
  image.depth = 32;
  Header header(bytes, 2);
  image.width = header.number("width");
  image.height = header.number("height");
  const std::string_view scale = header.word();
  // Only the sign has a meaning that all writers agree upon: the byte order.
  const bool little = scale.starts_with('-');
  const std::string_view digits = scale.substr(little ? 1 : 0);
  if (digits.empty() || !(is_digit(digits[0]) || digits[0] == '.')) throw ImageError("the scale is missing");
  const std::string_view data = header.data();
  const std::int64_t floats = static_cast<std::int64_t>(data.size() / 4);
  check_size(image.width, image.height, floats / image.channels);
  image.floats.resize(static_cast<std::size_t>(image.width * image.height * image.channels));
  std::memcpy(image.floats.data(), data.data(), image.floats.size() * sizeof(float));
  if (little != (std::endian::native == std::endian::little)) {
    for (float& value : image.floats) {
      const auto word = std::bit_cast<std::uint32_t>(value);
      value = std::bit_cast<float>(__builtin_bswap32(word));
    }
  }
  return image;  // rows are stored from the bottom
}

Image read_raw(std::string_view bytes) {
  // One line "WIDTH HEIGHT". Comments and other lines have no place here: anything could be taken for a
  // picture.
  const std::string_view line = bytes.substr(0, std::min<std::size_t>(bytes.find('\n'), 64));
  for (const char c : line)
    if (!is_digit(c) && c != ' ' && c != '\t' && c != '\r')
      throw ImageError("not a picture of a known format");
  if (bytes.empty()) throw ImageError("the file is empty");
  if (line.size() == bytes.size() || bytes[line.size()] != '\n')
    throw ImageError("not a picture of a known format");
  Header header(line, 0);
  Image image;
  image.width = header.number("width");
  image.height = header.number("height");
  if (!header.word().empty()) throw ImageError("more than width and height in the first line");
  const std::string_view data = bytes.substr(line.size() + 1);
  check_size(image.width, image.height, static_cast<std::int64_t>(data.size() / 3));
  image.bytes.assign(data.begin(), data.begin() + image.width * image.height * 3);
  return image;  // in file order: see Image
}

}  // namespace rayshade::detail
