// SPDX-License-Identifier: MIT
#include <bit>

#include "rayshade/geometry/trace.h"

namespace rayshade {
namespace {

/// Entries per transform; fewer where there are many transforms.
constexpr std::size_t kWays = 64, kWaysOfMany = 4, kFew = 1024;

AffinePair inverted(const Affine& forward, const TransformList& list, double time) {
  const auto back = inverse(forward);
  if (back) return {forward, *back};
  Location where;
  for (const TransformList::Element& element : list.elements()) {
    if (element.animated) where = element.animated->location;
  }
  throw MotionError("the transforms of an object have no inverse", where, time);
}

}  // namespace

MotionCache::Entry& MotionCache::entry(std::vector<std::vector<Entry>>& table, std::size_t size,
                                       std::uint32_t index, double time) {
  if (table.size() < size) table.resize(size);
  std::vector<Entry>& ways = table[index];
  if (ways.empty()) ways.resize(size <= kFew ? kWays : kWaysOfMany);
  const std::uint64_t hash = std::bit_cast<std::uint64_t>(time) * 0x9E3779B97F4A7C15u;
  return ways[(hash >> 32) % ways.size()];
}

const AffinePair& MotionCache::placement(const CompiledScene& scene, std::uint32_t index, double time) {
  Entry& e = entry(placements_, scene.placements.size(), index, time);
  if (e.valid && e.time == time && e.frame == scene.frame) return e.map;
  e.valid = false;
  const Placement& placement = scene.placements[index];
  AffinePair map;
  for (const TransformList* list : placement.lists) {
    const AffinePair level = inverted(list->at({time, scene.frame}), *list, time);
    map = {then(map.forward, level.forward), then(level.inverse, map.inverse)};
  }
  e = {time, scene.frame, true, map};
  return e.map;
}

const AffinePair& MotionCache::level(const CompiledScene& scene, std::uint32_t index, double time) {
  Entry& e = entry(levels_, scene.scene->transforms.size(), index, time);
  if (e.valid && e.time == time && e.frame == scene.frame) return e.map;
  e.valid = false;
  const TransformList& list = scene.scene->transforms[index];
  e = {time, scene.frame, true, inverted(list.at({time, scene.frame}), list, time)};
  return e.map;
}

}  // namespace rayshade
