// SPDX-License-Identifier: MIT
#include "rayshade/geometry/hierarchy_packs.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "fas/pack_walk.h"
#include "rayshade/geometry/trace_context.h"

namespace rayshade {
namespace {

std::size_t octant(const Vec3& d) {
  return static_cast<std::size_t>(std::signbit(d.x)) + 2 * static_cast<std::size_t>(std::signbit(d.y)) +
         4 * static_cast<std::size_t>(std::signbit(d.z));
}

/// Whether queries can share a pack.
template <class Query>
bool alike(std::span<const Query> queries, const std::uint32_t* places, std::size_t count) {
  const auto query = [&](std::size_t k) -> const Query& { return queries[places ? places[k] : k]; };
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  const Vec3 first = query(0).ray.direction;
  const Opacity mask = query(0).mask;
  std::uint64_t signs = 0;
  unsigned masks = 0;
  for (std::size_t k = 1; k < count; ++k) {
    const Vec3& d = query(k).ray.direction;
    signs |= (bits(d.x) ^ bits(first.x)) | (bits(d.y) ^ bits(first.y)) | (bits(d.z) ^ bits(first.z));
    masks |= static_cast<unsigned>(query(k).mask) ^ static_cast<unsigned>(mask);
  }
  return signs >> 63 == 0 && masks == 0;
}

}  // namespace

HierarchyPacks::HierarchyPacks(const CompiledScene& scene, TraceScratch& scratch)
    : scene_(scene), world_(scene.groups[0]), scratch_(scratch), tracer_(scene, scratch) {}

void HierarchyPacks::ask(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
                         std::span<const std::uint32_t> which) {
  ask(queries, answers, which.data(), which.size());
}

void HierarchyPacks::ask(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers,
                         std::span<const std::uint32_t> which) {
  ask(queries, answers, which.data(), which.size());
}

void HierarchyPacks::ask(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers) {
  ask(queries, answers, nullptr, queries.size());
}

void HierarchyPacks::ask(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers) {
  ask(queries, answers, nullptr, queries.size());
}

/// Neighbours are packed as they come where they are alike, as most are; others wait for their like.
template <class Query, class Answer>
void HierarchyPacks::ask(std::span<const Query> queries, std::span<Answer> answers,
                         const std::uint32_t* places, std::size_t count) {
  for (std::size_t first = 0; first < count; first += RayPack::kMost) {
    const std::size_t n = std::min<std::size_t>(RayPack::kMost, count - first);
    const std::span<const Query> some = places ? queries : queries.subspan(first);
    const std::uint32_t* const own = places ? places + first : nullptr;
    if (alike(some, own, n)) {
      trace(some, places ? answers : answers.subspan(first), own, n);
      continue;
    }
    for (std::size_t k = first; k < first + n; ++k) {
      const auto i = places ? places[k] : static_cast<std::uint32_t>(k);
      const Query& query = queries[i];
      Waiting& waiting =
          waiting_[octant(query.ray.direction) + 8 * (static_cast<std::size_t>(query.mask) - 1)];
      waiting.places[waiting.count++] = i;
      if (waiting.count < RayPack::kMost) continue;
      trace(queries, answers, waiting.places.data(), waiting.count);
      waiting.count = 0;
    }
  }
  for (Waiting& waiting : waiting_) {
    if (waiting.count > 0) trace(queries, answers, waiting.places.data(), waiting.count);
    waiting.count = 0;
  }
}

template <class Query, class Answer>
void HierarchyPacks::trace(std::span<const Query> queries, std::span<Answer> answers,
                           const std::uint32_t* places, std::size_t count) {
  if (count >= PackTracer::kFewest) {
    walk(queries, answers, places, count);
    return;
  }
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = places ? places[k] : k;
    ask_world(scene_, queries[i], answers[i], scratch_);
  }
}

void HierarchyPacks::walk(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
                          const std::uint32_t* places, std::size_t count) {
  tracer_.load(queries, answers, places, static_cast<int>(count));
  const RayPack::Mask all = tracer_.pack().all();
  for (LeafId leaf = world_.first; leaf < world_.first + world_.unbounded; ++leaf) tracer_.improve(leaf, all);
  through_hierarchy(tracer_.opacity(), all,
                    [&](LeafId first, LeafId last, RayPack::Mask rays, RayPack::Mask& shortened) {
                      for (LeafId leaf = first; leaf < last; ++leaf) shortened |= tracer_.improve(leaf, rays);
                      return RayPack::Mask{0};
                    });
  tracer_.answer_nearest();
}

void HierarchyPacks::walk(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers,
                          const std::uint32_t* places, std::size_t count) {
  tracer_.load(queries, places, static_cast<int>(count));
  RayPack::Mask open = tracer_.pack().all();
  const auto try_leaves = [&](LeafId first, LeafId last, RayPack::Mask rays) {
    RayPack::Mask known = 0;
    for (LeafId leaf = first; leaf < last && known != rays; ++leaf)
      known |= tracer_.occlude(leaf, rays & ~known);
    return known;
  };
  open &= ~try_leaves(world_.first, world_.first + world_.unbounded, open);
  // What lies outside the mask counts too: see OcclusionAnswer::others.
  through_hierarchy(kAnyOpacity, open,
                    [&](LeafId first, LeafId last, RayPack::Mask rays, RayPack::Mask& /*shortened*/) {
                      return try_leaves(first, last, rays);
                    });
  tracer_.answer_occluded(answers);
}

template <class Test>
void HierarchyPacks::through_hierarchy(Opacity opacity, RayPack::Mask rays, const Test& test) {
  if (rays == 0) return;
  const LeafId bounded = world_.first + world_.unbounded;
  fas::PackProbe probe;
  fas::PackProbe::Mask met = 0, unusable = 0;
  tracer_.count_bounds(rays);
  fas::make_probes(world_.hierarchy->clip_box(), world_.condition, tracer_.rays(), probe, met, unusable);
  RayPack::Mask shortened = 0;
  if ((unusable & rays) != 0) test(bounded, world_.first + world_.count, unusable & rays, shortened);
  fas::traverse(*world_.hierarchy, probe, opacity, met & rays & ~unusable, tracer_.counter().bounds(),
                [&](std::uint32_t first, std::uint32_t count, fas::PackProbe::Mask some) {
                  shortened = 0;
                  const RayPack::Mask done = test(bounded + first, bounded + first + count, some, shortened);
                  for_each_ray(shortened, [&](std::size_t i) { probe.shorten(i, tracer_.pack().t[i]); });
                  return done;
                });
}

}  // namespace rayshade
