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

  /// Whether bytes already written can be replaced. EXR files need that (their table of rows stands before
  /// the rows); they go through a temporary file where it is not so.
  virtual bool can_overwrite() const { return false; }
  /// Replaces bytes from `offset` on, all of them written before. Only where can_overwrite().
  virtual void overwrite(std::uint64_t offset, const void* data, std::size_t size);
  /// Bytes written so far.
  virtual std::uint64_t written() const = 0;
};

/// Collects bytes.
class MemorySink : public Sink {
 public:
  void write(const void* data, std::size_t size) override {
    bytes_.append(static_cast<const char*>(data), size);
  }
  using Sink::write;
  bool can_overwrite() const override { return true; }
  void overwrite(std::uint64_t offset, const void* data, std::size_t size) override;
  std::uint64_t written() const override { return bytes_.size(); }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace rayshade
