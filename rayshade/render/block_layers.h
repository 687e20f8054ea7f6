// SPDX-License-Identifier: MIT
// The float layers of rendered blocks, in the order in which a frame buffer has them.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "rayshade/render/block_renderer.h"

namespace rayshade {

class BlockLayers {
 public:
  /// By the names that the frame buffer gives them. Throws std::invalid_argument for one that nobody knows.
  explicit BlockLayers(const std::vector<std::string>& names);
  /// One float per pixel for each layer; valid until the next call.
  std::vector<std::span<const float>> of(const BlockPixels& block);

 private:
  std::vector<std::size_t> fields_;  ///< offsets in BlockPixels::Layer
  std::vector<std::vector<float>> values_;
};

}  // namespace rayshade
