// SPDX-License-Identifier: MIT
// Utah RLE (textures.md 6.1, shading.md 8.3). Whatever is drawn outside the window, in channels that do not
// exist, or by unknown instructions is ignored, as the toolkit's readers do; a body that ends early is an
// error.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rayshade/image/reader.h"
#include "rayshade/image/readers.h"
#include "rayshade/image/rle.h"

namespace rayshade {
namespace {

using namespace detail;

class RleBytes {
 public:
  explicit RleBytes(std::string_view bytes) : bytes_(bytes) {}

  std::size_t position() const { return position_; }
  std::size_t left() const { return bytes_.size() - position_; }
  int byte() { return static_cast<std::uint8_t>(bytes_[position_++]); }
  int word() {
    const int low = byte();
    return low | byte() << 8;
  }
  std::string_view take(std::size_t count) {
    const std::string_view taken = bytes_.substr(position_, count);
    position_ += taken.size();
    return taken;
  }

 private:
  std::string_view bytes_;
  std::size_t position_ = 0;
};

struct Header {
  RleInfo info;
  int flags = 0, colors = 0;
  std::uint8_t background[256] = {};
};

Header read_header(RleBytes& in) {
  const auto need = [&in](std::size_t count) {
    if (in.left() < count) throw ImageError("the RLE header is cut off");
  };
  Header header;
  RleInfo& info = header.info;
  need(15);
  if (in.word() != kRleMagic) throw ImageError("not an RLE file");
  info.x = in.word();
  info.y = in.word();
  info.width = in.word();
  info.height = in.word();
  header.flags = in.byte();
  header.colors = in.byte();
  const int bits = in.byte();
  const int maps = in.byte();
  const int map_length = in.byte();
  info.alpha = (header.flags & kRleAlpha) != 0;
  if (bits != 8) throw ImageError(fmt::format("RLE samples of {} bits; only 8 can be read", bits));
  if (info.width < 1 || info.height < 1)
    throw ImageError(fmt::format("a picture of {} x {} pixels", info.width, info.height));
  if ((header.flags & kRleNoBackground) == 0 && header.colors > 0) {
    const std::size_t count = static_cast<std::size_t>(rle_background_bytes(header.colors));
    need(count);
    const std::string_view bytes = in.take(count);
    if ((header.flags & kRleClearFirst) != 0)
      std::copy_n(bytes.begin(), std::min<std::size_t>(bytes.size(), header.colors), header.background);
  } else {
    need(1);
    in.byte();
  }
  if (maps > 0) {
    if (map_length > 16) throw ImageError(fmt::format("an RLE colour map of 2^{} entries", map_length));
    const std::size_t size = (static_cast<std::size_t>(maps) << map_length) * 2;
    need(size);
    in.take(size);
  }
  if ((header.flags & kRleComment) != 0) {
    need(2);
    const std::size_t length = static_cast<std::size_t>(in.word());
    need(length);
    std::string_view text = in.take(length);
    if (length % 2 != 0 && in.left() > 0) in.byte();
    while (!text.empty()) {
      const std::string_view comment = text.substr(0, text.find('\0'));
      if (!comment.empty()) info.comments.emplace_back(comment);
      text.remove_prefix(std::min(text.size(), comment.size() + 1));
    }
  }
  info.exponential = header.colors == 4 && std::find(info.comments.begin(), info.comments.end(),
                                                     "exponential_data") != info.comments.end();
  return header;
}

/// Follows the instructions up to the end opcode, or to the end of the input, and draws into `canvas`, which
/// has set(x, y, channel, value): channel -1 is alpha, x and y lie within the window. Fills in whole, rows
/// and size.
template <typename Canvas>
void follow(RleBytes& in, Header& header, Canvas&& canvas) {
  RleInfo& info = header.info;
  std::int64_t x = 0, y = 0;
  int channel = 0;
  // A file may draw a pixel more than once, but not for ever: a few bytes can fill a row.
  std::int64_t allowance = (std::int64_t{16} * info.width * info.height + 65536) * (header.colors + 1);
  const auto draw = [&](std::int64_t count, auto&& value) {
    const bool inside = y < info.height && (channel >= 0 ? channel < header.colors : info.alpha);
    const std::int64_t end = inside ? std::min<std::int64_t>(x + count, info.width) : x;
    allowance -= end - x;
    if (allowance < 0) throw ImageError("the RLE data draw the same pixels again and again");
    for (std::int64_t i = x; i < end; ++i) canvas.set(i, y, channel, static_cast<std::uint8_t>(value(i - x)));
    x = std::min<std::int64_t>(x + count, info.width);
  };
  while (in.left() >= 2) {
    const int opcode = in.byte();
    std::int64_t operand = in.byte();
    if ((opcode & kRleLong) != 0) {
      if (in.left() < 2) break;
      operand = in.word();
    }
    switch (opcode & 63) {
      case kRleSkipLines:
        y = std::min<std::int64_t>(y + operand, info.height);
        x = 0;
        channel = 0;
        break;
      case kRleSetColor:
        channel = operand == kRleAlphaChannel ? -1 : static_cast<int>(operand);
        x = 0;
        break;
      case kRleSkipPixels:
        x = std::min<std::int64_t>(x + operand, info.width);
        break;
      case kRleByteData: {
        const std::size_t count = static_cast<std::size_t>(operand) + 1;
        if (in.left() < count + count % 2) {
          in.take(in.left());
          break;
        }
        const std::string_view data = in.take(count + count % 2);
        draw(operand + 1, [&](std::int64_t i) { return data[static_cast<std::size_t>(i)]; });
        break;
      }
      case kRleRunData: {
        if (in.left() < 2) {
          in.take(in.left());
          break;
        }
        const int value = in.word() & 255;
        draw(operand + 1, [value](std::int64_t) { return value; });
        break;
      }
      case kRleEnd:
        info.whole = true;
        info.rows = info.height;
        info.size = in.position();
        return;
      default:
        break;
    }
  }
  // The row being drawn may lack channels; those below it are complete.
  info.rows = y;
  info.size = in.position() + in.left();
}

struct NoCanvas {
  void set(std::int64_t, std::int64_t, int, std::uint8_t) {}
};

struct ByteCanvas {
  std::uint8_t* data;
  std::int64_t width;
  int colors, samples;

