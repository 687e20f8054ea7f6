// SPDX-License-Identifier: MIT
// Numbers of the Utah RLE format (shading.md 8.3, textures.md 6.1). Internal to the layer.
#pragma once

namespace rayshade::detail {

inline constexpr int kRleMagic = 0xcc52;

// Header flags.
inline constexpr int kRleClearFirst = 1, kRleNoBackground = 2, kRleAlpha = 4, kRleComment = 8;

// Opcodes; with kRleLong the operand is the 16-bit word that follows.
inline constexpr int kRleSkipLines = 1, kRleSetColor = 2, kRleSkipPixels = 3, kRleByteData = 5,
                     kRleRunData = 6, kRleEnd = 7, kRleLong = 0x40;

/// The operand of kRleSetColor that means alpha.
inline constexpr int kRleAlphaChannel = 255;

/// Background bytes in a header for `colors` colours, filler included: always odd, so that the header's end
/// is even.
inline constexpr int rle_background_bytes(int colors) { return 1 + 2 * (colors / 2); }

}  // namespace rayshade::detail
