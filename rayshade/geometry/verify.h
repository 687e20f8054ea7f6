// SPDX-License-Identifier: MIT
// An intersector that checks another: a share of all queries is asked again of brute force while rendering,
// and every answer that differs is counted, the first few with all that is needed to ask again. Which queries
// are checked depends on their own bits alone, not on threads or on the order of blocks.
//
// The answers given to shading are always those of the intersector that is checked; brute force has scratches
// of its own, so that neither counts nor caches of the run are disturbed.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "rayshade/geometry/intersector.h"

namespace rayshade {

struct VerifyOptions {
  double share = 1;  ///< of all queries, 0 to 1
  /// What lights are called in reports, by the number that queries have.
  std::vector<std::string> light_names;
  /// Told of the first kMostReported differences, one text of a few lines each; never called by two threads
  /// at once.
  std::function<void(const std::string&)> report;
  static constexpr std::uint64_t kMostReported = 10;
};

struct VerifyCounts {
  std::uint64_t nearest = 0;    ///< nearest queries asked again
  std::uint64_t occlusion = 0;  ///< occlusion queries asked again
  std::uint64_t differing = 0;  ///< of both: answers that were not those of brute force
  std::uint64_t rays() const { return nearest + occlusion; }
};

/// Whether two answers are the same: found or not, and if found, the same leaf through the same instances
/// with the same rank, distance and surface parameters, to the last bit.
bool same_answer(const NearestAnswer& a, const NearestAnswer& b);

/// Whether a query is among those checked: a share of them, by a hash of the ray, its limits and its mask.
bool is_chosen(const NearestQuery& query, double share);
bool is_chosen(const OcclusionQuery& query, double share);

class VerifyingIntersector final : public Intersector {
 public:
  /// `scene` must outlive this.
  VerifyingIntersector(const CompiledScene& scene, std::unique_ptr<Intersector> inner, VerifyOptions options);
  ~VerifyingIntersector() override;

  void nearest(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
               TraceScratch& scratch) const override;
  void occluded(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers,
                TraceScratch& scratch) const override;
  std::size_t preferred_span() const override { return inner_->preferred_span(); }
  void scene_changed() override;
  void report(const TraceScratch& scratch, IntersectorReport& into) const override {
    inner_->report(scratch, into);
  }
  const fas::HyperTree* eye_tree() const override { return inner_->eye_tree(); }

  /// Of all queries so far. No thread may be tracing.
  VerifyCounts counts() const;

 private:
  struct Slot;
  struct Shared;
  class Lease;
  void ask_oracle(std::span<const OcclusionAnswer> answers, Slot& slot) const;
  template <class Query, class Answer>
  void verify(std::span<const Query> queries, std::span<const Answer> answers,
              const TraceScratch& scratch) const;

  const CompiledScene& scene_;
  std::unique_ptr<Intersector> inner_, oracle_;
  VerifyOptions options_;
  std::unique_ptr<Shared> shared_;
};

}  // namespace rayshade
