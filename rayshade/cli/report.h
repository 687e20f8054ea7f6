// SPDX-License-Identifier: MIT
// Statistics for people (the table of language.md 6.3, and more) and for programs (JSON), from the same
// numbers.
#pragma once

#include <functional>
#include <string>

#include "rayshade/render/renderer.h"
#include "rayshade/scene/settings.h"

namespace rayshade {

class JsonWriter;

/// How a run ended; `--stats` records it.
struct RunSummary {
  std::string program = "rayshade";
  std::string scene;  ///< name as given
  std::string scene_hash;
  std::string version;
  std::string outcome;  ///< "complete", "stopped", or "differs": --verify found something
  /// What earlier runs had done, and this one did not render again.
  std::uint64_t blocks_resumed = 0, pixels_resumed = 0;
  int frames_resumed = 0;
  double parse_seconds = 0;
  double total_cpu_seconds = 0;  ///< user and system, of the process
  double wall_seconds = 0;
  std::uint64_t peak_memory = 0;  ///< bytes, largest resident set
};

/// What will be rendered, in the manner of the original's verbose report.
std::string settings_text(const RenderSettings& settings, const Renderer& renderer);
/// The statistics table; `verbose` adds what was skipped and where time went.
std::string statistics_text(const RenderStatistics& statistics, const RunSummary& run, bool verbose);
/// All of it as one JSON object; `more` writes further members.
std::string statistics_json(const RenderStatistics& statistics, const RenderSettings& settings,
                            const RunSummary& run, const std::function<void(JsonWriter&)>& more = {});

}  // namespace rayshade
