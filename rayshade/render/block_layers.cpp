// SPDX-License-Identifier: MIT
#include "rayshade/render/block_layers.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string_view>

namespace rayshade {
namespace {

using Layer = BlockPixels::Layer;

struct Field {
  std::string_view name;
  std::size_t offset;
};

constexpr Field kFields[] = {
    {"depth.Z", offsetof(Layer, depth)},
    {"normal.X", offsetof(Layer, normal)},
    {"normal.Y", offsetof(Layer, normal) + sizeof(float)},
    {"normal.Z", offsetof(Layer, normal) + 2 * sizeof(float)},
    {"object", offsetof(Layer, object)},
    {"samples", offsetof(Layer, samples)},
    {"tests", offsetof(Layer, tests)},
    {"bounds_tests", offsetof(Layer, bounds_tests)},
    {"microseconds", offsetof(Layer, microseconds)},
    {"rays", offsetof(Layer, rays)},
    {"tree_rays", offsetof(Layer, tree_rays)},
};

}  // namespace

BlockLayers::BlockLayers(const std::vector<std::string>& names) : values_(names.size()) {
  for (const std::string& name : names) {
    const Field* field =
        std::find_if(std::begin(kFields), std::end(kFields), [&](const Field& f) { return f.name == name; });
    if (field == std::end(kFields)) throw std::invalid_argument("unknown layer " + name);
    fields_.push_back(field->offset);
  }
}

std::vector<std::span<const float>> BlockLayers::of(const BlockPixels& block) {
  std::vector<std::span<const float>> spans;
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    values_[i].resize(block.layers.size());
    for (std::size_t k = 0; k < block.layers.size(); ++k)
      std::memcpy(&values_[i][k], reinterpret_cast<const char*>(&block.layers[k]) + fields_[i],
                  sizeof(float));
    spans.emplace_back(values_[i]);
  }
  return spans;
}

}  // namespace rayshade
