// SPDX-License-Identifier: MIT
// Sealed records: bytes that say how many they are and whether they are whole. Finished blocks go through
// messages as records, and a journal is a file of them.
//
// A record is a head of 24 bytes and a payload, numbers little-endian:
//
//     0  magic "RSRc"       8  bytes of the payload, 64 bits
//     4  version, kind     16  CRC-32 of the payload
//     6  zero, 16 bits     20  CRC-32 of the 20 bytes before
//
// A reader trusts no length: it is believed only if the head's checksum is right, and then compared with what
// is there.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace rayshade {

enum class RecordKind : std::uint8_t {
  kBlock = 1,     ///< a finished block (block_record.h)
  kIdentity = 2,  ///< what a journal is of (render/journal.h)
  kFrame = 3,     ///< a finished frame (render/journal.h)
  kScene = 4,     ///< the text of a scene (render/scene_change.h)
};

inline constexpr std::size_t kRecordHead = 24;
inline constexpr std::string_view kRecordMagic = "RSRc";

/// What a head announces.
struct RecordHead {
  RecordKind kind = RecordKind::kBlock;
  std::uint64_t length = 0;  ///< bytes of the payload
  std::uint32_t checksum = 0;
};

/// The head at the beginning of `bytes`; nothing where they are too few, not one, or damaged.
std::optional<RecordHead> read_record_head(std::string_view bytes);

/// Whether these bytes are the payload that the head announces.
bool is_whole(const RecordHead& head, std::string_view payload);

struct Record {
  RecordKind kind = RecordKind::kBlock;
  std::string_view payload;  ///< within the bytes given
  std::size_t size = 0;      ///< of the whole record
};

/// The record at the beginning of `bytes`, which may go on after it; nothing where there is no whole one.
std::optional<Record> open_record(std::string_view bytes);

/// Puts a record together in one string.
class RecordWriter {
 public:
  explicit RecordWriter(RecordKind kind, std::size_t expected_payload = 0);
  /// A number, or an enumerator as its number.
  template <typename T>
  void number(T value) {
    static_assert(std::is_integral_v<T> || std::is_enum_v<T>);
    auto bits = static_cast<std::uint64_t>(value);
    std::array<char, sizeof(T)> bytes;
    for (char& byte : bytes) {
      byte = static_cast<char>(bits & 0xff);
      bits >>= 8;
    }
    record_.append(bytes.data(), bytes.size());
  }
  void bytes(const void* data, std::size_t size) { record_.append(static_cast<const char*>(data), size); }
  /// Its length, then its bytes.
  void text(std::string_view text);
  /// The sealed record; the writer is then empty.
  std::string seal();

 private:
  RecordKind kind_;
  std::string record_;
};

/// Takes a payload apart. Reading past its end gives zeros and is noticed: ask ok() at the end.
class RecordReader {
 public:
  explicit RecordReader(std::string_view payload) : rest_(payload) {}
  template <typename T>
  T number() {
    static_assert(std::is_integral_v<T> || std::is_enum_v<T>);
    const std::string_view from = take(sizeof(T));
    std::uint64_t bits = 0;
    for (std::size_t i = from.size(); i-- > 0;) bits = bits << 8 | static_cast<unsigned char>(from[i]);
    return static_cast<T>(bits);
  }
  std::string_view text() { return take(number<std::uint64_t>()); }
  /// So many bytes; none where they are not there.
  std::string_view take(std::uint64_t size);
  std::string_view rest() const { return rest_; }
  /// Whether all that was asked for was there.
  bool ok() const { return ok_; }

 private:
  std::string_view rest_;
  bool ok_ = true;
};

}  // namespace rayshade
