// SPDX-License-Identifier: MIT
#include "rayshade/image/sink.h"

namespace rayshade {

void Sink::overwrite(std::uint64_t, const void*, std::size_t) {
  throw WriteError("this output cannot be written twice");
}

void MemorySink::overwrite(std::uint64_t offset, const void* data, std::size_t size) {
  if (offset > bytes_.size() || size > bytes_.size() - offset) throw WriteError("overwriting beyond the end");
  bytes_.replace(offset, size, static_cast<const char*>(data), size);
}

}  // namespace rayshade
