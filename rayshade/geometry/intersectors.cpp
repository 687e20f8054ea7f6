// SPDX-License-Identifier: MIT
#include "rayshade/geometry/intersector.h"
#include "rayshade/geometry/trace_context.h"

namespace rayshade {
namespace {

/// Answers from the groups of the compiled scene: by loops over every leaf, or by their hierarchies.
class GroupIntersector : public Intersector {
 public:
  GroupIntersector(const CompiledScene& scene, bool brute_force) : scene_(scene), brute_force_(brute_force) {}

  void nearest(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
               TraceScratch& scratch) const override {
    const Mode mode(scratch, brute_force_);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const NearestQuery& query = queries[i];
      NearestAnswer& answer = answers[i];
      TraceContext context(scene_, scratch);
      start_search(answer.hit, query.hi);
      answer.found = improve_by_group(context, 0, query.ray, query.lo, query.mask, 0, answer.hit) &&
                     before_far_limit(answer.hit, query.hi);
      answer.tests = context.tests;
      answer.bounds_tests = context.bounds_tests;
    }
  }

  void occluded(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers,
                TraceScratch& scratch) const override {
    const Mode mode(scratch, brute_force_);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const OcclusionQuery& query = queries[i];
      TraceContext context(scene_, scratch);
      answers[i].occluded = group_occludes(context, 0, query.ray, query.lo, query.hi, query.mask);
      answers[i].tests = context.tests;
      answers[i].bounds_tests = context.bounds_tests;
    }
  }

 private:
  /// Sets the scratch's mode for the duration of one span.
  class Mode {
   public:
    Mode(TraceScratch& scratch, bool brute_force) : scratch_(scratch), before_(scratch.brute_force) {
      scratch.brute_force = brute_force;
    }
    ~Mode() { scratch_.brute_force = before_; }
    Mode(const Mode&) = delete;
    Mode& operator=(const Mode&) = delete;

   private:
    TraceScratch& scratch_;
    bool before_;
  };

  const CompiledScene& scene_;
  bool brute_force_;
};

}  // namespace

std::unique_ptr<Intersector> make_brute_force(const CompiledScene& scene) {
  return std::make_unique<GroupIntersector>(scene, true);
}

std::unique_ptr<Intersector> make_hierarchy(const CompiledScene& scene) {
  return std::make_unique<GroupIntersector>(scene, false);
}

}  // namespace rayshade
