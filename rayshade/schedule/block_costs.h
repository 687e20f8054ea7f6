// SPDX-License-Identifier: MIT
// What the blocks of a rendering took: a text file for the simulator.
//
//   rayshade-block-costs 1
//   width 512
//   height 512
//   side 32
//   samples 3
//   tree-fixed-seconds 0.002      building trees, in every process, before any block of its own needs them
//   tree-region-seconds 0.1       building trees, in one process that renders the whole picture; part of the
//   scene-bytes 31000             blocks' seconds
//   compile-seconds 0.02          from the scene's bytes until a process can render; may be missing
//   result-bytes-per-pixel 3
//   blocks 256
//   0 0 0 32 32 0.00171           number x y width height seconds
//   ...
//
// Lines that begin with # are comments. Blocks tile the picture; their order is free.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "rayshade/schedule/block_grid.h"

namespace rayshade {

/// `what()` names file, line and mistake.
struct BlockCostsError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct BlockCosts {
  int width = 0, height = 0;
  int side = 0;                    ///< of the blocks; 0: they are not squares of one size
  int samples = 1;                 ///< most per pixel and axis
  double tree_fixed_seconds = 0;   ///< spent by every process
  double tree_region_seconds = 0;  ///< contained in the blocks' seconds
  std::uint64_t scene_bytes = 0;   ///< sent to every process; as pafas records them, compressed
  double compile_seconds = 0;      ///< of every process, until it can render
  double result_bytes_per_pixel = 3;
  std::vector<Block> blocks;
  std::vector<double> seconds;  ///< of each block, processor time

  double total_seconds() const;
};

/// The file's text.
std::string format_block_costs(const BlockCosts& costs);
/// Reads such a text. Throws BlockCostsError; `name` is for its message.
BlockCosts parse_block_costs(std::string_view text, const std::string& name);
/// Throws BlockCostsError where the file cannot be read or written, or holds something else.
BlockCosts read_block_costs(const std::string& path);
void write_block_costs(const BlockCosts& costs, const std::string& path);

/// The seconds of other blocks of the same picture, by the area that they share with the recorded ones.
/// Borders that refinement renders in addition are not modelled: smaller blocks than the recorded ones would
/// in truth cost somewhat more.
std::vector<double> redistribute(const BlockCosts& costs, const BlockGrid& grid);
/// The same picture at `factor` times the resolution: every block takes factor * factor times as long.
BlockCosts enlarged(BlockCosts costs, int factor);

}  // namespace rayshade
