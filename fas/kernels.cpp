// SPDX-License-Identifier: MIT
#include "fas/kernels.h"

#include <cstring>

#include "fas/compiled_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fas/kernels.cpp"  // NOLINT: Highway includes this file once per target
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "fas/dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace fas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Unsigned x <= y where the saturated difference x - y is zero, so one comparison serves all five bounds.
HWY_ATTR inline std::uint64_t area_mask(const std::uint8_t* block, std::size_t s, int n, std::uint8_t u,
                                        std::uint8_t v, std::uint8_t z) {
  const hn::CappedTag<std::uint8_t, 64> d;
  const auto pu = hn::Set(d, u), pv = hn::Set(d, v), pz = hn::Set(d, z);
  std::uint64_t mask = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); i += hn::Lanes(d)) {
    const auto low_u = hn::SaturatedSub(hn::LoadU(d, block + i), pu);
    const auto high_u = hn::SaturatedSub(pu, hn::LoadU(d, block + s + i));
    const auto low_v = hn::SaturatedSub(hn::LoadU(d, block + 2 * s + i), pv);
    const auto high_v = hn::SaturatedSub(pv, hn::LoadU(d, block + 3 * s + i));
    const auto low_z = hn::SaturatedSub(hn::LoadU(d, block + 4 * s + i), pz);
    const auto outside = hn::Or(hn::Or(hn::Or(low_u, high_u), hn::Or(low_v, high_v)), low_z);
    std::uint64_t bits = 0;
    hn::StoreMaskBits(d, hn::Eq(outside, hn::Zero(d)), reinterpret_cast<std::uint8_t*>(&bits));
    mask |= bits << i;
  }
  return n >= 64 ? mask : mask & ((std::uint64_t{1} << n) - 1);
}

HWY_ATTR inline std::uint64_t cut_mask(const std::uint8_t* block, std::size_t s, int n, std::uint8_t u,
                                       std::uint8_t v) {
  const hn::CappedTag<std::int16_t, 32> d;
  const hn::Rebind<std::int8_t, decltype(d)> d8;
  const auto pu = hn::Set(d, static_cast<std::int16_t>(u - 128));
  const auto pv = hn::Set(d, static_cast<std::int16_t>(v - 128));
  const auto* ab = reinterpret_cast<const std::int8_t*>(block + Block::kAreaBytes * s);
  const std::uint8_t* c = block + (Block::kAreaBytes + 6) * s;
  std::uint64_t mask = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); i += hn::Lanes(d)) {
    auto least = hn::Zero(d);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = hn::PromoteTo(d, hn::LoadU(d8, ab + 2 * k * s + i));
      const auto b = hn::PromoteTo(d, hn::LoadU(d8, ab + (2 * k + 1) * s + i));
      const auto offset = hn::LoadU(d, reinterpret_cast<const std::int16_t*>(c + 2 * k * s) + i);
      // |a u + b v| <= 2 x 127 x 128 fits; the sum with the offset may not.
      const auto value = hn::SaturatedAdd(hn::Add(hn::Mul(a, pu), hn::Mul(b, pv)), offset);
      least = hn::Min(least, value);
    }
    std::uint64_t bits = 0;
    hn::StoreMaskBits(d, hn::Eq(least, hn::Zero(d)), reinterpret_cast<std::uint8_t*>(&bits));
    mask |= bits << i;
  }
  return mask;
}

HWY_ATTR std::uint64_t match(const std::uint8_t* block, int n, bool cuts, Probe probe) {
  const std::size_t s = Block::stride(static_cast<std::size_t>(n));
  std::uint64_t mask = area_mask(block, s, n, probe.u, probe.v, probe.z);
  if (cuts && mask != 0) mask &= cut_mask(block, s, n, probe.u, probe.v);
  return mask;
}

