// SPDX-License-Identifier: MIT
// Where the frames of a run go: one file, numbered files, or frames one after the other; beside it layers,
// cost maps and partial pictures.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rayshade/cli/options.h"
#include "rayshade/image/format.h"
#include "rayshade/image/frame_buffer.h"
#include "rayshade/image/output_file.h"
#include "rayshade/image/writer.h"

namespace rayshade {

class PictureOutput {
 public:
  /// `name`: "-" is standard output. Throws UsageError for combinations that cannot be (several frames in one
  /// PNG, options of one format with another), FormatError for unknown formats.
  PictureOutput(const Options& options, const RenderSettings& settings, std::string name);

  FrameBufferOptions frame_buffer_options(std::uint64_t memory_limit) const;
  FileFormat format() const { return format_; }
  /// A tag for every picture: what determines it.
  void set_provenance(std::vector<std::pair<std::string, std::string>> tags) { tags_ = std::move(tags); }

  /// Before hours are spent on it: throws WriteError where the (first) picture cannot be written.
  void check_writable() const;
  /// Writes a finished frame (and its layers and cost map).
  void write_frame(const FrameBuffer& picture, int frame);
  /// Writes what is there of a frame beside the real name; nothing where frames go to standard output.
  /// Returns the name of the file, empty if there is none.
  std::string write_partial(const FrameBuffer& picture, int frame);
  /// The same at the end of a run that was stopped in this frame: where frames go into one file, those that
  /// are finished stand before it. Nothing more can be written afterwards.
  std::string write_stopped(const FrameBuffer& picture, int frame);
  /// Removes the file of write_partial, if there is one.
  void remove_partial(int frame);
  /// The size of this frame's file; nothing where it has none of its own (yet).
  std::optional<std::uint64_t> frame_file_bytes(int frame) const;
  /// The name of a file for this frame: `pattern` with the number of the frame, if it has a place for it.
  std::string file_name(const std::string& pattern, int frame) const;
  /// After the last frame: the file of appended frames gets its name.
  void finish();
  /// Before anything is written: removes the hidden files of these pictures, and of what is kept of
  /// unfinished ones, that killed runs left behind.
  void remove_leftovers() const;

 private:
  PictureInfo info(int frame) const;
  void write_layers(const FrameBuffer& picture, int frame);
  void write_cost_map(const FrameBuffer& picture, int frame);

  const Options& options_;
  const RenderSettings& settings_;
  std::string name_;
  FileFormat format_ = FileFormat::kPng8;
  bool numbered_ = false, appended_ = false, alpha_ = false;
  std::vector<std::pair<std::string, std::string>> tags_;
  std::unique_ptr<OutputFile> appending_;
};

/// "a/b.ext" and "depth" -> "a/b.depth.ext".
std::string with_infix(const std::string& path, const std::string& infix);

}  // namespace rayshade
