// SPDX-License-Identifier: MIT
#include "rayshade/cli/json.h"

#include <fmt/format.h>

#include <cmath>

namespace rayshade {

std::string JsonWriter::quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      out += {'\\', c};
    else if (byte < 0x20 || byte >= 0x7f)
      out += fmt::format("\\u{:04x}", byte);  // bytes as Latin-1
    else
      out += c;
  }
  return out + "\"";
}

void JsonWriter::open(std::string_view key) {
  if (!first_) out_ += ",";
  if (depth_ > 0) out_ += fmt::format("\n{:{}}", "", 2 * depth_);
  if (!key.empty()) out_ += quoted(key) + ": ";
  first_ = false;
}

JsonWriter& JsonWriter::begin_object(std::string_view key) {
  open(key);
  out_ += "{";
  ++depth_;
  first_ = true;
  return *this;
}

JsonWriter& JsonWriter::end_object() {
  --depth_;
  out_ += fmt::format("\n{:{}}}}", "", 2 * depth_);
  first_ = false;
  return *this;
}

JsonWriter& JsonWriter::begin_array(std::string_view key) {
  open(key);
  out_ += "[";
  ++depth_;
  first_ = true;
  return *this;
}

JsonWriter& JsonWriter::end_array() {
  --depth_;
  out_ += fmt::format("\n{:{}}]", "", 2 * depth_);
  first_ = false;
  return *this;
}

JsonWriter& JsonWriter::value(std::string_view key, std::string_view text) {
  open(key);
  out_ += quoted(text);
  return *this;
}

JsonWriter& JsonWriter::value(std::string_view key, double number) {
  open(key);
  out_ += std::isfinite(number) ? fmt::format("{}", number) : "null";
  return *this;
}

JsonWriter& JsonWriter::value(std::string_view key, std::uint64_t number) {
  open(key);
  out_ += fmt::format("{}", number);
  return *this;
}

JsonWriter& JsonWriter::value(std::string_view key, int number) {
  open(key);
  out_ += fmt::format("{}", number);
  return *this;
}

JsonWriter& JsonWriter::value(std::string_view key, bool flag) {
  open(key);
  out_ += flag ? "true" : "false";
  return *this;
}

}  // namespace rayshade
