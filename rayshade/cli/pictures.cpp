// SPDX-License-Identifier: MIT
#include "rayshade/cli/pictures.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>

#include "rayshade/image/directory.h"
#include "rayshade/image/layer_picture.h"

namespace rayshade {
namespace {

constexpr const char* kDataLayers[] = {"depth.Z", "normal.X", "normal.Y", "normal.Z", "object", "samples"};
constexpr const char* kCostLayers[] = {"tests", "bounds_tests", "microseconds", "rays", "tree_rays"};

bool is_rle(FileFormat format) { return format == FileFormat::kRle || format == FileFormat::kRleExponential; }

bool ends_with_exr(const std::string& name) { return format_by_suffix(name) == FileFormat::kExr; }

}  // namespace

std::string with_infix(const std::string& path, const std::string& infix) {
  const std::size_t slash = path.rfind('/');
  const std::size_t dot = path.rfind('.');
  if (dot == std::string::npos || (slash != std::string::npos && dot < slash)) return path + "." + infix;
  return path.substr(0, dot) + "." + infix + path.substr(dot);
}

PictureOutput::PictureOutput(const Options& options, const RenderSettings& settings, std::string name)
    : options_(options), settings_(settings), name_(std::move(name)) {
  std::optional<FileFormat> chosen;
  if (options.format)
    chosen = format_by_name(*options.format);
  else if (name_ != "-")
    chosen = format_by_suffix(name_);
  if (options.exponential) {
    if (chosen && !is_rle(*chosen)) {
      throw UsageError(fmt::format("-e writes an RLE picture, not {}", format_name(*chosen)));
    }
    chosen = FileFormat::kRleExponential;
  }
  format_ = chosen.value_or(FileFormat::kPng8);
  // RLE and EXR carry alpha unless told not to; PNG only if asked: viewers show it as holes.
  alpha_ = has_alpha(format_) && ((is_rle(format_) || format_ == FileFormat::kExr) == options.alpha);
  if (options.sample_map) alpha_ = has_alpha(format_);
  numbered_ = name_ != "-" && is_numbered(name_);
  appended_ = settings.frames > 1 && !numbered_;
  if (appended_ && !can_append(format_)) {
    throw UsageError(
        fmt::format("{} frames do not fit into one {} file: put the number of the frame into the name, as in "
                    "-O out.%04d.{}",
                    settings.frames, format_name(format_), format_ == FileFormat::kExr ? "exr" : "png"));
  }
  for (const auto& extra : {options.layers, options.cost_map, options.fas_dump}) {
    if (extra && settings.frames > 1 && !is_numbered(*extra)) {
      throw UsageError(fmt::format(
          "'{}': with several frames the name needs the number of the frame, as in %04d", *extra));
    }
  }
}

FrameBufferOptions PictureOutput::frame_buffer_options(std::uint64_t memory_limit) const {
  FrameBufferOptions out;
  out.width = settings_.window_width();
  out.height = settings_.window_height();
  out.storage = storage_of(format_);
  out.encoding = {options_.gamma, options_.srgb};
  if (options_.layers) out.layers.insert(out.layers.end(), std::begin(kDataLayers), std::end(kDataLayers));
  if (options_.cost_map) out.layers.insert(out.layers.end(), std::begin(kCostLayers), std::end(kCostLayers));
  out.spill_threshold = std::min(out.spill_threshold, memory_limit / 2);
  return out;
}

PictureInfo PictureOutput::info(int frame) const {
  PictureInfo out;
  out.min_x = settings_.min_x;
  out.min_y = settings_.min_y;
  out.screen_width = settings_.width;
  out.screen_height = settings_.height;
  out.alpha = alpha_;
  out.tag_encoding = options_.srgb || options_.gamma != 1;
  out.provenance = tags_;
  if (settings_.frames > 1 || settings_.first_frame != 0)
    out.provenance.emplace_back("Frame", fmt::format("{}", frame));
  return out;
}

std::string PictureOutput::file_name(const std::string& pattern, int frame) const {
  return is_numbered(pattern) ? numbered_name(pattern, frame) : pattern;
}

void PictureOutput::check_writable() const {
  if (name_ == "-") return;
  const std::string first = file_name(name_, settings_.first_frame);
  struct stat info {};
  // Who reads from a pipe would take the end of a trial for that of the picture.
  if (stat(first.c_str(), &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode)) return;
  const OutputFile trial(first);
}

void PictureOutput::write_frame(const FrameBuffer& picture, int frame) {
  if (appended_) {
    if (!appending_) appending_ = std::make_unique<OutputFile>(name_);
    write_picture(picture, format_, info(frame), *appending_);
    appending_->mark();
  } else {
    OutputFile file(name_ == "-" ? name_ : file_name(name_, frame));
    write_picture(picture, format_, info(frame), file);
    file.commit();
  }
  write_layers(picture, frame);
  write_cost_map(picture, frame);
}

std::string PictureOutput::write_partial(const FrameBuffer& picture, int frame) {
  if (name_ == "-") return {};
  std::string partial = partial_name(file_name(name_, frame));
  OutputFile file(partial);
  if (file.direct()) return {};
  write_picture(picture, format_, info(frame), file);
  file.commit();
  return partial;
}

std::string PictureOutput::write_stopped(const FrameBuffer& picture, int frame) {
  if (!appended_) return write_partial(picture, frame);
  if (!appending_) appending_ = std::make_unique<OutputFile>(name_);
  if (appending_->direct()) {
    appending_->commit();  // what has gone out are whole frames
    return write_partial(picture, frame);
  }
  std::string partial = partial_name(name_);
  write_picture(picture, format_, info(frame), *appending_);
  appending_->commit_as(partial);
  appending_.reset();
  return partial;
}

void PictureOutput::remove_leftovers() const {
  // A killed run was at one frame; a name for each of a million would cost more than the file that stays.
  constexpr int kFrames = 10'000;
  if (name_ == "-") return;
  std::vector<std::string> files;
  for (int i = 0; i < (numbered_ ? std::min(settings_.frames, kFrames) : 1); ++i) {
    files.push_back(file_name(name_, settings_.first_frame + i));
    files.push_back(partial_name(files.back()));
  }
  rayshade::remove_leftovers(files);
}

void PictureOutput::remove_partial(int frame) {
  if (name_ != "-") unlink(partial_name(file_name(name_, frame)).c_str());
}

std::optional<std::uint64_t> PictureOutput::frame_file_bytes(int frame) const {
  struct stat info {};
  if (name_ == "-" || appended_ || stat(file_name(name_, frame).c_str(), &info) != 0) return {};
  return static_cast<std::uint64_t>(info.st_size);
}

void PictureOutput::finish() {
  if (appending_) appending_->commit();
  appending_.reset();
}

void PictureOutput::write_layers(const FrameBuffer& picture, int frame) {
  if (!options_.layers) return;
  const std::string name = file_name(*options_.layers, frame);
  if (ends_with_exr(name)) {
    // One file with the colours and all layers; colours need floats, so it is written from a float picture
    // only.
    if (picture.storage() == PixelStorage::kFloat) {
      OutputFile file(name);
      write_picture(picture, FileFormat::kExr, info(frame), file);
      file.commit();
      return;
    }
    throw UsageError(
        "--layers to an EXR file needs an EXR or PFM picture: use -O with .exr, or --layers NAME.pfm or "
        ".png");
  }
  const bool png = format_by_suffix(name) == FileFormat::kPng8;
  for (const char* layer : kDataLayers) {
    OutputFile file(with_infix(name, layer));
    if (png)
      write_layer_png(picture, picture.layer_index(layer), {}, file);
    else
      write_layer_pfm(picture, picture.layer_index(layer), file);
    file.commit();
  }
}

void PictureOutput::write_cost_map(const FrameBuffer& picture, int frame) {
  if (!options_.cost_map) return;
  const std::string name = file_name(*options_.cost_map, frame);
  const std::size_t dot = name.rfind('.');
  const std::string stem =
      dot == std::string::npos || name.find('/', dot) != std::string::npos ? name : name.substr(0, dot);
  for (const char* layer : kCostLayers) {
    OutputFile numbers(fmt::format("{}.{}.pfm", stem, layer));
    write_layer_pfm(picture, picture.layer_index(layer), numbers);
    numbers.commit();
    OutputFile colors(fmt::format("{}.{}.png", stem, layer));
    FalseColorScale scale;
    scale.logarithmic = true;
    write_layer_png(picture, picture.layer_index(layer), scale, colors);
    colors.commit();
  }
}

}  // namespace rayshade
