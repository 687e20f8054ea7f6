// SPDX-License-Identifier: MIT
// Files and memory as sources of bytes. POSIX calls, because the reasons of failure are for people.
#include "rayshade/scene/provider.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <system_error>
#include <utility>

namespace rayshade {
namespace {

/// Pipes and devices do not tell their size and may never end; a scene that comes through one is smaller than
/// this.
constexpr std::size_t kStreamLimit = std::size_t{1} << 30;

[[noreturn]] void fail(int error) { throw ProviderError(std::generic_category().message(error)); }

struct Descriptor {
  int fd;
  ~Descriptor() { ::close(fd); }
};

Bytes read_all(int fd, std::size_t limit) {
  struct stat status {};
  if (::fstat(fd, &status) != 0) fail(errno);
  if (S_ISDIR(status.st_mode)) fail(EISDIR);
  auto content = std::make_shared<std::string>();
  if (S_ISREG(status.st_mode)) {
    if (static_cast<std::uintmax_t>(status.st_size) > limit) fail(EFBIG);
    content->reserve(static_cast<std::size_t>(status.st_size) + 1);
  } else {
    limit = std::min(limit, kStreamLimit);
  }
  std::size_t used = 0;
  for (;;) {
    const std::size_t chunk = std::max<std::size_t>(content->capacity() - used, 64 << 10);
    content->resize(used + chunk);
    const ssize_t got = ::read(fd, content->data() + used, chunk);
    if (got < 0) {
      if (errno == EINTR) continue;
      fail(errno);
    }
    used += static_cast<std::size_t>(got);
    if (used > limit) fail(EFBIG);
    if (got == 0) break;
  }
  content->resize(used);
  return content;
}

}  // namespace

Bytes FileProvider::read(const std::string& name) {
  Bytes bytes = read_file(name);
  bytes_read_.fetch_add(bytes->size(), std::memory_order_relaxed);
  return bytes;
}

Bytes FileProvider::read_file(const std::string& name) {
  if (name == "-") {
    const std::lock_guard lock(mutex_);
    if (!standard_input_) standard_input_ = read_all(STDIN_FILENO, limit_);
    return standard_input_;
  }
  if (name.find('\0') != std::string::npos) fail(EINVAL);
  int fd = -1;
  do {
    fd = ::open(name.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY);
  } while (fd < 0 && errno == EINTR);
  if (fd < 0) fail(errno);
  const Descriptor file{fd};
  return read_all(file.fd, limit_);
}

void MemoryProvider::add(std::string name, std::string content) {
  files_[std::move(name)] = std::make_shared<const std::string>(std::move(content));
}

Bytes MemoryProvider::read(const std::string& name) {
  const auto found = files_.find(name);
  if (found == files_.end()) fail(ENOENT);
  return found->second;
}

}  // namespace rayshade
