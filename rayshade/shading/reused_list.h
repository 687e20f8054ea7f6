// SPDX-License-Identifier: MIT
// A list for records that are made anew for every batch: it keeps them when it is cleared, and does not clear
// them when they come back. Whoever adds one writes all that will be read of it.
#pragma once

#include <algorithm>
#include <vector>

namespace rayshade {

template <class T>
class ReusedList {
 public:
  void clear() { size_ = 0; }
  /// One more, as it was left.
  T& add() {
    if (size_ == room_) records_.resize(room_ = std::max<std::size_t>(64, 2 * size_));
    return records_[size_++];
  }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T& operator[](std::size_t i) { return records_[i]; }
  const T& operator[](std::size_t i) const { return records_[i]; }
  const T* begin() const { return records_.data(); }
  const T* end() const { return records_.data() + size_; }

 private:
  std::vector<T> records_;
  std::size_t size_ = 0;
  std::size_t room_ = 0;  ///< records_.size(), which divides
};

}  // namespace rayshade
