// SPDX-License-Identifier: MIT
// OpenEXR: linear colours as half or float, layers as float channels, provenance as attributes.
#include "rayshade/image/writers.h"

#ifdef RAYSHADE_HAVE_OPENEXR

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>

namespace rayshade::detail {
namespace {

/// A temporary file without a name for sinks that cannot be overwritten.
class Spool : public Sink {
 public:
  Spool() : file_(std::tmpfile(), &std::fclose) {
    if (!file_) throw WriteError("cannot make a temporary file for the EXR picture");
  }
  void write(const void* data, std::size_t size) override {
    if (std::fwrite(data, 1, size, file_.get()) != size) throw WriteError("cannot write a temporary file");
    written_ += size;
  }
  bool can_overwrite() const override { return true; }
  void overwrite(std::uint64_t offset, const void* data, std::size_t size) override {
    if (std::fseek(file_.get(), static_cast<long>(offset), SEEK_SET) != 0 ||
        std::fwrite(data, 1, size, file_.get()) != size || std::fseek(file_.get(), 0, SEEK_END) != 0)
      throw WriteError("cannot write a temporary file");
  }
  std::uint64_t written() const override { return written_; }

  void send(Sink& sink) {
    if (std::fflush(file_.get()) != 0) throw WriteError("cannot write a temporary file");
    std::rewind(file_.get());
    std::vector<char> chunk(std::size_t{1} << 16);
    for (std::uint64_t left = written_; left > 0;) {
      const std::size_t count = std::min<std::uint64_t>(left, chunk.size());
      if (std::fread(chunk.data(), 1, count, file_.get()) != count)
        throw WriteError("cannot read a temporary file");
      sink.write(chunk.data(), count);
      left -= count;
    }
  }

 private:
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  std::uint64_t written_ = 0;
};

/// A Sink in the shape that OpenEXR wants. The library swallows what is thrown while it closes a file, so the
/// first error is kept.
class SinkStream : public Imf::OStream {
 public:
  explicit SinkStream(Sink& sink) : Imf::OStream("picture"), sink_(sink), start_(sink.written()) {}

  void write(const char data[], int count) override {
    if (error_) std::rethrow_exception(error_);
    try {
      const std::size_t size = static_cast<std::size_t>(count);
      const std::uint64_t end = sink_.written() - start_;
      const std::size_t inside = static_cast<std::size_t>(std::min<std::uint64_t>(size, end - position_));
      if (inside > 0) sink_.overwrite(start_ + position_, data, inside);
      if (inside < size) sink_.write(data + inside, size - inside);
      position_ += size;
    } catch (...) {
      error_ = std::current_exception();
      throw;
    }
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = std::min(position, sink_.written() - start_); }

  void check() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  Sink& sink_;
  std::uint64_t start_, position_ = 0;
  std::exception_ptr error_;
};

Imf::Header make_header(const FrameBuffer& picture, const PictureInfo& info, int channels) {
  const auto integer = [](std::int64_t v) { return static_cast<int>(v); };
  const std::int64_t screen_width = info.screen_width > 0 ? info.screen_width : picture.width();
  const std::int64_t screen_height = info.screen_height > 0 ? info.screen_height : picture.height();
  const Imath::V2i corner(integer(info.min_x), integer(info.min_y));
  const Imath::Box2i screen(Imath::V2i(0, 0),
                            Imath::V2i(integer(screen_width) - 1, integer(screen_height) - 1));
  const Imath::Box2i window(corner,
                            corner + Imath::V2i(integer(picture.width()) - 1, integer(picture.height()) - 1));
  Imf::Header header(screen, window);
  header.compression() = Imf::ZIP_COMPRESSION;
  static constexpr const char* kNames[4] = {"R", "G", "B", "A"};
  for (int c = 0; c < channels; ++c)
    header.channels().insert(kNames[c], Imf::Channel(info.exr_half ? Imf::HALF : Imf::FLOAT));
  for (const std::string& layer : picture.layers()) header.channels().insert(layer, Imf::Channel(Imf::FLOAT));
  // The prefix keeps keys apart from attributes that have a meaning and a type of their own.
  for (const auto& [key, value] : info.provenance)
    header.insert(("rayshade:" + key).substr(0, 255), Imf::StringAttribute(value));
  return header;
}

void write_to(const FrameBuffer& picture, const PictureInfo& info, Sink& sink) {
  const std::size_t width = static_cast<std::size_t>(picture.width());
  const int channels = info.alpha ? 4 : 3;
  std::vector<float> row(4 * width);
  std::vector<Imath::half> halves(info.exr_half ? row.size() : 0);
  std::vector<std::vector<float>> layers(picture.layers().size(), std::vector<float>(width));
  SinkStream stream(sink);
  {
    Imf::OutputFile file(stream, make_header(picture, info, channels), 0);
    // One row of memory stands for every row of the file: its stride is 0. Columns count from the window's
    // corner.
    Imf::FrameBuffer slices;
    const auto slice = [&](Imf::PixelType type, void* data, std::size_t first, std::size_t size,
                           std::size_t stride) {
      char* const base = static_cast<char*>(data) + first * size;
      return Imf::Slice(type,
                        base - static_cast<std::ptrdiff_t>(info.min_x) * static_cast<std::ptrdiff_t>(stride),
                        stride, 0);
    };
    static constexpr const char* kNames[4] = {"R", "G", "B", "A"};
    for (int c = 0; c < channels; ++c) {
      const auto first = static_cast<std::size_t>(c);
      slices.insert(kNames[c], info.exr_half ? slice(Imf::HALF, halves.data(), first, 2, 8)
                                             : slice(Imf::FLOAT, row.data(), first, 4, 16));
    }
    for (std::size_t i = 0; i < layers.size(); ++i)
      slices.insert(picture.layers()[i], slice(Imf::FLOAT, layers[i].data(), 0, 4, 4));
    file.setFrameBuffer(slices);
    for (std::int64_t y = 0; y < picture.height(); ++y) {
      picture.read_row(y, reinterpret_cast<std::uint8_t*>(row.data()));
      for (std::size_t i = 0; i < halves.size(); ++i) halves[i] = Imath::half(row[i]);
      for (std::size_t i = 0; i < layers.size(); ++i)
        picture.read_layer_row(static_cast<int>(i), y, layers[i].data());
      file.writePixels(1);
    }
  }
  stream.check();
}

}  // namespace

void write_exr(const FrameBuffer& picture, const PictureInfo& info, Sink& sink) {
  try {
    if (sink.can_overwrite()) return write_to(picture, info, sink);
    Spool spool;
    write_to(picture, info, spool);
    spool.send(sink);
  } catch (const WriteError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw WriteError(std::string("EXR: ") + error.what());
  }
}

}  // namespace rayshade::detail

#else

namespace rayshade::detail {

void write_exr(const FrameBuffer&, const PictureInfo&, Sink&) {
  throw FormatError("OpenEXR was left out of this build; use pfm for floating-point pictures");
}

}  // namespace rayshade::detail

#endif
