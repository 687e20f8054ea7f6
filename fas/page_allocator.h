// SPDX-License-Identifier: MIT
// Memory that the system has again as soon as it is freed. For large things that are short-lived beside
// others: the heap would keep their pages, so that both count. Small ones come from the heap all the same.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <memory>
#include <new>

namespace fas {

template <class T>
struct PageAllocator {
  using value_type = T;
  static_assert(alignof(T) <= 4096);
  PageAllocator() = default;
  template <class U>
  PageAllocator(const PageAllocator<U>& /*other*/) {}  // NOLINT: what the standard asks for

  T* allocate(std::size_t n) {
    if (n > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
    if (n * sizeof(T) < kLarge) return std::allocator<T>().allocate(n);
    void* const pages =
        mmap(nullptr, n * sizeof(T), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (pages == MAP_FAILED) throw std::bad_alloc();
    return static_cast<T*>(pages);
  }
  void deallocate(T* start, std::size_t n) {
    if (n * sizeof(T) < kLarge)
      std::allocator<T>().deallocate(start, n);
    else
      munmap(start, n * sizeof(T));
  }
  friend bool operator==(PageAllocator /*a*/, PageAllocator /*b*/) { return true; }

 private:
  static constexpr std::size_t kLarge = std::size_t{64} << 10;  ///< bytes
};

}  // namespace fas
