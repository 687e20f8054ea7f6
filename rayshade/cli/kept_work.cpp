// SPDX-License-Identifier: MIT
#include "rayshade/cli/kept_work.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdio>

#include "rayshade/render/renderer.h"

namespace rayshade {
namespace {

/// What a power cut may cost, in seconds of rendering.
constexpr std::chrono::seconds kBetweenSyncs{5};
/// The scene's text takes up to ten microseconds a node to make. It is recorded when the run has taken twenty
/// times as long, so that small pictures of large scenes do not pay for it; at once where that is nothing.
constexpr std::chrono::microseconds kBeforeScenePerNode{200};
constexpr std::chrono::milliseconds kAtOnce{20};

/// Pipes and devices cannot be gone on with.
bool is_file_or_new(const std::string& name) {
  struct stat info {};
  return stat(name.c_str(), &info) != 0 || S_ISREG(info.st_mode);
}

}  // namespace

void KeptWork::open(const std::string& name, const std::function<JournalIdentity()>& identity,
                    std::size_t scene_nodes, const FrameBuffer& picture) {
  if (options_.no_journal) return;
  if (name == "-" || !is_file_or_new(name)) {
    if (options_.resume)
      throw RenderError("-c needs the name of a picture file: -O, or outfile in the scene", {});
    return;
  }
  try {
    journal_ = std::make_unique<Journal>(name + ".journal", identity(), picture);
    const std::string& path = journal_->path();
    switch (journal_->found()) {
      case Journal::Found::kSame:
        journal_->go_on();
        resumed_ = true;
        if (journal_->damaged_bytes() > 0)
          note_(fmt::format("{} bytes of the journal '{}' are damaged; what is whole in it is used",
                            journal_->damaged_bytes(), path));
        note_(fmt::format("going on from the journal '{}'", path));
        return;
      case Journal::Found::kAnother:
        if (options_.resume) {
          throw RenderError(fmt::format("cannot continue: the journal '{}' is of another rendering ({}); "
                                        "without -c it is rendered anew",
                                        path, journal_->difference()),
                            {});
        }
        note_(fmt::format("the journal '{}' is of another rendering ({}): rendering from the start", path,
                          journal_->difference()));
        break;
      case Journal::Found::kUnusable:
        if (options_.resume) {
          throw RenderError(fmt::format("cannot continue: the beginning of the journal '{}' is damaged; "
                                        "without -c the picture is rendered anew",
                                        path),
                            {});
        }
        note_(fmt::format("the beginning of the journal '{}' is damaged: rendering from the start", path));
        break;
      case Journal::Found::kNothing:
        if (options_.resume)
          note_(fmt::format("there is no journal '{}' to continue from: rendering from the start", path));
        break;
    }
    journal_->begin();
    const auto before_scene = kBeforeScenePerNode * scene_nodes;
    scene_due_ = Clock::now() + before_scene;
    if (before_scene <= kAtOnce) journal_->record_scene();
  } catch (const JournalBusy& error) {
    throw RenderError(error.what(), {});
  } catch (const JournalError& error) {
    if (options_.resume) throw RenderError(error.what(), {});
    journal_.reset();
    say_(fmt::format("warning: {}; this run cannot be continued if it is interrupted", error.what()));
  }
}

bool KeptWork::finished_before(int frame) {
  if (!resumed_) return false;
  const std::optional<std::uint64_t> bytes = journal_->finished(frame);
  if (!bytes || output_.frame_file_bytes(frame) != bytes) return false;
  ++frames_;
  return true;
}

void KeptWork::load(int frame, FrameBuffer& picture) {
  if (!resumed_) return;
  blocks_ += journal_->load(frame, picture);
  pixels_ += picture.present();
}

std::function<void(const EncodedBlock&)> KeptWork::keeper(int frame, const FrameBuffer& picture) {
  if (!journal_) return {};
  return [this, frame, &picture](const EncodedBlock& block) { journal_->record(frame, picture, block); };
}

void KeptWork::tend(int frame, const FrameBuffer& picture) {
  const Clock::time_point now = Clock::now();
  if (journal_ && now >= scene_due_) journal_->record_scene();
  if (journal_ && now - synced_ >= kBetweenSyncs) {
    journal_->sync();
    complain_once();
    synced_ = now;
  }
  if (!options_.partial || partial_failed_ || now < partial_due_ || picture.present() == 0) return;
  try {
    output_.write_partial(picture, frame);
  } catch (const WriteError& error) {
    // The rendering itself may yet succeed.
    partial_failed_ = true;
    say_(fmt::format("warning: no partial pictures are kept: {}", error.what()));
  }
  // Large pictures take long to write: never more than a twentieth of the time.
  const Clock::time_point done = Clock::now();
  partial_due_ =
      done + std::max<Clock::duration>(std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(options_.partial_interval)),
                                       20 * (done - now));
}

void KeptWork::save() {
  if (!journal_) return;
  journal_->record_scene();
  journal_->sync();
  complain_once();
}

void KeptWork::finish_frame(int frame) {
  output_.remove_partial(frame);  // whichever run has left it
  if (!journal_) return;
  complain_once();
  // Frames one after the other in one file get their file at the very end: until then all are kept.
  if (const auto bytes = output_.frame_file_bytes(frame)) journal_->finish_frame(frame, *bytes);
}

void KeptWork::finish() {
  if (journal_) journal_->remove();
}

std::string KeptWork::advice() const {
  if (!journal_ || !journal_->failure().empty()) return {};
  return fmt::format("; the same command goes on from there (journal '{}')", journal_->path());
}

void KeptWork::complain_once() {
  const std::string failure = journal_->failure();
  if (failure.empty() || failure_told_) return;
  failure_told_ = true;
  say_(fmt::format("warning: cannot write the journal '{}': {}; what follows cannot be continued from",
                   journal_->path(), failure));
}

}  // namespace rayshade
