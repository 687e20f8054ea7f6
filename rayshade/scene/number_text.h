// SPDX-License-Identifier: MIT
// Numbers as scene text: the shortest decimals that read back as the same double (std::to_chars).
#pragma once

#include <charconv>
#include <cmath>
#include <string>

namespace rayshade {

/// Appends `value` so that the language reads the same number again. Infinities and NaN, which have no
/// digits, become quotients of numbers, in parentheses unless `bare` (the caller then brings its own).
inline void append_number(std::string& out, double value, bool bare = false) {
  if (!std::isfinite(value)) {
    const char* quotient = std::isnan(value) ? "0 / 0" : value > 0 ? "1 / 0" : "-1 / 0";
    if (!bare) out += '(';
    out += quotient;
    if (!bare) out += ')';
    return;
  }
  char digits[32];
  out.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

}  // namespace rayshade
