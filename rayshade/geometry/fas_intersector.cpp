// SPDX-License-Identifier: MIT
// Adaptive subdivision as an Intersector: which rays belong to which class. Rays of classes without extent in
// space (eye rays of a pinhole, rays toward point, spot and directional lights) are sorted by the leaves of a
// flat hyper-tree and tested many at once; rays with extent (from a lens, reflected, transmitted, toward area
// and extended lights) start their traversals from the leaves of a five-dimensional one. What is not bounded
// is tested apart. Trees only choose which leaves of the scene are tested.
#include <algorithm>
#include <numeric>

#include "rayshade/geometry/class_tracer.h"
#include "rayshade/geometry/intersector.h"
#include "rayshade/geometry/pack_tracer.h"
#include "rayshade/geometry/tree_candidates.h"

namespace rayshade {
namespace {

class FasIntersector final : public Intersector {
 public:
  FasIntersector(const CompiledScene& scene, const FasOptions& options)
      : scene_(scene), world_(scene.groups[0]), options_(options), pool_(options.memory) {
    grow();
  }

  void scene_changed() override {
    pool_.reset();
    grow();
  }

  /// Rays of a span share leaves, the more the longer it is.
  std::size_t preferred_span() const override { return 512; }

  void nearest(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
               TraceScratch& scratch) const override {
    ask(queries, answers, scratch);
  }

  void occluded(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers,
                TraceScratch& scratch) const override {
    ask(queries, answers, scratch);
  }

  void report(const TraceScratch& scratch, IntersectorReport& into) const override {
    into.method = IntersectorReport::Method::kTrees;
    into.classes.resize(classes_.size());
    for (std::size_t c = 0; c < classes_.size(); ++c) report_class(c, scratch, into.classes[c]);
    into.pool_used = std::max<std::uint64_t>(into.pool_used, pool_.used());
    into.pool_held = std::max<std::uint64_t>(into.pool_held, pool_.held());
    into.pool_budget = pool_.budget();
    into.pool_exhausted |= pool_.exhausted();
  }

  const fas::HyperTree* eye_tree() const override { return classes_[kEye].flat(); }

 private:
  static constexpr std::size_t kMostAtOnce = 4096;

  /// Classes: these, then one for each light and one for shadow rays of no light.
  enum Class : std::size_t { kEye, kReflected, kTransmitted, kFirstLight };

  /// Trees without a node yet.
  void grow() {
    candidates_ = std::make_unique<TreeCandidates>(scene_, 0);
    trees_ = beam_trees_ = 0;
    const fas::Bounds& world = world_.hierarchy->bounds();
    classes_.clear();
    add(options_.eye, true);
    add(world);
    add(world);
    for (const RayClass& light : options_.lights) add(light, false);
    classes_.emplace_back(scene_);
  }

  void add(const RayClass& rays, bool from_apex) {
    if (rays.kind == RayClass::Kind::kSpread) {
      if (rays.bounds.empty()) {
        classes_.emplace_back(scene_);
        return;
      }
      // Rays start where their surfaces end, and may miss where they were meant to go by as much.
      const double margin = 1e-6 * (scene_.scale + max_abs(rays.bounds.lo) + max_abs(rays.bounds.hi));
      const Bounds3 box = grown(rays.bounds, margin);
      add({{box.lo.x, box.lo.y, box.lo.z}, {box.hi.x, box.hi.y, box.hi.z}});
      return;
    }
    const auto kind =
        rays.kind == RayClass::Kind::kPoint ? fas::View::Kind::kPoint : fas::View::Kind::kParallel;
    const fas::View view = fas::make_view(kind, {rays.point.x, rays.point.y, rays.point.z},
                                          candidates_->bounds(), world_.condition);
    classes_.emplace_back(
        scene_, std::make_unique<fas::HyperTree>(view, *candidates_, pool_, tuner_, trees_++, options_.split),
        from_apex, options_.rays, always());
  }
  void add(const fas::Bounds& origins) {
    classes_.emplace_back(scene_,
                          std::make_unique<fas::BeamTree>(*world_.hierarchy, origins, world_.condition, pool_,
                                                          tuner_, beam_trees_++, options_.split),
                          options_.rays, always());
  }
  bool always() const { return !options_.choose || options_.split == fas::Split::kAlways; }

