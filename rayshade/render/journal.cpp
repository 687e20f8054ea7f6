// SPDX-License-Identifier: MIT
#include "rayshade/render/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "rayshade/image/directory.h"
#include "rayshade/render/scene_change.h"

namespace rayshade {
namespace {

/// Blocks of finished frames are dropped once they are so many bytes: small frames never pay for it.
constexpr std::uint64_t kDropAtOnce = 1 << 20;
std::string reason() { return std::strerror(errno); }

std::string identity_record(const JournalIdentity& identity) {
  RecordWriter out(RecordKind::kIdentity);
  out.text(identity.scene_hash);
  for (const auto& [name, value] : identity.values) {
    out.text(name);
    out.text(value);
  }
  return out.seal();
}

std::optional<JournalIdentity> read_identity(std::string_view payload) {
  RecordReader in(payload);
  JournalIdentity out;
  out.scene_hash = in.text();
  while (in.ok() && !in.rest().empty()) {
    const std::string_view name = in.text();
    out.values.emplace_back(name, in.text());
  }
  if (!in.ok()) return {};
  return out;
}

std::string frame_record(int frame, std::uint64_t file_bytes) {
  RecordWriter out(RecordKind::kFrame);
  out.number(std::int32_t{frame});
  out.number(file_bytes);
  return out.seal();
}

/// Whether the whole file is now locked by this process; true too where the file system has no locks.
bool lock(int file) {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  return fcntl(file, F_OFD_SETLK, &whole) == 0 || (errno != EAGAIN && errno != EACCES);
}

bool write_all(int file, std::string_view bytes, std::uint64_t offset) {
  while (!bytes.empty()) {
    const ssize_t done = pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(done));
    offset += static_cast<std::uint64_t>(done);
  }
  return true;
}

}  // namespace

std::string first_difference(const JournalIdentity& was, const JournalIdentity& now) {
  const auto value = [](const JournalIdentity& in, const std::string& name) -> const std::string* {
    const auto at = std::ranges::find(in.values, name, [](const auto& entry) { return entry.first; });
    return at == in.values.end() ? nullptr : &at->second;
  };
  for (const auto& [name, after] : now.values) {
    const std::string* before = value(was, name);
    if (!before) return fmt::format("{} was not set, is now {}", name, after);
    if (*before != after) return fmt::format("{} was {}, is now {}", name, *before, after);
  }
  for (const auto& [name, before] : was.values)
    if (!value(now, name)) return fmt::format("{} was {}, is now not set", name, before);
  return {};
}

Journal::Journal(std::string path, JournalIdentity identity, const FrameBuffer& picture)
    : path_(std::move(path)),
      identity_(std::move(identity)),
      storage_(picture.storage()),
      layers_(picture.layers().size()),
      width_(picture.width()),
      height_(picture.height()),
      picture_bytes_(static_cast<std::uint64_t>(width_ * height_) * recorded_pixel_size(storage_, layers_)) {
  open_and_lock();
  try {
    scan();
  } catch (...) {
    close(file_);
    throw;
  }
}

Journal::~Journal() {
  if (file_ >= 0) close(file_);
}

void Journal::open_and_lock() {
  // Who held the lock before may have put another file in this place, or removed it, meanwhile.
  for (;;) {
    file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file_ < 0) throw JournalError(fmt::format("cannot open the journal '{}': {}", path_, reason()));
    struct stat opened {
    }, named{};
    if (!lock(file_)) {
      close(file_);
      file_ = -1;
      throw JournalBusy(
          fmt::format("another process is rendering this picture: its journal '{}' is locked", path_));
    }
    if (fstat(file_, &opened) == 0 && stat(path_.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
        opened.st_dev == named.st_dev) {
      size_ = static_cast<std::uint64_t>(opened.st_size);
      return;
    }
    close(file_);
  }
}

