// SPDX-License-Identifier: MIT
// The integer expressions of #if and #elif.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string_view>

namespace rayshade::lang {

/// What is wrong with a condition.
struct ConditionError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The value of a condition in which macros and `defined` are replaced already; names that are left count 0.
/// All operators of C but the comma and assignments, 64-bit arithmetic that wraps around. Throws
/// ConditionError.
std::int64_t evaluate_condition(std::string_view text);

}  // namespace rayshade::lang
