// SPDX-License-Identifier: MIT
// Spans of queries through the world's hierarchy: rays whose directions have the same signs in packs, what
// is left over one by one. The answers are the same.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "rayshade/geometry/pack_tracer.h"

namespace rayshade {

class HierarchyPacks {
 public:
  /// `scene` has hierarchies.
  HierarchyPacks(const CompiledScene& scene, TraceScratch& scratch);
  HierarchyPacks(const HierarchyPacks&) = delete;
  HierarchyPacks& operator=(const HierarchyPacks&) = delete;

  /// Answers queries[i] in answers[i], for every i of `which`.
  void ask(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
           std::span<const std::uint32_t> which);
  void ask(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers,
           std::span<const std::uint32_t> which);
  /// All of them.
  void ask(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers);
  void ask(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers);

 private:
  /// Rays that can share a pack: of one octant of directions and one opacity mask.
  static constexpr std::size_t kKinds = 8 * 3;
  struct Waiting {
    std::uint32_t count = 0;
    std::array<std::uint32_t, RayPack::kMost> places;
  };

  // `places`: the numbers of `count` queries; null: the first ones.
  template <class Query, class Answer>
  void ask(std::span<const Query> queries, std::span<Answer> answers, const std::uint32_t* places,
           std::size_t count);
  template <class Query, class Answer>
  void trace(std::span<const Query> queries, std::span<Answer> answers, const std::uint32_t* places,
             std::size_t count);
  void walk(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
            const std::uint32_t* places, std::size_t count);
  void walk(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers,
            const std::uint32_t* places, std::size_t count);
  /// Tests what the hierarchy holds: `test(first, last, rays, shortened)` tests leaves, adds the rays whose
  /// far limits have changed to `shortened`, and returns those that need nothing more.
  template <class Test>
  void through_hierarchy(Opacity opacity, RayPack::Mask rays, const Test& test);

  const CompiledScene& scene_;
  const Group& world_;
  TraceScratch& scratch_;
  PackTracer tracer_;
  std::array<Waiting, kKinds> waiting_;
};

}  // namespace rayshade
