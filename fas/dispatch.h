// SPDX-License-Identifier: MIT
// Which of the versions of a function that Highway compiles, one for each instruction set, a call goes to.
//
// Highway can choose by itself, but what chooses lives in its shared library, and that measures the clock
// whenever it is loaded: 4 ms and more of every start, where a small picture takes 50. Of Highway only the
// headers are used.
#pragma once

#include "fas/compiled_targets.h"
// After that.
#include <hwy/highway.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace fas {

/// The instruction sets among those compiled that this processor has, as bits HWY_AVX2 and so on.
std::int64_t supported_targets();
/// For tests: from now on those in `targets` are taken for what the processor has; 0: what it really has. No
/// other thread may be calling anything.
void pretend_targets(std::int64_t targets);

namespace dispatch {
inline constexpr int kTargets = 4;  ///< AVX3, AVX2, SSE4, SSSE3; what needs none of them is the fifth
extern std::atomic<int> chosen;     ///< index of the best; negative: not known yet
int choose();
}  // namespace dispatch

/// One function in all its versions.
template <class Function>
class Versions {
 public:
  /// From the best to the least; null where it was not compiled.
  constexpr Versions(Function* plain,
                     std::array<std::type_identity_t<Function>*, dispatch::kTargets> better) {
    versions_[dispatch::kTargets] = plain;
    for (std::size_t i = dispatch::kTargets; i-- > 0;)
      versions_[i] = better[i] ? better[i] : versions_[i + 1];
  }
  /// The one for this processor.
  Function* best() const {
    const int known = dispatch::chosen.load(std::memory_order_relaxed);
    return versions_[static_cast<std::size_t>(known < 0 ? dispatch::choose() : known)];
  }

 private:
  std::array<Function*, dispatch::kTargets + 1> versions_{};
};

}  // namespace fas

/// All versions of a function, in the file that defines them, after HWY_ONCE.
#define FAS_VERSIONS(NAME)                                                                  \
  ::fas::Versions(HWY_CHOOSE_FALLBACK(NAME), {HWY_CHOOSE_AVX3(NAME), HWY_CHOOSE_AVX2(NAME), \
                                              HWY_CHOOSE_SSE4(NAME), HWY_CHOOSE_SSSE3(NAME)})
