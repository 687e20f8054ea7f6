// SPDX-License-Identifier: MIT
// Where picture writers put their bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

namespace rayshade {

/// A picture that could not be written; what() names the file and the reason.
struct WriteError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Sink {
 public:
  virtual ~Sink() = default;
  /// Takes all bytes or throws WriteError.
  virtual void write(const void* data, std::size_t size) = 0;
  void write(std::string_view text) { write(text.data(), text.size()); }
};

/// Collects bytes.
class MemorySink : public Sink {
 public:
  void write(const void* data, std::size_t size) override {
    bytes_.append(static_cast<const char*>(data), size);
  }
  using Sink::write;
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace rayshade
