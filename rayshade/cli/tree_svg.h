// SPDX-License-Identifier: MIT
// The subdivision of the tree of eye rays, drawn over the picture (--fas-dump).
#pragma once

#include <string>

#include "rayshade/image/frame_buffer.h"
#include "rayshade/render/tree_cells.h"

namespace rayshade {

/// What is told beside the drawing.
struct TreeDrawing {
  int width = 0, height = 0;  ///< of the window, in pixels
  std::string title;          ///< any bytes; what is not printable ASCII is shown as ?
  std::string note;           ///< a second line
};

/// The picture as PNG of 8 bits a channel without alpha; empty where that cannot be: an exponential picture,
/// or one of more than 2^25 pixels.
std::string embeddable_png(const FrameBuffer& picture);

/// A standalone SVG: the picture (`png`, may be empty), over it every visible cell as a polygon shaded by its
/// number of candidates, below it how many cells have how many.
std::string tree_svg(const TreeCells& cells, const TreeDrawing& drawing, const std::string& png);

}  // namespace rayshade
