// SPDX-License-Identifier: MIT
// What changed in a scene since its text was recorded.
#pragma once

#include <string>
#include <string_view>

namespace rayshade {

/// A sealed record (image/record.h) of a scene's canonical text: itself, or where it is large, a hash of each
/// line.
std::string scene_record(std::string_view text);

/// The first thing that changed, for people, from such a record's payload and the text of now.
std::string scene_difference(std::string_view recorded, std::string_view now);

}  // namespace rayshade
