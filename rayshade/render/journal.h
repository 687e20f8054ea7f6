// SPDX-License-Identifier: MIT
// The journal beside a picture: which blocks are finished, so that an interrupted rendering goes on instead
// of starting again, on any number of threads or ranks and with blocks of any size.
//
// A file of sealed records (image/record.h), only ever appended to: first what it is a journal of, then the
// finished blocks and frames, and for longer runs the scene's text. Each is one write, so that a killed
// process loses none that it finished; what a power cut may lose is bounded by sync(). A torn or damaged
// record is noticed and passed over, all whole ones are used. Each pixel is recorded once; the blocks of
// frames whose pictures are written are dropped: the file is no larger than the pictures still to be written,
// plus about 70 bytes a block and two mebibytes.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rayshade/image/block_record.h"
#include "rayshade/image/frame_buffer.h"

namespace rayshade {

/// What determines the pixels of a rendering.
struct JournalIdentity {
  std::string scene_hash;
  /// Names and values of all else: "samples" and "3".
  std::vector<std::pair<std::string, std::string>> values;
  /// Gives the scene's canonical text, to tell what changed in it; empty where it is too large for that. It
  /// takes as long as a small picture, so it is asked for only when it is needed.
  std::function<std::string()> scene_text = {};
};

/// The first value that changed, for people ("samples was 2, is now 4"); empty where none did.
std::string first_difference(const JournalIdentity& was, const JournalIdentity& now);

/// The journal cannot be opened.
struct JournalError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// It belongs to a process that is running.
struct JournalBusy : JournalError {
  using JournalError::JournalError;
};

class Journal {
 public:
  enum class Found : std::uint8_t {
    kNothing,   ///< there was no journal
    kSame,      ///< one of this rendering
    kAnother,   ///< one of another rendering: difference()
    kUnusable,  ///< a file that does not begin as a journal does, or whose beginning is damaged
  };

  /// Opens the journal, or creates an empty one, and locks it against other processes. Throws JournalError.
  /// `picture` tells size and form of the frames. Nothing is written before begin() or go_on().
  Journal(std::string path, JournalIdentity identity, const FrameBuffer& picture);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  const std::string& path() const { return path_; }
  Found found() const { return found_; }
  const std::string& difference() const { return difference_; }
  /// Bytes between whole records that are none, of a journal found; a torn end included.
  std::uint64_t damaged_bytes() const { return damaged_; }

  /// Starts an empty journal in the place of what was found. Throws JournalError.
  void begin();
  /// Takes up the one found (kSame). A torn end is cut off. Throws JournalError.
  void go_on();

  /// Puts what is recorded of a frame into the picture. Returns the number of blocks.
  std::int64_t load(int frame, FrameBuffer& picture) const;
  /// The size of a finished frame's picture file; nothing where the frame is not recorded as finished.
  std::optional<std::uint64_t> finished(int frame) const;

  /// Records those pixels of a block that `picture` does not have yet. From any thread. Never throws: the
  /// first failure ends the recording and is told by failure().
  void record(int frame, const FrameBuffer& picture, const EncodedBlock& block) noexcept;
  /// Records that a frame's picture file of so many bytes is written, and drops the frame's blocks. Not while
  /// others record. Never throws.
  void finish_frame(int frame, std::uint64_t file_bytes) noexcept;

  /// Records the scene's text, so that a later run can tell what changed in it; the first time only. Never
  /// throws.
  void record_scene() noexcept;
  /// What was recorded is on the disk afterwards. Does nothing where nothing is new.
  void sync() noexcept;
  /// Why nothing is recorded any more ("No space left on device"); empty while all is well.
  std::string failure() const;
  /// The pictures are complete: the journal disappears.
  void remove() noexcept;

 private:
  struct Place {
    std::uint64_t offset, length;  ///< of a payload
  };
  void open_and_lock();
  void scan();
  void take(const Record& record, std::uint64_t offset);
  void append(const std::string& record);
  void fail(const std::string& reason);
  void rewrite();
  void drop_unused_rewrite();
  std::string other_path() const { return path_ + ".new"; }
  std::string read(std::uint64_t offset, std::uint64_t length) const;

  std::string path_;
  JournalIdentity identity_;
  PixelStorage storage_;
  std::size_t layers_;
  std::int64_t width_, height_;
  std::uint64_t picture_bytes_;
  Found found_ = Found::kNothing;
  std::string difference_;
  int file_ = -1;
  std::uint64_t size_ = 0, damaged_ = 0;
  std::multimap<int, Place> blocks_;
  std::map<int, std::uint64_t> finished_;
  std::string scene_record_;  ///< as it is in the file; empty where it is not
  std::atomic<bool> unsynced_{false};
  std::atomic<bool> unsynced_name_{false};  ///< of the folder's entry
  mutable std::mutex mutex_;                ///< of appending and failure_
  std::string failure_;
};

}  // namespace rayshade
