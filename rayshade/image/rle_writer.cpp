// SPDX-License-Identifier: MIT
// Utah RLE as the original wrote it (shading.md 8.3): rows from the bottom, each channel of a row as runs,
// literal bytes and skipped zeros; the header's rows count from the bottom of the screen.
#include <fmt/format.h>

#include <algorithm>

#include "rayshade/image/rle.h"
#include "rayshade/image/writers.h"

namespace rayshade::detail {
namespace {

class RleStream {
 public:
  void word(std::size_t value) {
    bytes_ += static_cast<char>(value & 255);
    bytes_ += static_cast<char>(value >> 8);
  }
  void byte(int value) { bytes_ += static_cast<char>(value); }
  void text(const std::string& value) { bytes_ += value; }

  /// An instruction with its operand in the short form or in the long one. `operand` < 65,536.
  void instruction(int opcode, std::size_t operand) {
    if (operand < 256) {
      byte(opcode);
      byte(static_cast<int>(operand));
    } else {
      byte(opcode | kRleLong);
      byte(0);
      word(operand);
    }
  }

  void literal(const std::uint8_t* data, std::size_t count) {
    if (count == 0) return;
    instruction(kRleByteData, count - 1);
    bytes_.append(reinterpret_cast<const char*>(data), count);
    if (count % 2 != 0) byte(0);
  }

  void run(int value, std::size_t count) {
    instruction(kRleRunData, count - 1);
    word(static_cast<std::size_t>(value));
  }

  void send(Sink& sink) {
    sink.write(bytes_);
    bytes_.clear();
  }

 private:
  std::string bytes_;
};

void write_channel(const std::uint8_t* data, std::size_t count, int channel, RleStream& out) {
  while (count > 0 && data[count - 1] == 0) --count;  // zeros at the end need nothing
  if (count == 0) return;
  out.instruction(kRleSetColor, static_cast<std::size_t>(channel));
  // Below these lengths an instruction of its own costs more than it saves.
  constexpr std::size_t kShortestSkip = 5, kShortestRun = 7;
  std::size_t pending = 0;  // start of the literal bytes not yet written
  for (std::size_t i = 0; i < count;) {
    std::size_t end = i + 1;
    while (end < count && data[end] == data[i]) ++end;
    const std::size_t length = end - i;
    if (length >= (data[i] == 0 ? kShortestSkip : kShortestRun)) {
      out.literal(data + pending, i - pending);
      if (data[i] == 0) {
        out.instruction(kRleSkipPixels, length);
      } else {
        out.run(data[i], length);
      }
      pending = end;
    }
    i = end;
  }
  out.literal(data + pending, count - pending);
}

void write_header(const FrameBuffer& picture, const PictureInfo& info, int colors, RleStream& out) {
  const std::int64_t screen_height = info.screen_height > 0 ? info.screen_height : picture.height();
  const std::int64_t bottom = screen_height - info.min_y - picture.height();
  constexpr std::int64_t kLimit = 65535;
  if (picture.width() > kLimit || picture.height() > kLimit)
    throw WriteError(fmt::format("RLE files hold at most 65535 x 65535 pixels, not {} x {}", picture.width(),
                                 picture.height()));
  if (info.min_x < 0 || info.min_x > kLimit || bottom < 0 || bottom > kLimit)
    throw WriteError(fmt::format("RLE files cannot hold a window at ({}, {})", info.min_x, info.min_y));
  out.word(kRleMagic);
  out.word(static_cast<std::size_t>(info.min_x));
  out.word(static_cast<std::size_t>(bottom));
  out.word(static_cast<std::size_t>(picture.width()));
  out.word(static_cast<std::size_t>(picture.height()));
  out.byte(kRleClearFirst | (info.alpha ? kRleAlpha : 0) | kRleComment);
  out.byte(colors);
  out.byte(8);  // bits per sample
  out.byte(0);  // no colour map,
  out.byte(8);  // but the original wrote a length for it
  for (int i = 0; i < rle_background_bytes(colors); ++i) out.byte(0);

  std::string comments;
  const auto add = [&comments](const std::string& comment) {
    // The block's length is a 16-bit number; what does not fit is left out, whole.
    if (comments.size() + comment.size() + 1 <= 65534) comments.append(comment.c_str(), comment.size() + 1);
  };
  if (colors == 4) add("exponential_data");
  const ColorEncoding& encoding = picture.encoder().encoding();
  add(encoding.srgb ? std::string("color_encoding=sRGB") : fmt::format("display_gamma={}", encoding.gamma));
  for (const auto& [key, value] : info.provenance) {
    std::string comment = key;
    comment.append("=").append(value);
    std::replace(comment.begin(), comment.end(), '\0', ' ');
    add(comment);
  }
  out.word(comments.size());
  out.text(comments);
  if (comments.size() % 2 != 0) out.byte(0);
}

}  // namespace

void write_rle(const FrameBuffer& picture, const PictureInfo& info, Sink& sink) {
  const std::size_t stored = pixel_size(picture.storage());  // 4, or 5 with an exponent; alpha is the last
  const int colors = static_cast<int>(stored) - 1;
  RleStream out;
  write_header(picture, info, colors, out);

  const std::size_t width = static_cast<std::size_t>(picture.width());
  std::vector<std::uint8_t> row(picture.row_bytes()), channel(width);
  std::size_t lines = 0;  // rows to advance before the next one that has something in it
  for (std::int64_t y = picture.height() - 1; y >= 0; --y, ++lines) {
    picture.read_row(y, row.data());
    if (std::all_of(row.begin(), row.end(), [](std::uint8_t b) { return b == 0; })) continue;
    if (lines > 0) out.instruction(kRleSkipLines, lines);
    lines = 0;
    for (int c = info.alpha ? -1 : 0; c < colors; ++c) {
      const std::size_t from = c < 0 ? stored - 1 : static_cast<std::size_t>(c);
      for (std::size_t x = 0; x < width; ++x) channel[x] = row[x * stored + from];
      write_channel(channel.data(), width, c < 0 ? kRleAlphaChannel : c, out);
    }
    out.send(sink);
  }
  out.instruction(kRleEnd, 0);
  out.send(sink);
}

}  // namespace rayshade::detail
