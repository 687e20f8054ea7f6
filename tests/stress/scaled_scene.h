// SPDX-License-Identifier: MIT
// A scene of all shapes as text, at any scale and any distance from the origin: the picture must not know.
#pragma once

#include <string>

namespace rayshade::stress {

/// How the scene comes to its place: by the numbers of its shapes, or by one transform around all of it.
enum class Placing { kWritten, kTransformed };

/// From where the scene is seen.
enum class View {
  kNear,  ///< ten units away
  kFar    ///< two hundred, through a telescope
};

/// `scale`: the length of one unit of the scene, which is about ten units wide. `offset`: units between the
/// origin and the middle of the scene, on a diagonal. Height fields are placed by transforms in either case.
/// The height field is read from the file "field.hf".
std::string scaled_scene(double scale, double offset, Placing placing, View view);

/// The bytes of that file.
std::string scaled_field();

}  // namespace rayshade::stress
