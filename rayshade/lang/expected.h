// SPDX-License-Identifier: MIT
// The words for what would have been right in place of a syntax error.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rayshade::lang {

/// "a number", "'spherical', 'cylindrical' or 'planar'", "a transform or a texture" ...: names of grammar
/// symbols, with the members of well-known groups told as one. Empty where the list would be too long to
/// help. `inside`: an aggregate is open.
std::string describe_expected(const std::vector<std::string_view>& symbols, bool inside);

}  // namespace rayshade::lang
