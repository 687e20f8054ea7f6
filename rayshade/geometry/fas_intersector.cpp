// SPDX-License-Identifier: MIT
// Adaptive subdivision as an Intersector: which rays go to which tree. Rays of classes without extent in
// space (eye rays of a pinhole, shadow rays of point, spot and directional lights) are answered by the
// hyper-tree of their class, all others by the world's hierarchy; what is not bounded is tested apart. Trees
// only choose which leaves are tested.
#include "fas/tree.h"
#include "rayshade/geometry/intersector.h"
#include "rayshade/geometry/pack_tracer.h"
#include "rayshade/geometry/trace_context.h"
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

  void nearest(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
               TraceScratch& scratch) const override {
    fas::ThreadState& state = state_of(scratch);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const NearestQuery& query = queries[i];
      NearestAnswer& answer = answers[i];
      TraceContext context(scene_, scratch);
      start_search(answer.hit, query.hi);
      bool found = false;
      if (query.kind != RayKind::kEye || !nearest_from_eye(context, state, query, answer.hit, found)) {
        found = improve_by_group(context, 0, query.ray, query.lo, query.mask, 0, answer.hit);
      }
      answer.found = found && before_far_limit(answer.hit, query.hi);
      answer.tests = context.tests;
      answer.bounds_tests = context.bounds_tests;
    }
  }

  void occluded(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers,
                TraceScratch& scratch) const override {
    fas::ThreadState& state = state_of(scratch);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const OcclusionQuery& query = queries[i];
      TraceContext context(scene_, scratch);
      bool occluded = false;
      if (!occluded_toward_light(context, state, query, occluded)) {
        occluded = group_occludes(context, 0, query.ray, query.lo, query.hi, query.mask);
      }
      answers[i].occluded = occluded;
      answers[i].tests = context.tests;
      answers[i].bounds_tests = context.bounds_tests;
    }
  }

 private:
  /// Trees without a node yet.
  void grow() {
    candidates_ = std::make_unique<TreeCandidates>(scene_, 0);
    trees_ = 0;
    eye_ = make_tree(options_.eye, options_.split);
    lights_.clear();
    for (const RayClass& light : options_.lights) lights_.push_back(make_tree(light, options_.split));
  }

  std::unique_ptr<fas::HyperTree> make_tree(const RayClass& rays, fas::Split split) {
    if (rays.kind == RayClass::Kind::kSpread) return nullptr;
    const auto kind =
        rays.kind == RayClass::Kind::kPoint ? fas::View::Kind::kPoint : fas::View::Kind::kParallel;
    const fas::View view = fas::make_view(kind, {rays.point.x, rays.point.y, rays.point.z},
                                          candidates_->bounds(), world_.condition);
    return std::make_unique<fas::HyperTree>(view, *candidates_, pool_, tuner_, trees_++, split);
  }

  fas::ThreadState& state_of(TraceScratch& scratch) const {
    if (!scratch.trees) scratch.trees = std::make_unique<fas::ThreadState>(pool_);
    return *scratch.trees;
  }

  /// False: the hierarchy must be asked.
  bool nearest_from_eye(TraceContext& context, fas::ThreadState& state, const NearestQuery& query, Hit& best,
                        bool& found) const {
    if (!eye_) return false;
    const Vec3 &o = query.ray.origin, &d = query.ray.direction;
    const fas::Point& apex = eye_->view().apex;
    if (o.x != apex[0] || o.y != apex[1] || o.z != apex[2] || !is_finite(d) || d == Vec3{}) return false;
    const double direction[3] = {d.x, d.y, d.z};
    const LeafId bounded = world_.first + world_.unbounded;
    const auto test = [&](std::uint32_t candidate) {
      const bool improved =
          improve_by_leaf(context, bounded + candidate, query.ray, query.lo, query.mask, 0, best);
      found |= improved;
      return improved;
    };
    for (LeafId id = world_.first; id < bounded; ++id) {
      found |= improve_by_leaf(context, id, query.ray, query.lo, query.mask, 0, best);
    }
    const auto place = fas::nearest_from_apex(
        *eye_, state, direction, [&] { return best.shape.t; }, test);
    return place != fas::HyperTree::Place::kElsewhere;
  }

  bool occluded_toward_light(TraceContext& context, fas::ThreadState& state, const OcclusionQuery& query,
                             bool& occluded) const {
    if (query.light >= lights_.size() || !lights_[query.light]) return false;
    fas::HyperTree& tree = *lights_[query.light];
    const Vec3 &o = query.ray.origin, &d = query.ray.direction;
    const double origin[3] = {o.x, o.y, o.z}, direction[3] = {d.x, d.y, d.z};
    if (!fas::aims_at(tree.view(), origin, direction)) return false;
    const LeafId bounded = world_.first + world_.unbounded;
    const auto test = [&](std::uint32_t candidate) {
      return leaf_occludes(context, bounded + candidate, query.ray, query.lo, query.hi, query.mask);
    };
    for (LeafId id = world_.first; id < bounded; ++id) {
      if (leaf_occludes(context, id, query.ray, query.lo, query.hi, query.mask)) {
        occluded = true;
        return true;
      }
    }
    return fas::occluded_toward(tree, state, origin, test, occluded) != fas::HyperTree::Place::kElsewhere;
  }

  const CompiledScene& scene_;
  const Group& world_;
  FasOptions options_;
  std::unique_ptr<TreeCandidates> candidates_;
  mutable fas::Pool pool_;
  mutable fas::Tuner tuner_;
  std::size_t trees_ = 0;
  std::unique_ptr<fas::HyperTree> eye_;
  std::vector<std::unique_ptr<fas::HyperTree>> lights_;
};

}  // namespace

std::unique_ptr<Intersector> make_fas(const CompiledScene& scene, const FasOptions& options) {
  if (!scene.groups[0].hierarchy || traces_in_packs(scene)) return make_hierarchy(scene);
  return std::make_unique<FasIntersector>(scene, options);
}

}  // namespace rayshade
