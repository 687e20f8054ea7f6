// SPDX-License-Identifier: MIT
// What a run keeps on disk for the case that it is interrupted: the journal of finished blocks, and the
// unfinished picture.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "rayshade/cli/pictures.h"
#include "rayshade/render/journal.h"

namespace rayshade {

class KeptWork {
 public:
  using Say = std::function<void(const std::string&)>;
  /// `say` is for warnings, `note` for what -q silences.
  KeptWork(const Options& options, PictureOutput& output, Say say, Say note)
      : options_(options), output_(output), say_(std::move(say)), note_(std::move(note)) {}

  /// Opens the journal of the picture of this name, where one is kept. Throws RenderError where -c cannot be
  /// obeyed or another process is at this picture.
  void open(const std::string& picture_name, const std::function<JournalIdentity()>& identity,
            std::size_t scene_nodes, const FrameBuffer& picture);

  /// Whether the file of this frame is written already, by an earlier run.
  bool finished_before(int frame);
  /// Puts what an earlier run recorded into the picture.
  void load(int frame, FrameBuffer& picture);
  /// As FrameJob::keep; empty without a journal.
  std::function<void(const EncodedBlock&)> keeper(int frame, const FrameBuffer& picture);
  /// A few times per second while a frame is rendered.
  void tend(int frame, const FrameBuffer& picture);
  /// Everything is on the disk afterwards.
  void save();
  /// The frame's file is written.
  void finish_frame(int frame);
  /// All files are written.
  void finish();
  /// How to go on, for the last line of a run that was stopped.
  std::string advice() const;

  std::uint64_t blocks_resumed() const { return static_cast<std::uint64_t>(blocks_); }
  std::uint64_t pixels_resumed() const { return static_cast<std::uint64_t>(pixels_); }
  int frames_resumed() const { return frames_; }

 private:
  using Clock = std::chrono::steady_clock;
  void complain_once();

  const Options& options_;
  PictureOutput& output_;
  Say say_, note_;
  std::unique_ptr<Journal> journal_;
  bool failure_told_ = false, partial_failed_ = false, resumed_ = false;
  Clock::time_point synced_ = Clock::now(), scene_due_ = synced_, partial_due_ = synced_;
  std::int64_t blocks_ = 0, pixels_ = 0;
  int frames_ = 0;
};

}  // namespace rayshade
