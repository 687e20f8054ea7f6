// SPDX-License-Identifier: MIT
#include "rayshade/cli/program.h"

int main(int argc, char** argv) {
  rayshade::LocalEngine engine;
  return rayshade::run_program({argv + 1, argv + argc}, engine);
}