std::string Journal::read(std::uint64_t offset, std::uint64_t length) const {
  std::string out(length, '\0');
  std::size_t have = 0;
  while (have < out.size()) {
    const ssize_t got = pread(file_, out.data() + have, out.size() - have, static_cast<off_t>(offset + have));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw JournalError(fmt::format("cannot read the journal '{}': {}", path_, reason()));
    if (got == 0) break;
    have += static_cast<std::size_t>(got);
  }
  out.resize(have);
  return out;
}

void Journal::scan() {
  if (size_ == 0) return;
  found_ = Found::kUnusable;
  std::uint64_t at = 0, whole_end = 0;
  // Damaged lengths under right checksums do not happen by chance; made by hand they could have the same
  // bytes summed over and over.
  std::uint64_t patience = 16 * size_ + (1 << 20);
  while (at < size_) {
    const std::optional<RecordHead> head = read_record_head(read(at, kRecordHead));
    if (head && head->length <= size_ - at - kRecordHead && head->length <= patience) {
      patience -= head->length;
      const std::string payload = read(at + kRecordHead, head->length);
      if (is_whole(*head, payload)) {
        if (at == 0) {
          const auto was = head->kind == RecordKind::kIdentity ? read_identity(payload) : std::nullopt;
          if (!was) return;
          difference_ = first_difference(*was, identity_);
          found_ =
              difference_.empty() && was->scene_hash == identity_.scene_hash ? Found::kSame : Found::kAnother;
          if (!difference_.empty()) return;
        } else {
          take({head->kind, payload, payload.size()}, at + kRecordHead);
        }
        damaged_ += at - whole_end;
        at += kRecordHead + payload.size();
        whole_end = at;
        continue;
      }
    }
    if (at == 0) return;
    // Not a record: on to the next place that may be the beginning of one.
    constexpr std::uint64_t kPiece = 1 << 20;
    for (++at; at < size_; at += kPiece - kRecordMagic.size()) {
      const std::string piece = read(at, std::min(kPiece, size_ - at));
      const std::size_t place = piece.find(kRecordMagic);
      if (place != std::string::npos) {
        at += place;
        break;
      }
    }
  }
  damaged_ += size_ - whole_end;
  size_ = whole_end;
  if (found_ == Found::kAnother) {
    const std::optional<Record> recorded = open_record(scene_record_);
    difference_ = recorded && identity_.scene_text
                      ? scene_difference(recorded->payload, identity_.scene_text())
                      : "the scene has changed";
  }
}

void Journal::take(const Record& record, std::uint64_t offset) {
  if (record.kind == RecordKind::kScene) {
    scene_record_ = read(offset - kRecordHead, kRecordHead + record.payload.size());
    return;
  }
  RecordReader in(record.payload);
  const int frame = in.number<std::int32_t>();
  if (record.kind == RecordKind::kBlock && !finished_.contains(frame)) {
    blocks_.emplace(frame, Place{offset, record.payload.size()});
  } else if (record.kind == RecordKind::kFrame) {
    const auto bytes = in.number<std::uint64_t>();
    if (!in.ok()) return;
    finished_[frame] = bytes;
    blocks_.erase(frame);
  }
}

void Journal::begin() {
  blocks_.clear();
  finished_.clear();
  scene_record_.clear();
  const std::string first = identity_record(identity_);
  if (ftruncate(file_, 0) != 0 || !write_all(file_, first, 0))
    throw JournalError(fmt::format("cannot write the journal '{}': {}", path_, reason()));
  size_ = first.size();
  unsynced_ = unsynced_name_ = true;
  drop_unused_rewrite();
}

void Journal::go_on() {
  if (ftruncate(file_, static_cast<off_t>(size_)) != 0)
    throw JournalError(fmt::format("cannot write the journal '{}': {}", path_, reason()));
  unsynced_name_ = true;  // its first run may have had no time for that
  drop_unused_rewrite();
}

/// A process killed within rewrite() leaves the new file behind. Whoever holds the lock may remove it.
void Journal::drop_unused_rewrite() { unlink(other_path().c_str()); }

