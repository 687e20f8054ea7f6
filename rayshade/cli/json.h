// SPDX-License-Identifier: MIT
// Writes JSON, nothing more: statistics are only ever written.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rayshade {

class JsonWriter {
 public:
  JsonWriter& begin_object(std::string_view key = {});
  JsonWriter& end_object();
  JsonWriter& begin_array(std::string_view key = {});
  JsonWriter& end_array();
  JsonWriter& value(std::string_view key, std::string_view text);
  JsonWriter& value(std::string_view key, const char* text) { return value(key, std::string_view(text)); }
  /// null where the number is not finite.
  JsonWriter& value(std::string_view key, double number);
  JsonWriter& value(std::string_view key, std::uint64_t number);
  JsonWriter& value(std::string_view key, int number);
  JsonWriter& value(std::string_view key, bool flag);
  /// The text so far, with a newline at its end.
  std::string text() const { return out_ + "\n"; }

 private:
  void open(std::string_view key);
  static std::string quoted(std::string_view text);

  std::string out_;
  bool first_ = true;
  int depth_ = 0;
};

}  // namespace rayshade
