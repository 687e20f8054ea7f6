// SPDX-License-Identifier: MIT
// Zeroed memory by the gigabyte: anonymous, or backed by an unlinked file whose space is reserved beforehand,
// so that a full disk is an error here and not a signal later.
#pragma once

#include <cstddef>
#include <string>

namespace rayshade {

class MappedMemory {
 public:
  MappedMemory() = default;
  /// `size` zero bytes. An empty directory means anonymous memory. Throws std::system_error.
  explicit MappedMemory(std::size_t size, const std::string& directory = {});
  ~MappedMemory();
  MappedMemory(MappedMemory&& other) noexcept;
  MappedMemory& operator=(MappedMemory&& other) noexcept;
  MappedMemory(const MappedMemory&) = delete;
  MappedMemory& operator=(const MappedMemory&) = delete;

  unsigned char* data() const { return data_; }
  std::size_t size() const { return size_; }
  bool file_backed() const { return file_ >= 0; }

  /// Makes every byte zero again, giving pages back where that is possible.
  void clear();

 private:
  void release() noexcept;

  unsigned char* data_ = nullptr;
  std::size_t size_ = 0;
  int file_ = -1;
};

}  // namespace rayshade
