// SPDX-License-Identifier: MIT
#include "rayshade/scene/hashing_provider.h"

#include "rayshade/scene/hash128.h"

namespace rayshade {

Bytes HashingProvider::read(const std::string& name) {
  Bytes bytes = provider_.read(name);
  std::string hash = hash128(*bytes).text();
  const std::lock_guard lock(mutex_);
  hashes_[name] = std::move(hash);
  return bytes;
}

}  // namespace rayshade