HWY_ATTR std::uint64_t match_rays(const std::uint8_t* block, std::size_t s, std::size_t i, bool cuts,
                                  const std::uint8_t* u, const std::uint8_t* v, const std::uint8_t* z,
                                  int count) {
  const hn::CappedTag<std::uint8_t, 64> d;
  const auto low_u = hn::Set(d, block[i]), high_u = hn::Set(d, block[s + i]);
  const auto low_v = hn::Set(d, block[2 * s + i]), high_v = hn::Set(d, block[3 * s + i]);
  const auto low_z = hn::Set(d, block[4 * s + i]);
  std::uint64_t mask = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); k += hn::Lanes(d)) {
    const auto pu = hn::LoadU(d, u + k), pv = hn::LoadU(d, v + k), pz = hn::LoadU(d, z + k);
    const auto outside_u = hn::Or(hn::SaturatedSub(low_u, pu), hn::SaturatedSub(pu, high_u));
    const auto outside_v = hn::Or(hn::SaturatedSub(low_v, pv), hn::SaturatedSub(pv, high_v));
    const auto outside = hn::Or(hn::Or(outside_u, outside_v), hn::SaturatedSub(low_z, pz));
    std::uint64_t bits = 0;
    hn::StoreMaskBits(d, hn::Eq(outside, hn::Zero(d)), reinterpret_cast<std::uint8_t*>(&bits));
    mask |= bits << k;
  }
  if (count < 64) mask &= (std::uint64_t{1} << count) - 1;
  if (!cuts || mask == 0) return mask;
  const hn::CappedTag<std::int16_t, 32> d16;
  const hn::Rebind<std::uint8_t, decltype(d16)> d8;
  const auto* ab = reinterpret_cast<const std::int8_t*>(block + Block::kAreaBytes * s);
  const std::uint8_t* c = block + (Block::kAreaBytes + 6) * s;
  const auto half = hn::Set(d16, 128);
  std::uint64_t within = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); k += hn::Lanes(d16)) {
    const auto pu = hn::Sub(hn::PromoteTo(d16, hn::LoadU(d8, u + k)), half);
    const auto pv = hn::Sub(hn::PromoteTo(d16, hn::LoadU(d8, v + k)), half);
    auto least = hn::Zero(d16);
    for (std::size_t e = 0; e < 3; ++e) {
      std::int16_t offset = 0;
      std::memcpy(&offset, c + 2 * e * s + 2 * i, sizeof offset);
      const auto a = hn::Set(d16, static_cast<std::int16_t>(ab[2 * e * s + i]));
      const auto b = hn::Set(d16, static_cast<std::int16_t>(ab[(2 * e + 1) * s + i]));
      least = hn::Min(least, hn::SaturatedAdd(hn::Add(hn::Mul(a, pu), hn::Mul(b, pv)), hn::Set(d16, offset)));
    }
    std::uint64_t bits = 0;
    hn::StoreMaskBits(d16, hn::Eq(least, hn::Zero(d16)), reinterpret_cast<std::uint8_t*>(&bits));
    within |= bits << k;
  }
  return mask & within;
}

const char* name() { return hwy::TargetName(HWY_TARGET); }

}  // namespace fas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fas {
namespace {

std::uint64_t scalar_match(const std::uint8_t* block, int n, bool cuts, Probe probe) {
  const std::size_t s = Block::stride(static_cast<std::size_t>(n));
  const auto* ab = reinterpret_cast<const std::int8_t*>(block + Block::kAreaBytes * s);
  const std::uint8_t* c = block + (Block::kAreaBytes + 6) * s;
  std::uint64_t mask = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
    bool inside = block[i] <= probe.u && probe.u <= block[s + i] && block[2 * s + i] <= probe.v &&
                  probe.v <= block[3 * s + i] && block[4 * s + i] <= probe.z;
    for (std::size_t k = 0; cuts && inside && k < 3; ++k) {
      std::int16_t offset = 0;
      std::memcpy(&offset, c + 2 * k * s + 2 * i, sizeof offset);
      inside = ab[2 * k * s + i] * (probe.u - 128) + ab[(2 * k + 1) * s + i] * (probe.v - 128) + offset >= 0;
    }
    if (inside) mask |= std::uint64_t{1} << i;
  }
  return mask;
}

std::uint64_t scalar_match_rays(const std::uint8_t* block, std::size_t s, std::size_t i, bool cuts,
                                const std::uint8_t* u, const std::uint8_t* v, const std::uint8_t* z,
                                int count) {
  const auto* ab = reinterpret_cast<const std::int8_t*>(block + Block::kAreaBytes * s);
  const std::uint8_t* c = block + (Block::kAreaBytes + 6) * s;
  std::uint64_t mask = 0;
  for (int k = 0; k < count; ++k) {
    bool inside = block[i] <= u[k] && u[k] <= block[s + i] && block[2 * s + i] <= v[k] &&
                  v[k] <= block[3 * s + i] && block[4 * s + i] <= z[k];
    for (std::size_t e = 0; cuts && inside && e < 3; ++e) {
      std::int16_t offset = 0;
      std::memcpy(&offset, c + 2 * e * s + 2 * i, sizeof offset);
      inside = ab[2 * e * s + i] * (u[k] - 128) + ab[(2 * e + 1) * s + i] * (v[k] - 128) + offset >= 0;
    }
    if (inside) mask |= std::uint64_t{1} << k;
  }
  return mask;
}

}  // namespace

Kernels dispatched_kernels() {
  return {FAS_VERSIONS(match).best(), FAS_VERSIONS(match_rays).best(), FAS_VERSIONS(name).best()()};
}

const Kernels& kernels() {
  static const Kernels chosen = dispatched_kernels();
  return chosen;
}

const Kernels& scalar_kernels() {
  static const Kernels plain{scalar_match, scalar_match_rays, "scalar"};
  return plain;
}

}  // namespace fas
#endif
