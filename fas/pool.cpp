// SPDX-License-Identifier: MIT
#include "fas/pool.h"

#include <new>

namespace fas {

namespace {
constexpr std::align_val_t kAlignment{64};
}

Pool::~Pool() {
  for (const Chunk& chunk : all_) ::operator delete(chunk.start, kAlignment);
}

std::byte* Pool::take(std::size_t bytes) {
  const std::size_t size = (bytes + kChunk - 1) / kChunk * kChunk;
  const std::lock_guard lock(mutex_);
  std::size_t best = free_.size();
  for (std::size_t i = free_.size(); i-- > 0;) {
    if (free_[i].size < size) continue;
    if (best == free_.size() || free_[i].size < free_[best].size) best = i;
    if (free_[best].size == size) break;
  }
  if (best < free_.size()) {
    const Chunk chunk = free_[best];
    free_.erase(free_.begin() + static_cast<std::ptrdiff_t>(best));
    used_.fetch_add(chunk.size, std::memory_order_relaxed);
    return chunk.start;
  }
  if (used_.load(std::memory_order_relaxed) + size > budget_) {
    exhausted_.store(true, std::memory_order_relaxed);
    return nullptr;
  }
  make_room(size);
  auto* start = static_cast<std::byte*>(::operator new(size, kAlignment, std::nothrow));
  if (!start) {
    exhausted_.store(true, std::memory_order_relaxed);
    return nullptr;
  }
  all_.push_back({start, size});
  held_ += size;
  used_.fetch_add(size, std::memory_order_relaxed);
  return start;
}

void Pool::make_room(std::size_t size) {
  while (held_ + size > budget_) {
    const Chunk chunk = free_.back();
    free_.pop_back();
    std::erase_if(all_, [&](const Chunk& c) { return c.start == chunk.start; });
    held_ -= chunk.size;
    ::operator delete(chunk.start, kAlignment);
  }
}

std::size_t Pool::held() const {
  const std::lock_guard lock(mutex_);
  return held_;
}

void Pool::reset() {
  const std::lock_guard lock(mutex_);
  free_ = all_;
  used_.store(0, std::memory_order_relaxed);
  exhausted_.store(false, std::memory_order_relaxed);
  generation_.fetch_add(1, std::memory_order_release);
}

std::byte* Arena::take(std::size_t bytes) {
  if (generation_ != pool_->generation()) {
    generation_ = pool_->generation();
    next_ = end_ = nullptr;
  }
  const std::size_t size = rounded(bytes);
  if (static_cast<std::size_t>(end_ - next_) < size + kReadable) {
    std::byte* chunk = pool_->take(size + kReadable);
    if (!chunk) return nullptr;
    next_ = chunk;
    end_ = chunk + (size + kReadable + Pool::kChunk - 1) / Pool::kChunk * Pool::kChunk;
  }
  std::byte* out = next_;
  next_ += size;
  return out;
}

void Arena::shrink(std::byte* start, std::size_t old_bytes, std::size_t new_bytes) {
  if (start + rounded(old_bytes) == next_) next_ = start + rounded(new_bytes);
}

}  // namespace fas
