// SPDX-License-Identifier: MIT
// The .checks files: scenes with options and what their pictures must show. Line by line:
//
//   # ...                 a remark
//   header                a new common beginning of all scenes that follow; its lines begin with "| "
//   check NAME [title]    a scene: the header, then the lines that begin with "| "
//   replace LINE          a line of the header that this scene has not,
//   with LINE             and what it has instead
//   render [OPTIONS]      one run of the program; the expectations below it belong to it:
//     pixel X Y = R G B           exactly these bytes; x from the left, y from the top, both from 0
//     near X Y = R G B            the same, each within 1
//     every = R G B               all pixels
//     equal NAME                  the picture of the first run of that check
//     different NAME
//     swapped NAME R G B R G B    that picture with two colours exchanged
//     lit N columns A B [rows C D] [within T]   N (or *) pixels have red in them, and where they lie
//     levels A B C ...            the red values above 0 are exactly these
//     maximum M [within T]        the largest byte of all
//     range red A B               all red bytes lie there
//     mean R G B within T         of the bytes
//     deviation red D within T    standard deviation
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rayshade::checks {

struct Run {
  std::string options;
  std::vector<std::string> expectations;
};

struct Check {
  std::string name, scene;
  std::vector<Run> runs;
  int line = 0;  ///< in its file
};

/// Throws std::runtime_error with file and line for anything that is not of the form above, except that
/// expectations are understood only when they are tested.
std::vector<Check> read_checks(const std::filesystem::path& file);

}  // namespace rayshade::checks