  void set(std::int64_t x, std::int64_t y, int channel, std::uint8_t value) {
    data[(y * width + x) * samples + (channel < 0 ? colors : channel)] = value;
  }
};

/// Red, green, blue from mantissas and the common exponent (shading.md 8.3).
Image from_exponential(const std::vector<std::uint8_t>& coded, const RleInfo& info) {
  Image image;
  image.width = info.width;
  image.height = info.height;
  image.has_alpha = info.alpha;
  image.depth = 32;
  const std::size_t stored = info.alpha ? 5 : 4;
  image.floats.reserve(coded.size() / stored * (stored - 1));
  for (std::size_t i = 0; i + stored <= coded.size(); i += stored) {
    for (std::size_t c = 0; c < 3; ++c)
      image.floats.push_back(static_cast<float>(std::ldexp(coded[i + c], coded[i + 3] - 127 - 8)));
    if (info.alpha) image.floats.push_back(static_cast<float>(coded[i + 4]) / 255.0F);
  }
  return image;
}

}  // namespace

RleInfo inspect_rle(std::string_view bytes) {
  RleBytes in(bytes);
  Header header = read_header(in);
  follow(in, header, NoCanvas{});
  return header.info;
}

Image detail::read_rle(std::string_view bytes) {
  RleBytes in(bytes);
  Header header = read_header(in);
  const RleInfo& info = header.info;
  if (!info.exponential && header.colors != 1 && header.colors != 3)
    throw ImageError(fmt::format("{} colour channels; 1 or 3 can be read", header.colors));
  // Blank rows cost nothing, so no length is too short; but nobody keeps a large picture in some bytes.
  constexpr std::int64_t kSmall = std::int64_t{1} << 24;
  check_size(info.width, info.height, std::max(kSmall, static_cast<std::int64_t>(bytes.size()) * 4096));

  const int samples = header.colors + (info.alpha ? 1 : 0);
  const std::size_t pixels = static_cast<std::size_t>(info.width) * static_cast<std::size_t>(info.height);
  std::vector<std::uint8_t> data(pixels * static_cast<std::size_t>(samples));
  if (std::any_of(header.background, header.background + header.colors,
                  [](std::uint8_t b) { return b != 0; }))
    for (std::size_t i = 0; i < pixels; ++i)
      std::copy_n(header.background, header.colors, &data[i * static_cast<std::size_t>(samples)]);
  follow(in, header, ByteCanvas{data.data(), info.width, header.colors, samples});
  if (!info.whole) throw ImageError(fmt::format("the data end in row {} of {}", info.rows, info.height));
  if (info.exponential) return from_exponential(data, info);

  Image image;
  image.width = info.width;
  image.height = info.height;
  image.channels = header.colors;
  image.has_alpha = info.alpha;
  image.bytes = std::move(data);
  return image;
}

}  // namespace rayshade