std::int64_t Journal::load(int frame, FrameBuffer& picture) const {
  std::int64_t blocks = 0;
  const auto [first, last] = blocks_.equal_range(frame);
  for (auto place = first; place != last; ++place) {
    const auto record =
        decode_block_payload(read(place->second.offset, place->second.length), picture_bytes_);
    if (!record || record->frame != frame || record->storage != storage_ ||
        record->block.layers.size() != layers_ || record->block.x + record->block.width > width_ ||
        record->block.y + record->block.height > height_)
      continue;
    picture.put(record->block);
    ++blocks;
  }
  return blocks;
}

std::optional<std::uint64_t> Journal::finished(int frame) const {
  const auto at = finished_.find(frame);
  if (at == finished_.end()) return {};
  return at->second;
}

void Journal::fail(const std::string& why) {
  failure_ = why.empty() ? "unknown error" : why;
  // What stands before stays usable.
  if (ftruncate(file_, static_cast<off_t>(size_)) != 0) return;
}

void Journal::append(const std::string& record) {
  const std::lock_guard lock(mutex_);
  if (!failure_.empty()) return;
  if (!write_all(file_, record, size_)) return fail(reason());
  size_ += record.size();
  unsynced_.store(true, std::memory_order_relaxed);
}

void Journal::record(int frame, const FrameBuffer& picture, const EncodedBlock& block) noexcept {
  try {
    const std::int64_t had = picture.present(block.x, block.y, block.width, block.height);
    if (had == 0) return append(encode_block_record(frame, block, storage_));
    if (had == block.width * block.height) return;
    // Rendered in blocks of another size before: the runs of pixels that are new, row by row.
    for (std::int64_t y = block.y; y < block.y + block.height; ++y) {
      for (std::int64_t x = block.x; x < block.x + block.width;) {
        std::int64_t end = x;
        while (end < block.x + block.width && !picture.is_present(end, y)) ++end;
        if (end > x)
          append(encode_block_record(frame, cut_block(block, storage_, x, y, end - x, 1), storage_));
        x = std::max(end, x + 1);
      }
    }
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    if (failure_.empty()) fail(error.what());
  }
}

void Journal::finish_frame(int frame, std::uint64_t file_bytes) noexcept {
  try {
    append(frame_record(frame, file_bytes));
    finished_[frame] = file_bytes;
    blocks_.erase(frame);
    if (size_ >= kDropAtOnce) rewrite();
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    if (failure_.empty()) fail(error.what());
  }
}

/// The journal without the blocks of finished frames, in a new file that takes the old one's place.
void Journal::rewrite() {
  if (!blocks_.empty()) return;  // of a later frame, recorded by an earlier run: its turn comes
  const std::string other = other_path();
  std::string bytes = identity_record(identity_) + scene_record_;
  for (const auto& [frame, size] : finished_) bytes += frame_record(frame, size);
  const int file = open(other.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) return;  // the old one is as right, only larger
  if (!lock(file) || !write_all(file, bytes, 0) || fdatasync(file) != 0 ||
      rename(other.c_str(), path_.c_str()) != 0) {
    close(file);
    unlink(other.c_str());
    return;
  }
  close(file_);
  file_ = file;
  size_ = bytes.size();
  unsynced_name_ = true;
}

void Journal::record_scene() noexcept {
  if (!scene_record_.empty() || !identity_.scene_text) return;
  try {
    scene_record_ = scene_record(identity_.scene_text());
    identity_.scene_text = {};
    append(scene_record_);
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    if (failure_.empty()) fail(error.what());
  }
}

void Journal::sync() noexcept {
  if (unsynced_.exchange(false) && fdatasync(file_) != 0 && errno != EINVAL) {
    const std::lock_guard lock(mutex_);
    if (failure_.empty()) fail(reason());
  }
  // A file whose name is lost with the power is lost. Some file systems cannot sync folders: no failure.
  if (unsynced_name_.exchange(false)) sync_directory_of(path_);
}

std::string Journal::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

void Journal::remove() noexcept { unlink(path_.c_str()); }

}  // namespace rayshade
