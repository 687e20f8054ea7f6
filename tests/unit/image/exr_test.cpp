// SPDX-License-Identifier: MIT
// EXR files, read back with the reference library.
#ifdef RAYSHADE_HAVE_OPENEXR

#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gtest/gtest.h>

#include <cstring>

#include "tests/unit/image/pictures.h"

namespace rayshade {
namespace {

class MemoryStream : public Imf::IStream {
 public:
  explicit MemoryStream(const std::string& bytes) : Imf::IStream("memory"), bytes_(bytes) {}
  bool read(char out[], int count) override {
    const auto size = static_cast<std::size_t>(count);
    if (size > bytes_.size() - position_) throw std::runtime_error("read beyond the end");
    std::memcpy(out, bytes_.data() + position_, size);
    position_ += size;
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override { position_ = position; }

 private:
  const std::string& bytes_;
  std::uint64_t position_ = 0;
};

// Hands bytes on without letting them be replaced: the writer needs its temporary file.
class OneWaySink : public Sink {
 public:
  void write(const void* data, std::size_t size) override { memory_.write(data, size); }
  std::uint64_t written() const override { return memory_.written(); }
  const std::string& bytes() const { return memory_.bytes(); }

 private:
  MemorySink memory_;
};

struct Channel {
  Imf::PixelType type;
  std::vector<float> values;
};

Channel read_channel(const std::string& bytes, const char* name) {
  MemoryStream stream(bytes);
  Imf::InputFile file(stream, 0);
  const Imf::Channel* const channel = file.header().channels().findChannel(name);
  if (channel == nullptr) throw std::runtime_error(std::string("no channel ") + name);
  const Imath::Box2i window = file.header().dataWindow();
  const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
  Channel out{channel->type,
              std::vector<float>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
  Imf::FrameBuffer target;
  target.insert(name, Imf::Slice::Make(Imf::FLOAT, out.values.data(), window));
  file.setFrameBuffer(target);
  file.readPixels(window.min.y, window.max.y);
  return out;
}

constexpr std::int64_t kWidth = 37, kHeight = 41;

// Colours in a buffer with two layers, of large and of fractional numbers.
struct ExrPicture {
  explicit ExrPicture(const std::vector<double>& rgba);
  FrameBuffer buffer =
      test::make_buffer(FileFormat::kExr, kWidth, kHeight, {2.2, false}, {"depth.Z", "cost"});
};

ExrPicture::ExrPicture(const std::vector<double>& rgba) {
  std::vector<float> depth(static_cast<std::size_t>(kWidth * kHeight)), cost(depth.size());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    depth[i] = 1e10F + static_cast<float>(i);
    cost[i] = static_cast<float>(i) / 7;
  }
  buffer.put(PixelBlock{0, 0, kWidth, kHeight, rgba, {depth, cost}});
}

TEST(Exr, ColorsAndLayersComeBack) {
  const std::vector<double> rgba = test::mixed_pixels(kWidth, kHeight);
  const ExrPicture picture(rgba);
  const FrameBuffer& buffer = picture.buffer;
  for (const bool half : {false, true}) {
    PictureInfo info;
    info.exr_half = half;
    info.min_x = 100;
    info.min_y = 50;
    info.screen_width = 640;
    info.screen_height = 480;
    const std::string file = test::written(buffer, FileFormat::kExr, info);
    EXPECT_EQ(file, test::written(buffer, FileFormat::kExr, info));
    static constexpr const char* kNames[] = {"R", "G", "B", "A"};
    for (std::size_t c = 0; c < 4; ++c) {
      const Channel channel = read_channel(file, kNames[c]);
      EXPECT_EQ(channel.type, half ? Imf::HALF : Imf::FLOAT);
      ASSERT_EQ(channel.values.size(), rgba.size() / 4);
      for (std::size_t i = 0; i < channel.values.size(); ++i) {
        const auto linear = static_cast<float>(rgba[4 * i + c]);
        ASSERT_EQ(channel.values[i], half ? static_cast<float>(Imath::half(linear)) : linear)
            << kNames[c] << i;
      }
    }
    const Channel depth = read_channel(file, "depth.Z"), cost = read_channel(file, "cost");
    EXPECT_EQ(depth.type, Imf::FLOAT);
    for (std::size_t i = 0; i < cost.values.size(); ++i) {
      ASSERT_EQ(cost.values[i], static_cast<float>(i) / 7);
      ASSERT_EQ(depth.values[i], 1e10F + static_cast<float>(i));
    }
    MemoryStream stream(file);
    const Imf::InputFile in(stream, 0);
    EXPECT_EQ(in.header().dataWindow(), Imath::Box2i({100, 50}, {136, 90}));
    EXPECT_EQ(in.header().displayWindow(), Imath::Box2i({0, 0}, {639, 479}));
  }
}

TEST(Exr, ProvenanceBecomesAttributes) {
  const ExrPicture picture(test::mixed_pixels(kWidth, kHeight));
  const FrameBuffer& buffer = picture.buffer;
  PictureInfo info;
  info.alpha = false;
  info.provenance = {{"Software", "rayshade"}, {"compression", "none"}, {"Seed", "3"}};
  const std::string file = test::written(buffer, FileFormat::kExr, info);
  MemoryStream stream(file);
  const Imf::InputFile in(stream, 0);
  EXPECT_EQ(in.header().typedAttribute<Imf::StringAttribute>("rayshade:Software").value(), "rayshade");
  EXPECT_EQ(in.header().typedAttribute<Imf::StringAttribute>("rayshade:compression").value(), "none");
  EXPECT_EQ(in.header().channels().findChannel("A"), nullptr);
}

TEST(Exr, OneWayOutputGetsTheSameBytes) {
  const ExrPicture picture(test::mixed_pixels(kWidth, kHeight));
  const FrameBuffer& buffer = picture.buffer;
  OneWaySink sink;
  write_picture(buffer, FileFormat::kExr, {}, sink);
  EXPECT_EQ(sink.bytes(), test::written(buffer, FileFormat::kExr));
}

// OpenEXR swallows exceptions while it closes a file, which is when the table of rows is written.
TEST(Exr, AnErrorInTheLastStepIsReported) {
  class NoSecondTime : public MemorySink {
   public:
    void overwrite(std::uint64_t, const void*, std::size_t) override { throw WriteError("the disk is gone"); }
  };
  const ExrPicture picture(test::mixed_pixels(kWidth, kHeight));
  const FrameBuffer& buffer = picture.buffer;
  NoSecondTime sink;
  EXPECT_THROW(write_picture(buffer, FileFormat::kExr, {}, sink), WriteError);
}

}  // namespace
}  // namespace rayshade

#endif
