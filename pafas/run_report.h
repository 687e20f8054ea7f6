// SPDX-License-Identifier: MIT
// What a run on several ranks was like: a table of the ranks, the tiling, a timeline.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pafas/rank_report.h"
#include "rayshade/schedule/block_grid.h"

namespace rayshade {
class JsonWriter;
}

namespace pafas {

struct RankRow {
  std::string outcome = "expected";  ///< "reported", or what became of it
  std::string host;
  std::int64_t process = 0;
  bool reported = false;
  RankReport report;           ///< if it has reported
  std::uint64_t blocks = 0;    ///< results of its that counted
  double render_seconds = 0;   ///< of those blocks, processor time
  std::uint64_t bytes = 0;     ///< received from it
  std::uint64_t messages = 0;  ///< received from it
  double clock_offset = 0;     ///< to add to its times to have the master's
  bool has_clock = false;
};

/// A block as it was rendered, on the master's clock.
struct BlockSpan {
  int rank = 0;
  int frame = 0;
  rayshade::Block block;
  double begin = 0, end = 0;
  bool counted = true;  ///< false: another rank's result came first
};

class RunReport {
 public:
  explicit RunReport(int ranks) : rows(static_cast<std::size_t>(ranks)) {}

  std::vector<RankRow> rows;
  std::vector<BlockSpan> spans;
  std::string schedule;
  int width = 0, height = 0;        ///< of the picture
  std::uint64_t package_bytes = 0;  ///< of the scene's files, as they are sent
  std::uint64_t lost_ranks = 0, repeated_blocks = 0, resumed_pixels = 0;

  static std::string host_name();
  /// The table of the ranks; with `verbose` the tiling too.
  std::string text(bool verbose) const;
  void write_json(rayshade::JsonWriter& json) const;
  /// The tiling of a frame, a character per block: which rank's result it is (0-9, a-z, A-Z, then *).
  std::string tiling(int frame) const;
  /// The ranks over time as SVG: a bar per block, a row per rank.
  std::string timeline() const;
  /// The tiling of a frame as a PNG with a colour per rank.
  void write_tile_map(const std::string& path, int frame) const;
};

}  // namespace pafas
