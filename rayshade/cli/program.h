// SPDX-License-Identifier: MIT
// The programs: options to exit code. What renders is an engine.
#pragma once

#include <string>
#include <vector>

#include "rayshade/cli/engine.h"

namespace rayshade {

/// Exit codes (rayshade(1)).
enum ExitCode : int {
  kComplete = 0,  ///< picture complete
  kFailed = 1,    ///< error in the scene or while rendering
  kUsage = 2,     ///< wrong usage
  kStopped = 3,   ///< stopped before the end
  kDiffers = 4,   ///< --verify found an answer that is not that of brute force; wins over kStopped
};

/// Runs with the arguments after the program's name. Talks on standard error, writes pictures and requested
/// data to standard output only where asked to; never throws.
int run_program(const std::vector<std::string>& arguments, Engine& engine);

}  // namespace rayshade
