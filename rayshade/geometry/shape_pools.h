// SPDX-License-Identifier: MIT
// Fills the typed pools of the compiled scene: every primitive that is used is built once, when its first
// leaf is made.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "rayshade/geometry/compiled_scene.h"
#include "rayshade/geometry/scene_facts.h"

namespace rayshade {

class ShapePools {
 public:
  ShapePools(const Scene& scene, const SceneFacts& facts, Provider& provider, bool flip_normals,
             CompiledScene& out);
  /// The index of the primitive in its pool. Throws CompileError where a height field cannot be read.
  std::uint32_t index_of(const Node& node);
  /// Reads every height field that the scene names. Throws CompileError.
  void check_files();

 private:
  std::uint32_t build(const Node& node);
  /// The same file is read once.
  std::shared_ptr<const HeightFieldData> read_height_field(const FileReference& file);

  const Scene& scene_;
  Provider& provider_;
  bool flip_normals_;
  CompiledScene& out_;
  std::array<std::vector<std::uint32_t>, kPrimitiveKinds> built_;  ///< by kind and payload: index in the pool
  std::unordered_map<std::string, std::shared_ptr<const HeightFieldData>> files_;
};

}  // namespace rayshade
