// SPDX-License-Identifier: MIT
#include "rayshade/image/mapped_memory.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

namespace rayshade {
namespace {

[[noreturn]] void fail(int error, const std::string& what) {
  throw std::system_error(error, std::generic_category(), what);
}

int unlinked_file(const std::string& directory) {
  int file = ::open(directory.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file >= 0) return file;
  // Not every file system can make a nameless file.
  std::string name = directory + "/.rayshade-XXXXXX";
  file = ::mkostemp(name.data(), O_CLOEXEC);
  if (file < 0) fail(errno, "cannot make a temporary file in " + directory);
  ::unlink(name.c_str());
  return file;
}

}  // namespace

MappedMemory::MappedMemory(std::size_t size, const std::string& directory) {
  if (size == 0) return;
  int flags = MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE;
  if (!directory.empty()) {
    file_ = unlinked_file(directory);
    // Reserves the blocks: a write into a hole of a full disk would be a signal.
    if (const int error = ::posix_fallocate(file_, 0, static_cast<off_t>(size)); error != 0) {
      ::close(file_);
      fail(error, "cannot reserve " + std::to_string(size) + " bytes in " + directory);
    }
    flags = MAP_SHARED;
  }
  void* const address = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, flags, file_, 0);
  if (address == MAP_FAILED) {
    const int error = errno;
    if (file_ >= 0) ::close(file_);
    fail(error, "cannot map " + std::to_string(size) + " bytes");
  }
  data_ = static_cast<unsigned char*>(address);
  size_ = size;
}

MappedMemory::~MappedMemory() { release(); }

MappedMemory::MappedMemory(MappedMemory&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)),
      size_(std::exchange(other.size_, 0)),
      file_(std::exchange(other.file_, -1)) {}

MappedMemory& MappedMemory::operator=(MappedMemory&& other) noexcept {
  if (this != &other) {
    release();
    data_ = std::exchange(other.data_, nullptr);
    size_ = std::exchange(other.size_, 0);
    file_ = std::exchange(other.file_, -1);
  }
  return *this;
}

void MappedMemory::clear() {
  if (size_ == 0) return;
  // Anonymous pages come back as zeros; those of a file keep their content and their reserved blocks.
  if (file_ < 0 && ::madvise(data_, size_, MADV_DONTNEED) == 0) return;
  std::memset(data_, 0, size_);
}

void MappedMemory::release() noexcept {
  if (data_ != nullptr) ::munmap(data_, size_);
  if (file_ >= 0) ::close(file_);
  data_ = nullptr;
  size_ = 0;
  file_ = -1;
}

}  // namespace rayshade
