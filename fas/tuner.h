// SPDX-License-Identifier: MIT
// What the trees of one structure learn while they run. Only speed depends on it: what is found never does,
// so that updates may race and then only make an average of fewer samples.
#pragma once

#include <atomic>

namespace fas {

/// What handing on a candidate costs in nanoseconds, measured while running, shared by all trees.
class Tuner {
 public:
  double per_candidate() const { return per_candidate_.load(std::memory_order_relaxed); }
  void measured_candidate(double ns) {
    const double old = per_candidate();
    per_candidate_.store(old + (ns - old) * (1.0 / 32), std::memory_order_relaxed);
  }

 private:
  std::atomic<double> per_candidate_{60};
};

}  // namespace fas
