// SPDX-License-Identifier: MIT
// Where a token stands: a range of bytes of the scanned text. Nothing else is carried through the scanner and
// the grammar; lines and columns are worked out by SourceMap only where somebody asks.
#pragma once

#include <cstdint>

namespace rayshade::lang {

/// Bytes [begin, end) of the text that the scanner reads.
struct Span {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
};

/// Bytes [begin, end) of one source as it was read, before preprocessing. `source` indexes SourceMap's
/// sources.
struct Place {
  std::uint32_t source = 0;
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
};

}  // namespace rayshade::lang
