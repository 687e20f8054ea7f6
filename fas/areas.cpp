// SPDX-License-Identifier: MIT
#include "fas/areas.h"

#include <memory>
#include <new>

namespace fas {

std::size_t AreaStore::start(std::uint32_t count, Arena& arena) {
  const std::size_t size = count / kChunk + 1;
  std::byte* memory = arena.take(size * sizeof(std::atomic<Chunk*>));
  if (!memory) return 0;
  auto* chunks = reinterpret_cast<std::atomic<Chunk*>*>(memory);
  std::uninitialized_value_construct_n(chunks, size);
  chunks_ = chunks;
  return size * sizeof(std::atomic<Chunk*>);
}

const Area& AreaStore::unseen() {
  static const Area nowhere{};
  return nowhere;
}

std::size_t AreaStore::keep(std::uint32_t primitive, const Area& area, Arena& arena) {
  if (!chunks_) return 0;
  std::size_t bytes = 0;
  std::atomic<Chunk*>& place = chunks_[primitive / kChunk];
  Chunk* chunk = place.load(std::memory_order_acquire);
  if (!chunk) {
    std::byte* memory = arena.take(sizeof(Chunk));
    if (!memory) return 0;
    Chunk* made = new (memory) Chunk;
    if (place.compare_exchange_strong(chunk, made, std::memory_order_acq_rel))
      chunk = made, bytes += sizeof(Chunk);
    else
      arena.shrink(memory, sizeof(Chunk), 0);  // `chunk` is now that of who came first
  }
  const Area* kept = &area;
  if (kept != &unseen()) {
    std::byte* memory = arena.take(sizeof(Area));
    if (!memory) return bytes;
    kept = new (memory) Area(area);
    bytes += sizeof(Area);
  }
  chunk->areas[primitive % kChunk].store(kept, std::memory_order_release);
  return bytes;
}

}  // namespace fas
