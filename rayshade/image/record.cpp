// SPDX-License-Identifier: MIT
#include "rayshade/image/record.h"

#include <zlib.h>

namespace rayshade {
namespace {

constexpr std::uint8_t kVersion = 1;

std::uint32_t checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(crc32(0, nullptr, 0), reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace

std::optional<RecordHead> read_record_head(std::string_view bytes) {
  if (!bytes.starts_with(kRecordMagic) || bytes.size() < kRecordHead) return {};
  bytes = bytes.substr(0, kRecordHead);
  RecordReader in(bytes.substr(kRecordMagic.size()));
  const auto version = in.number<std::uint8_t>();
  RecordHead head;
  head.kind = in.number<RecordKind>();
  const auto reserved = in.number<std::uint16_t>();
  head.length = in.number<std::uint64_t>();
  head.checksum = in.number<std::uint32_t>();
  if (in.number<std::uint32_t>() != checksum(bytes.substr(0, kRecordHead - 4))) return {};
  if (version != kVersion || reserved != 0) return {};
  return head;
}

bool is_whole(const RecordHead& head, std::string_view payload) {
  return payload.size() == head.length && checksum(payload) == head.checksum;
}

std::optional<Record> open_record(std::string_view bytes) {
  const std::optional<RecordHead> head = read_record_head(bytes);
  if (!head || head->length > bytes.size() - kRecordHead) return {};
  const std::string_view payload = bytes.substr(kRecordHead, head->length);
  if (!is_whole(*head, payload)) return {};
  return Record{head->kind, payload, kRecordHead + payload.size()};
}

RecordWriter::RecordWriter(RecordKind kind, std::size_t expected_payload) : kind_(kind) {
  record_.reserve(kRecordHead + expected_payload);
  record_.assign(kRecordHead, '\0');
}

void RecordWriter::text(std::string_view text) {
  number(std::uint64_t{text.size()});
  bytes(text.data(), text.size());
}

std::string RecordWriter::seal() {
  std::string out = std::move(record_);
  record_.clear();
  const std::string_view payload = std::string_view(out).substr(kRecordHead);
  const std::uint64_t length = payload.size();
  const std::uint32_t sum = checksum(payload);
  record_.append(kRecordMagic);
  number(kVersion);
  number(kind_);
  number(std::uint16_t{0});
  number(length);
  number(sum);
  number(checksum(record_));
  out.replace(0, kRecordHead, record_);
  record_.assign(kRecordHead, '\0');
  return out;
}

std::string_view RecordReader::take(std::uint64_t size) {
  if (size > rest_.size()) {
    ok_ = false;
    rest_ = {};
    return {};
  }
  const std::string_view out = rest_.substr(0, size);
  rest_.remove_prefix(size);
  return out;
}

}  // namespace rayshade