  std::size_t light_class(std::uint32_t light) const {
    return kFirstLight + std::min<std::size_t>(light, options_.lights.size());
  }
  std::size_t class_of(const NearestQuery& query) const {
    switch (query.kind) {
      case RayKind::kEye:
        return kEye;
      case RayKind::kReflected:
        return kReflected;
      case RayKind::kTransmitted:
        return kTransmitted;
      default:  // behind glass; a tree for ends has no use for their starts
        const std::size_t light = light_class(query.light);
        return classes_[light].flat() ? light : classes_.size() - 1;
    }
  }
  std::size_t class_of(const OcclusionQuery& query) const { return light_class(query.light); }

  /// Whether two queries are of one class; false where it takes longer to tell.
  static bool of_one_class(const NearestQuery& a, const NearestQuery& b) {
    return a.kind == b.kind && a.light == b.light;
  }
  static bool of_one_class(const OcclusionQuery& a, const OcclusionQuery& b) { return a.light == b.light; }

  void report_class(std::size_t number, const TraceScratch& scratch, ClassReport& into) const {
    using Rays = ClassReport::Rays;
    using Tree = ClassReport::Tree;
    const ClassTracer& tracer = classes_[number];
    into.tree = tracer.flat() ? Tree::kFlat : tracer.beams() ? Tree::kDeep : Tree::kNoTree;
    switch (number) {
      case kEye:
        into.rays = Rays::kEye;
        break;
      case kReflected:
        into.rays = Rays::kReflected;
        break;
      case kTransmitted:
        into.rays = Rays::kTransmitted;
        break;
      default:
        into.light = static_cast<std::uint32_t>(number - kFirstLight);
        into.rays = into.light < options_.lights.size() ? Rays::kLight : Rays::kOther;
    }
    if (!scratch.trees || !scratch.batch) return;
    const auto add = [&](const auto& caches, std::size_t tree) {
      if (tree < caches.size()) into.in_tree.add(caches[tree].counts);
    };
    if (tracer.flat()) add(scratch.trees->caches, tracer.flat()->number());
    if (tracer.beams()) add(scratch.trees->beam_caches, tracer.beams()->number());
    const auto& in_hierarchy = static_cast<const Batch*>(scratch.batch.get())->in_hierarchy;
    if (number < in_hierarchy.size()) into.in_hierarchy.add(in_hierarchy[number]);
  }

  template <class Query, class Answer>
  void ask(std::span<const Query> queries, std::span<Answer> answers, TraceScratch& scratch) const {
    if (!scratch.trees) scratch.trees = std::make_unique<fas::ThreadState>(pool_);
    if (!scratch.batch) scratch.batch = std::make_shared<Batch>();
    Batch& batch = *static_cast<Batch*>(scratch.batch.get());
    batch.which.resize(std::max(batch.which.size(), classes_.size()));
    batch.in_hierarchy.resize(batch.which.size());
    for (std::size_t first = 0; first < queries.size(); first += kMostAtOnce) {
      const std::size_t count = std::min(kMostAtOnce, queries.size() - first);
      const auto some = queries.subspan(first, count);
      const auto into = answers.subspan(first, count);
      for (std::size_t i = 0; i < count;) {
        std::size_t end = i + 1;
        while (end < count && of_one_class(some[i], some[end])) ++end;
        std::vector<std::uint32_t>& which = batch.which[class_of(some[i])];
        const std::size_t known = which.size();
        which.resize(known + (end - i));
        std::iota(which.begin() + static_cast<std::ptrdiff_t>(known), which.end(),
                  static_cast<std::uint32_t>(i));
        i = end;
      }
      for (std::size_t c = 0; c < classes_.size(); ++c) {
        if (batch.which[c].empty()) continue;
        batch.counts = &batch.in_hierarchy[c];
        classes_[c].ask(some, into, batch.which[c], *scratch.trees, batch, scratch);
        batch.which[c].clear();
      }
      ask_rest(scene_, some, into, batch, scratch);
    }
  }

  const CompiledScene& scene_;
  const Group& world_;
  FasOptions options_;
  std::unique_ptr<TreeCandidates> candidates_;
  mutable fas::Pool pool_;
  fas::Tuner tuner_;
  std::size_t trees_ = 0, beam_trees_ = 0;
  std::vector<ClassTracer> classes_;
};

}  // namespace

std::unique_ptr<Intersector> make_fas(const CompiledScene& scene, const FasOptions& options) {
  if (!scene.groups[0].hierarchy || traces_in_packs(scene)) return make_hierarchy(scene);
  return std::make_unique<FasIntersector>(scene, options);
}

}  // namespace rayshade
