// SPDX-License-Identifier: MIT
// A file that appears under its name only when it is whole.
//
// Bytes go to a hidden file beside the target (directory.h: temporary_name), which commit() renames; without
// commit() it disappears with the object. Standard output ("-"), pipes and devices cannot be renamed and are
// written directly. A full disk is an error with its reason, at the write or at the latest in commit().
#pragma once

#include <cstdint>
#include <string>

#include "rayshade/image/sink.h"

namespace rayshade {

class OutputFile : public Sink {
 public:
  enum class Mode : std::uint8_t {
    kReplace,
    kAppend,  ///< starts with the target's present content, if there is any
  };

  /// Throws WriteError where the directory or the special file cannot be written.
  explicit OutputFile(std::string path, Mode mode = Mode::kReplace);
  ~OutputFile() override;
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(const void* data, std::size_t size) override;
  using Sink::write;

  /// Marks the end of a whole frame: commit_marked() drops what follows the last mark.
  void mark() { mark_ = written_; }
  std::uint64_t written() const override { return written_; }
  bool can_overwrite() const override { return !direct(); }
  void overwrite(std::uint64_t offset, const void* data, std::size_t size) override;

  /// Flushes, checks and renames. Afterwards nothing more can be written. Throws WriteError; the target is
  /// then as it was before.
  void commit() { commit_as(path_); }
  /// Commits under another name in any directory of the same file system: partial_name(path) for unfinished
  /// pictures.
  void commit_as(const std::string& path);
  /// Commits the content up to the last mark(); false, and no file, if there is no mark.
  bool commit_marked(const std::string& path);

  const std::string& path() const { return path_; }
  /// True for standard output, pipes and devices: what was written cannot be taken back, commit() only
  /// flushes.
  bool direct() const { return temporary_.empty(); }

 private:
  void open_temporary();
  void copy_present_content();
  void flush();
  void discard() noexcept;

  std::string path_;       // as given, for messages
  std::string target_;     // with symbolic links followed
  std::string temporary_;  // empty where bytes go out directly
  std::string buffer_;
  int file_ = -1;
  bool owns_file_ = true;
  std::uint64_t written_ = 0, mark_ = 0;
};

}  // namespace rayshade
