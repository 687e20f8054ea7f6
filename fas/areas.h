// SPDX-License-Identifier: MIT
// What one face of a flat hyper-tree sees of every primitive: computed when a cell first wants it, and kept,
// since every level of the tree asks for it again, and projecting a primitive costs more than all else that
// is done with it there.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "fas/pool.h"

namespace fas {

/// A candidate's area in the units of a root square.
struct Area {
  double x0, x1, y0, y1;
  double z0, z1;  ///< depths
  std::uint32_t id = 0;
  std::uint8_t cuts = 0;
  bool covers = false;
  double cut[3][3];  ///< a x + b y + c >= 0 everywhere in the area
  double inside[3];  ///< of covers: see Footprint
};

/// Thread-safe for any number of readers and writers; what was kept never moves.
class AreaStore {
 public:
  /// Primitives are numbered below `count`. Without memory for it nothing is kept, ever. Returns the bytes
  /// taken. Not thread-safe.
  std::size_t start(std::uint32_t count, Arena& arena);
  /// Nothing is kept any more; memory is the pool's. No thread may be tracing.
  void clear() { chunks_ = nullptr; }

  /// What is kept of a primitive; null: nothing.
  const Area* find(std::uint32_t primitive) const {
    if (!chunks_) return nullptr;
    const Chunk* chunk = chunks_[primitive / kChunk].load(std::memory_order_acquire);
    return chunk ? chunk->areas[primitive % kChunk].load(std::memory_order_acquire) : nullptr;
  }
  /// What stands for primitives that the face does not see.
  static const Area& unseen();
  /// Keeps a copy of `area`, or by unseen() that it does not see the primitive, as far as there is memory.
  /// Returns the bytes taken.
  std::size_t keep(std::uint32_t primitive, const Area& area, Arena& arena);

 private:
  static constexpr std::uint32_t kChunk = 64;  ///< neighbours by number are neighbours in space
  struct Chunk {
    std::array<std::atomic<const Area*>, kChunk> areas{};
  };
  std::atomic<Chunk*>* chunks_ = nullptr;
};

}  // namespace fas
