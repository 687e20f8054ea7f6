// SPDX-License-Identifier: MIT
// Numbers for primitives that people and pictures see: the object layer and --explain. Leaves themselves are
// numbered as the intersector likes them to lie in memory, which is nobody's business outside.
#pragma once

#include <cstdint>
#include <vector>

#include "rayshade/geometry/compiled_scene.h"

namespace rayshade {

/// By leaf: its number, from 1. A group's numbers follow its leaves' order of tests (Leaf::order), so that
/// they depend on the scene alone: not on the intersector, nor on the frames rendered before. What is shared
/// by instances has one number.
std::vector<std::uint32_t> object_numbers(const CompiledScene& scene);

}  // namespace rayshade
