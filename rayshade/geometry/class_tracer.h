// SPDX-License-Identifier: MIT
// One class of rays: through its hyper-tree, or through the world's hierarchy alone, whichever has been
// faster.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "fas/batch.h"
#include "fas/beam_tree.h"
#include "fas/choice.h"
#include "rayshade/geometry/intersector.h"
#include "rayshade/geometry/intersector_report.h"

namespace rayshade {

class PackTracer;

/// What one thread needs to sort a span. Queries that ask for leaves of the same opacity can share a pack.
struct Batch {
  static constexpr std::size_t kMasks = 3;  ///< opacity masks that are not 0

  fas::LeafGroups groups[kMasks];
  std::vector<std::uint32_t> outside[kMasks];     ///< rays that bounded leaves cannot stop
  std::vector<std::vector<std::uint32_t>> which;  ///< queries by class
  std::vector<std::uint8_t> u, v;
  std::vector<double> depth;  ///< rays from the apex: depth per t; rays toward it: where they start
  std::vector<HierarchyCounts> in_hierarchy;  ///< by class
  HierarchyCounts* counts = nullptr;          ///< of the class at hand
  /// Queries of all classes that go through the hierarchy together; and where those of a class end in them.
  std::vector<std::uint32_t> rest;
  struct RestOfClass {
    std::size_t end;
    HierarchyCounts* counts;
  };
  std::vector<RestOfClass> rest_of_classes;
};

class ClassTracer {
 public:
  /// All rays go through the hierarchy.
  explicit ClassTracer(const CompiledScene& scene) : scene_(scene) {}
  /// Rays without extent in space. `from_apex`: nearest queries start at the apex of the tree's view; all
  /// others of this class go toward it, or along its direction. `expected`: about how many rays; `always`:
  /// all of them go through the tree, whatever it costs.
  ClassTracer(const CompiledScene& scene, std::unique_ptr<fas::HyperTree> tree, bool from_apex,
              double expected, bool always);
  /// Rays with extent in space. Nearest queries are placed by their start, occlusion queries by their end.
  ClassTracer(const CompiledScene& scene, std::unique_ptr<fas::BeamTree> tree, double expected, bool always);

  /// Answers the queries of the class, which are those numbered `which`, in rising order, or leaves them to
  /// ask_rest().
  void ask(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
           std::span<const std::uint32_t> which, fas::ThreadState& state, Batch& batch,
           TraceScratch& scratch) const;
  void ask(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers,
           std::span<const std::uint32_t> which, fas::ThreadState& state, Batch& batch,
           TraceScratch& scratch) const;

  const fas::HyperTree* flat() const { return flat_.get(); }
  const fas::BeamTree* beams() const { return beams_.get(); }
  const fas::Choice* choice() const { return choice_.get(); }

 private:
  // One trace of queries of either kind; the template parameters are those of the seam.
  template <class Query, class Answer>
  void choose(std::span<const Query> queries, std::span<Answer> answers, std::span<const std::uint32_t> which,
              fas::ThreadState& state, Batch& batch, TraceScratch& scratch) const;
  /// Returns the nanoseconds that it took to make nodes.
  template <class Query, class Answer>
  std::uint64_t ask_tree(std::span<const Query> queries, std::span<Answer> answers,
                         std::span<const std::uint32_t> which, fas::ThreadState& state, Batch& batch,
                         TraceScratch& scratch) const;
  template <class Query, class Answer>
  std::uint64_t ask_hierarchy(std::span<const Query> queries, std::span<Answer> answers,
                              std::span<const std::uint32_t> which, Batch& batch,
                              TraceScratch& scratch) const;
  template <class Query, class Answer>
  void ask_hierarchy(const Query& query, Answer& answer, Batch& batch, TraceScratch& scratch) const;
  template <class Query, class Answer>
  void ask_beams(std::span<const Query> queries, std::span<Answer> answers,
                 std::span<const std::uint32_t> which, fas::ThreadState& state, Batch& batch,
                 TraceScratch& scratch) const;
  template <class Query, class Answer>
  void ask_flat(std::span<const Query> queries, std::span<Answer> answers,
                std::span<const std::uint32_t> which, fas::ThreadState& state, Batch& batch,
                TraceScratch& scratch) const;
  template <class Query, class Answer>
  void trace_outside(std::span<const Query> queries, std::span<Answer> answers,
                     std::span<const std::uint32_t> which, PackTracer& tracer) const;
  template <class Query, class Answer>
  void trace_groups(std::span<const Query> queries, std::span<Answer> answers, const fas::LeafGroups& groups,
                    const Batch& batch, fas::ThreadState& state, PackTracer& tracer) const;
  bool place(const NearestQuery& query, fas::HyperTree::Query& out, double& depth) const;
  bool place(const OcclusionQuery& query, fas::HyperTree::Query& out, double& depth) const;
  bool place_toward(const Ray& ray, double lo, double hi, fas::HyperTree::Query& out, double& depth) const;

  const CompiledScene& scene_;
  std::unique_ptr<fas::HyperTree> flat_;
  std::unique_ptr<fas::BeamTree> beams_;
  std::unique_ptr<fas::Choice> choice_;  ///< with a tree only
  bool from_apex_ = false, always_ = false;
};

/// Answers what ask() of the classes has left for later (Batch::rest).
template <class Query, class Answer>
void ask_rest(const CompiledScene& scene, std::span<const Query> queries, std::span<Answer> answers,
              Batch& batch, TraceScratch& scratch);

}  // namespace rayshade
