// SPDX-License-Identifier: MIT
#include "fas/dispatch.h"

namespace fas {
namespace {

constexpr std::int64_t kInOrder[dispatch::kTargets] = {HWY_AVX3, HWY_AVX2, HWY_SSE4, HWY_SSSE3};
/// What runs everywhere.
constexpr std::int64_t kPlain = HWY_STATIC_TARGET;

std::atomic<std::int64_t> pretended{0};

/// What Highway lets the compiler use for each, as far as processors come without it.
std::int64_t found_targets() {
  __builtin_cpu_init();
  std::int64_t out = kPlain;
  if (!__builtin_cpu_supports("ssse3")) return out;
  out |= HWY_SSSE3;
  if (!__builtin_cpu_supports("sse4.1") || !__builtin_cpu_supports("sse4.2") ||
      !__builtin_cpu_supports("aes") || !__builtin_cpu_supports("pclmul"))
    return out;
  out |= HWY_SSE4;
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma") || !__builtin_cpu_supports("bmi") ||
      !__builtin_cpu_supports("bmi2"))
    return out;
  out |= HWY_AVX2;
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512cd"))
    out |= HWY_AVX3;
  return out;
}

}  // namespace

std::atomic<int> dispatch::chosen{-1};

std::int64_t supported_targets() {
  const std::int64_t others = pretended.load(std::memory_order_relaxed);
  return (others != 0 ? others : found_targets()) & HWY_TARGETS;
}

void pretend_targets(std::int64_t targets) {
  pretended.store(targets, std::memory_order_relaxed);
  dispatch::chosen.store(-1, std::memory_order_relaxed);
}

int dispatch::choose() {
  const std::int64_t supported = supported_targets();
  int best = 0;
  while (best < kTargets && (supported & kInOrder[best]) == 0) ++best;
  chosen.store(best, std::memory_order_relaxed);
  return best;
}

}  // namespace fas
