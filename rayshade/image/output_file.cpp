// SPDX-License-Identifier: MIT
#include "rayshade/image/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "rayshade/image/directory.h"

namespace rayshade {
namespace {

constexpr std::size_t kBufferSize = std::size_t{1} << 18;

[[noreturn]] void fail(const std::string& path, int error) {
  throw WriteError(fmt::format("cannot write \"{}\": {}", path,
                               std::error_code(error, std::generic_category()).message()));
}

void write_fully(int file, const char* data, std::size_t size, const std::string& path) {
  while (size > 0) {
    const ssize_t done = ::write(file, data, size);
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) fail(path, errno);
    data += done;
    size -= static_cast<std::size_t>(done);
  }
}

/// Names of streams that are open already: a rename would tear them off.
bool names_stream(const std::string& path) {
  return path == "/dev/stdout" || path == "/dev/stderr" || path.starts_with("/dev/fd/") ||
         path.starts_with("/proc/self/fd/");
}

}  // namespace

OutputFile::OutputFile(std::string path, Mode mode) : path_(std::move(path)) {
  if (path_ == "-" || path_ == "/dev/stdout") {
    file_ = STDOUT_FILENO;
    owns_file_ = false;
    return;
  }
  if (path_.empty()) fail(path_, ENOENT);
  target_ = names_stream(path_) ? path_ : follow_links(path_);
  struct stat status {};
  const bool exists = ::stat(target_.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) fail(path_, EISDIR);
  if (names_stream(path_) || (exists && !S_ISREG(status.st_mode))) {
    file_ = ::open(target_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
    if (file_ < 0) fail(path_, errno);
    return;
  }
  // A rename does not ask for leave to write the file that it replaces.
  if (exists && ::access(target_.c_str(), W_OK) != 0) fail(path_, errno);
  open_temporary();
  try {
    if (exists) {
      // Best effort: on a file system without permissions there are none to keep.
      [[maybe_unused]] const int kept = ::fchmod(file_, status.st_mode & 07777);
      if (mode == Mode::kAppend) copy_present_content();
    }
  } catch (...) {
    discard();
    throw;
  }
  mark_ = written_;
}

OutputFile::~OutputFile() { discard(); }

void OutputFile::open_temporary() {
  if (target_.ends_with('/')) fail(path_, EISDIR);
  for (int attempt = 0; attempt < 1000; ++attempt) {
    std::string candidate = temporary_name(target_, attempt);
    file_ = ::open(candidate.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file_ >= 0) {
      temporary_ = std::move(candidate);
      return;
    }
    if (errno != EEXIST) fail(path_, errno);
  }
  fail(path_, EEXIST);
}

void OutputFile::copy_present_content() {
  const int from = ::open(target_.c_str(), O_RDONLY | O_CLOEXEC);
  if (from < 0) fail(path_, errno);
  std::string chunk(kBufferSize, '\0');
  for (;;) {
    const ssize_t count = ::read(from, chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      const int error = errno;
      ::close(from);
      if (count < 0) fail(path_, error);
      return;
    }
    try {
      write(chunk.data(), static_cast<std::size_t>(count));
    } catch (...) {
      ::close(from);
      throw;
    }
  }
}

void OutputFile::write(const void* data, std::size_t size) {
  if (file_ < 0) throw WriteError(fmt::format("\"{}\" is closed", path_));
  written_ += size;
  if (buffer_.size() + size <= kBufferSize) {
    buffer_.append(static_cast<const char*>(data), size);
    return;
  }
  flush();
  write_fully(file_, static_cast<const char*>(data), size, path_);
}

void OutputFile::overwrite(std::uint64_t offset, const void* data, std::size_t size) {
  if (direct() || offset > written_ || size > written_ - offset) Sink::overwrite(offset, data, size);
  flush();
  const char* from = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t done = ::pwrite(file_, from, size, static_cast<off_t>(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) fail(path_, errno);
    from += done;
    offset += static_cast<std::uint64_t>(done);
    size -= static_cast<std::size_t>(done);
  }
}

void OutputFile::flush() {
  write_fully(file_, buffer_.data(), buffer_.size(), path_);
  buffer_.clear();
}

void OutputFile::commit_as(const std::string& path) {
  if (file_ < 0) throw WriteError(fmt::format("\"{}\" is closed", path_));
  try {
    flush();
    if (!direct()) {
      // Without it a power cut may leave the new name with nothing in it; and some file systems report a full
      // disk only now.
      if (::fsync(file_) != 0 && errno != EINVAL) fail(path, errno);
      const int file = std::exchange(file_, -1);
      if (::close(file) != 0) fail(path, errno);
      const std::string& target = path == path_ ? target_ : path;
      if (::rename(temporary_.c_str(), target.c_str()) != 0) fail(path, errno);
      temporary_.clear();
    } else if (owns_file_) {
      const int file = std::exchange(file_, -1);
      if (::close(file) != 0) fail(path, errno);
    }
  } catch (...) {
    discard();
    throw;
  }
  file_ = -1;
}

bool OutputFile::commit_marked(const std::string& path) {
  if (mark_ == 0) {
    discard();
    return false;
  }
  if (!direct() && mark_ < written_) {
    flush();
    if (::ftruncate(file_, static_cast<off_t>(mark_)) != 0) fail(path, errno);
    written_ = mark_;
  }
  commit_as(path);
  return true;
}

void OutputFile::discard() noexcept {
  if (file_ >= 0 && owns_file_) ::close(file_);
  file_ = -1;
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  temporary_.clear();
  buffer_.clear();
}

}  // namespace rayshade
