// SPDX-License-Identifier: MIT
// What all builders share while one scene is read.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "rayshade/lang/messages.h"
#include "rayshade/lang/parse.h"
#include "rayshade/lang/source_map.h"
#include "rayshade/scene/scene.h"

namespace rayshade::lang {

struct Context {
  Scene& scene;
  SourceMap& sources;
  Messages& messages;
  const ParseOptions& options;
  std::vector<std::string>& prints;  ///< output of `print`
  std::vector<std::string>& notes;   ///< output of verbose `name`
};

/// A map from names that can be asked with views of the text.
struct NameHash {
  using is_transparent = void;
  std::size_t operator()(std::string_view name) const { return std::hash<std::string_view>{}(name); }
};
template <typename T>
using NameMap = std::unordered_map<std::string, T, NameHash, std::equal_to<>>;

/// Whether a length is unusable: zero, or beyond what doubles can square (FIX of objects.md 1.8: no absolute
/// threshold, so that models of any scale can be read).
inline bool degenerate(double length) { return !(length > 0) || !std::isfinite(length); }

}  // namespace rayshade::lang
