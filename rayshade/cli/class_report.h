// SPDX-License-Identifier: MIT
// The part of the statistics about classes of rays and their trees, for people and as JSON.
#pragma once

#include <string>

#include "rayshade/cli/json.h"
#include "rayshade/render/statistics.h"

namespace rayshade {

/// "eye", "reflected", "light 2 (spot)" ...
std::string class_name(const ClassReport& report, const RenderStatistics& statistics);
/// How rays found objects, a table with a line for each class that had rays, and what trees took of memory.
std::string classes_text(const RenderStatistics& statistics);
/// Writes the object "trees".
void write_classes(const RenderStatistics& statistics, JsonWriter& json);

}  // namespace rayshade
