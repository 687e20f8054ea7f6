// SPDX-License-Identifier: MIT
#include <vector>

#include "rayshade/cli/program.h"

int main(int argc, char** argv) { return rayshade::run_program({argv + 1, argv + argc}); }
