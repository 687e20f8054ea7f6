// SPDX-License-Identifier: MIT
// Everything that a scene names is read through one door: names to bytes (rule 12). The shell reads files,
// tests and fuzzers feed memory, and a cluster sends recorded bytes.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>

namespace rayshade {

using Bytes = std::shared_ptr<const std::string>;

/// A file that cannot be read; what() is the reason ("No such file or directory").
struct ProviderError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Provider {
 public:
  virtual ~Provider() = default;
  /// The whole content of `name`, taken as written (relative to the working directory). The name "-" is
  /// standard input. Throws ProviderError. Thread-safe.
  virtual Bytes read(const std::string& name) = 0;
};

/// Reads files, pipes and standard input (once; later reads of "-" give the same bytes). Refuses directories,
/// files larger than `limit` bytes, and streams of unknown size beyond 1 GiB.
class FileProvider : public Provider {
 public:
  explicit FileProvider(std::size_t limit = std::size_t{8} << 30) : limit_(limit) {}
  Bytes read(const std::string& name) override;
  /// Of all files so far.
  std::uint64_t bytes_read() const { return bytes_read_.load(std::memory_order_relaxed); }

 private:
  Bytes read_file(const std::string& name);

  std::atomic<std::uint64_t> bytes_read_{0};
  std::size_t limit_;
  std::mutex mutex_;
  Bytes standard_input_;  ///< guarded by mutex_
};

/// Serves what it was given.
class MemoryProvider : public Provider {
 public:
  void add(std::string name, std::string content);
  Bytes read(const std::string& name) override;

 private:
  std::map<std::string, Bytes> files_;
};

}  // namespace rayshade
