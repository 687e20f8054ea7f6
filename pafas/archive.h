// SPDX-License-Identifier: MIT
// Structures to bytes and back. A structure lists its fields once, in a function
//   template <class Archive> void fields(Archive& archive, T& value) { archive(value.a, value.b); }
// found beside it; both directions follow from that. Numbers are little-endian, lengths stand before what
// they count. Reading trusts nothing: whatever the bytes are, it gives a value or throws.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace pafas {

static_assert(std::endian::native == std::endian::little, "messages are written as the machine holds them");

/// Bytes that are not what they should be.
struct ArchiveError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

template <class T>
concept PlainValue = std::is_arithmetic_v<T> || std::is_enum_v<T>;

class ArchiveWriter {
 public:
  template <class... T>
  void operator()(const T&... values) {
    (write(values), ...);
  }
  std::string take() { return std::move(bytes_); }

 private:
  template <PlainValue T>
  void write(const T& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void write(const std::string& text) {
    write(static_cast<std::uint64_t>(text.size()));
    bytes_ += text;
  }
  template <class T>
  void write(const std::vector<T>& values) {
    write(static_cast<std::uint64_t>(values.size()));
    if constexpr (PlainValue<T>) {
      bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    } else {
      for (const T& value : values) write(value);
    }
  }
  template <class T>
  requires(!PlainValue<T>) void write(const T& value) { fields(*this, const_cast<T&>(value)); }

  std::string bytes_;
};

class ArchiveReader {
 public:
  explicit ArchiveReader(std::string_view bytes) : rest_(bytes) {}
  template <class... T>
  void operator()(T&... values) {
    (read(values), ...);
  }
  /// Throws where bytes are left over.
  void end() const {
    if (!rest_.empty()) throw ArchiveError("bytes left over after a message");
  }

 private:
  std::string_view take(std::uint64_t size) {
    if (size > rest_.size()) throw ArchiveError("a message ends too soon");
    const std::string_view out = rest_.substr(0, static_cast<std::size_t>(size));
    rest_.remove_prefix(out.size());
    return out;
  }
  template <PlainValue T>
  void read(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      value = take(1)[0] != 0;  // any other byte in a bool would be undefined behaviour
    } else {
      std::memcpy(&value, take(sizeof value).data(), sizeof value);
    }
  }
  void read(std::string& text) {
    std::uint64_t size = 0;
    read(size);
    text = take(size);
  }
  template <class T>
  void read(std::vector<T>& values) {
    std::uint64_t count = 0;
    read(count);
    if constexpr (PlainValue<T>) {
      if (count > rest_.size() / sizeof(T)) throw ArchiveError("a message ends too soon");
      const std::string_view bytes = take(count * sizeof(T));
      values.resize(static_cast<std::size_t>(count));
      if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    } else {
      // Every element takes at least a byte, so that no count can eat the memory.
      if (count > rest_.size()) throw ArchiveError("a message ends too soon");
      values.clear();
      for (std::uint64_t i = 0; i < count; ++i) read(values.emplace_back());
    }
  }
  template <class T>
  requires(!PlainValue<T>) void read(T& value) { fields(*this, value); }

  std::string_view rest_;
};

template <class T>
std::string to_bytes(const T& value) {
  ArchiveWriter writer;
  writer(value);
  return writer.take();
}

/// Throws ArchiveError.
template <class T>
T from_bytes(std::string_view bytes) {
  ArchiveReader reader(bytes);
  T value{};
  reader(value);
  reader.end();
  return value;
}

}  // namespace pafas
