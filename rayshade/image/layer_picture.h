// SPDX-License-Identifier: MIT
// A float layer (cost, samples, depth ...) as a picture of its own: a PFM with the numbers themselves, or a
// PNG with false colours whose lightness rises evenly with the value.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "rayshade/image/frame_buffer.h"
#include "rayshade/image/sink.h"

namespace rayshade {

/// Dark violet for 0, through blue, green and ochre to light yellow for 1; lightness is linear in t. Values
/// outside 0..1 are limited, not-a-number is grey.
std::array<std::uint8_t, 3> false_color(double t);

struct FalseColorScale {
  bool automatic = true;     ///< take the smallest and the largest finite value of the layer
  double low = 0, high = 1;  ///< otherwise these
  bool logarithmic = false;  ///< compare costs across decades; values <= 0 are shown as the lowest
};

/// One-channel PFM ("Pf", rows from the bottom, little-endian).
void write_layer_pfm(const FrameBuffer& picture, int layer, Sink& sink);

/// PNG with false colours; the scale used goes into a text chunk ("Layer", "Low", "High"). Missing pixels are
/// transparent. Throws WriteError from the sink, std::out_of_range for a layer that does not exist.
void write_layer_png(const FrameBuffer& picture, int layer, const FalseColorScale& scale, Sink& sink);

}  // namespace rayshade
