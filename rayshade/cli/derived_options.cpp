// SPDX-License-Identifier: MIT
// What the options say to the layers below; the same for a program on one machine and for every rank.
#include <algorithm>

#include "rayshade/cli/options.h"

namespace rayshade {

ParseOptions parsing_options(const Options& options) {
  ParseOptions out;
  out.preprocessing = options.preprocess == Preprocess::kNever ? Preprocessing::kNever
                      : options.preprocessor_arguments         ? Preprocessing::kAlways
                                                               : Preprocessing::kAuto;
  if (options.preprocessor_arguments)
    out.preprocessor_arguments = split_arguments(*options.preprocessor_arguments);
  out.flip_normals = options.settings.flip_normals;
  out.verbose = options.verbose;
  out.output_named = options.output.has_value() && options.action == Action::kRender;
  return out;
}

RenderOptions rendering_options(const Options& options, int share) {
  RenderOptions out;
  out.threads = options.threads > 0 ? options.threads : available_threads(share);
  out.block_side = options.block;
  out.intersector = options.intersector;
  out.fas_memory = (options.fas_memory > 0 ? options.fas_memory : available_memory() / 4) /
                   static_cast<std::uint64_t>(std::max(share, 1));
  out.fas_split = options.fas_split;
  out.fas_choose = !options.fas_dump;  // what is to be drawn must be there
  out.verify = options.verify;
  out.layers = options.layers.has_value();
  out.cost = options.cost_map.has_value();
  out.sample_map = options.sample_map;
  out.unused_files = options.action == Action::kCheck;
  return out;
}

}  // namespace rayshade
