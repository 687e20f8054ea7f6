// SPDX-License-Identifier: MIT
// Adaptive subdivision as an Intersector: which rays go to which tree. Rays of classes without extent in
// space (eye rays of a pinhole, shadow rays of point, spot and directional lights) are answered by the
// hyper-tree of their class, all others by the world's hierarchy; what is not bounded is tested apart. Trees
// only choose which leaves are tested.
#include <algorithm>
#include <array>
#include <cmath>

#include "fas/batch.h"
#include "rayshade/geometry/intersector.h"
#include "rayshade/geometry/pack_tracer.h"
#include "rayshade/geometry/trace_context.h"
#include "rayshade/geometry/tree_candidates.h"

namespace rayshade {
namespace {

/// What one thread needs to sort a span by leaf.
struct Batch {
  fas::LeafGroups groups;
  std::vector<std::uint8_t> u, v;
  std::vector<double> depth;  ///< eye rays: depth per t; rays toward lights: where they start
  std::vector<std::uint32_t> outside;
  void resize(std::size_t count) {
    if (u.size() >= count) return;
    u.resize(count);
    v.resize(count);
    depth.resize(count);
    outside.resize(count);
  }
};

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
    fas::ThreadState& state = state_of(scratch);
    Batch& batch = batch_of(scratch);
    for (std::size_t first = 0; first < queries.size(); first += kMostAtOnce) {
      const std::size_t count = std::min(kMostAtOnce, queries.size() - first);
      const auto some = queries.subspan(first, count);
      // Spans are of one kind, or nearly so: what is in the wrong one is answered by the world.
      if (some[0].kind == RayKind::kShadow)
        walk_batch(some, answers.subspan(first, count), state, batch, scratch);
      else
        nearest_batch(some, answers.subspan(first, count), state, batch, scratch);
    }
  }

  void occluded(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers,
                TraceScratch& scratch) const override {
    fas::ThreadState& state = state_of(scratch);
    Batch& batch = batch_of(scratch);
    for (std::size_t first = 0; first < queries.size(); first += kMostAtOnce) {
      const std::size_t count = std::min(kMostAtOnce, queries.size() - first);
      occluded_batch(queries.subspan(first, count), answers.subspan(first, count), state, batch, scratch);
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

  static constexpr std::size_t kMostAtOnce = 4096;

  Batch& batch_of(TraceScratch& scratch) const {
    if (!scratch.batch) scratch.batch = std::make_shared<Batch>();
    return *static_cast<Batch*>(scratch.batch.get());
  }

  bool from_eye(const NearestQuery& query) const {
    if (query.kind != RayKind::kEye || !eye_ || query.mask != kAnyOpacity) return false;
    const Vec3 &o = query.ray.origin, &d = query.ray.direction;
    const fas::Point& apex = eye_->view().apex;
    return o.x == apex[0] && o.y == apex[1] && o.z == apex[2] && max_abs(d) > 0 && is_finite(d);
  }

  void nearest_batch(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
                     fas::ThreadState& state, Batch& batch, TraceScratch& scratch) const {
    batch.groups.clear();
    batch.resize(queries.size());
    const auto count = static_cast<std::uint32_t>(queries.size());
    std::uint32_t outside = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const NearestQuery& query = queries[i];
      if (!from_eye(query)) {
        ask_world(scene_, query, answers[i], scratch);
        continue;
      }
      const double d[3] = {query.ray.direction.x, query.ray.direction.y, query.ray.direction.z};
      const fas::HyperTree::Query place = eye_->from_apex(d);
      fas::TreeCache& cache = state.cache(eye_->number());
      const fas::Leaf* leaf = nullptr;
      switch (eye_->find(place, state, cache, leaf, batch.u[i], batch.v[i])) {
        case fas::HyperTree::Place::kElsewhere:
          ++cache.counts.elsewhere;
          ask_world(scene_, query, answers[i], scratch);
          break;
        case fas::HyperTree::Place::kNothing:
          ++cache.counts.outside;
          ++cache.counts.rays;
          batch.outside[outside++] = i;
          break;
        case fas::HyperTree::Place::kLeaf:
          batch.depth[i] = std::fabs(d[place.face >> 1]);
          batch.groups.add(*eye_, leaf, place, i, count);
          break;
      }
    }
    PackTracer tracer(scene_, scratch);
    for (std::uint32_t first = 0; first < outside; first += RayPack::kMost) {
      const int n = static_cast<int>(std::min<std::uint32_t>(RayPack::kMost, outside - first));
      tracer.load(queries, answers, batch.outside.data() + first, n);
      improve_by_unbounded(tracer);
      tracer.answer_nearest();
    }
    const LeafId bounded = world_.first + world_.unbounded;
    for (const fas::LeafGroups::Group& group : batch.groups.groups()) {
      std::uint32_t place = group.first, left = group.count;
      while (left > 0) {
        fas::GroupProbe probe;
        std::array<std::uint32_t, RayPack::kMost> places;
        for (; left > 0 && probe.count < RayPack::kMost; --left, place = batch.groups.next(place)) {
          places[static_cast<std::size_t>(probe.count)] = place;
          probe.u[probe.count] = batch.u[place];
          probe.v[probe.count] = batch.v[place];
          ++probe.count;
        }
        tracer.load(queries, answers, places.data(), probe.count);
        improve_by_unbounded(tracer);
        fas::nearest_in_group(
            *group.tree, state, *group.leaf, group.any, probe,
            [&](std::uint32_t candidate, std::uint64_t mask) {
              return tracer.improve(bounded + candidate, mask);
            },
            [&](int i) { return tracer.pack().t[i] * batch.depth[places[static_cast<std::size_t>(i)]]; });
        tracer.count_bounds(tracer.pack().all());
        tracer.answer_nearest();
      }
    }
  }

  void improve_by_unbounded(PackTracer& tracer) const {
    for (std::uint32_t k = 0; k < world_.unbounded; ++k)
      tracer.improve(world_.first + k, tracer.pack().all());
  }

  /// Sorts queries toward lights by leaf. Those that no tree takes are answered by the world at once; those
  /// in whose way nothing bounded is stay in batch.outside, whose size is returned.
  template <class Query, class Answer>
  std::uint32_t sort_toward_lights(std::span<const Query> queries, std::span<Answer> answers,
                                   fas::ThreadState& state, Batch& batch, TraceScratch& scratch) const {
    batch.groups.clear();
    batch.resize(queries.size());
    const auto count = static_cast<std::uint32_t>(queries.size());
    std::uint32_t outside = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const Query& query = queries[i];
      fas::HyperTree* tree = query.light < lights_.size() ? lights_[query.light].get() : nullptr;
      const Vec3 &o = query.ray.origin, &d = query.ray.direction;
      const double origin[3] = {o.x, o.y, o.z}, direction[3] = {d.x, d.y, d.z};
      if (!tree || query.mask != queries[0].mask || !fas::aims_at(tree->view(), origin, direction)) {
        ask_world(scene_, query, answers[i], scratch);
        continue;
      }
      const fas::HyperTree::Query place = tree->toward(origin);
      fas::TreeCache& cache = state.cache(tree->number());
      const fas::Leaf* leaf = nullptr;
      switch (tree->find(place, state, cache, leaf, batch.u[i], batch.v[i])) {
        case fas::HyperTree::Place::kElsewhere:
          ++cache.counts.elsewhere;
          ask_world(scene_, query, answers[i], scratch);
          break;
        case fas::HyperTree::Place::kNothing:
          ++cache.counts.outside;
          ++cache.counts.rays;
          if (world_.unbounded > 0)
            batch.outside[outside++] = i;
          else
            answer_nothing(answers[i]);
          break;
        case fas::HyperTree::Place::kLeaf:
          batch.depth[i] = depth_at(*tree, place, direction, query.lo);
          batch.groups.add(*tree, leaf, place, i, count);
          break;
      }
    }
    return outside;
  }

  /// Depth of the point at t = `lo` on a ray toward the light: what is farther from the light than that is of
  /// no interest. (The rounding of this sum of two is well within what quantised() allows for.)
  static double depth_at(const fas::HyperTree& tree, const fas::HyperTree::Query& place, const double* d,
                         double lo) {
    if (tree.view().kind == fas::View::Kind::kParallel) return place.depth - lo;
    return place.depth - lo * std::fabs(d[place.face >> 1]);
  }

  static void answer_nothing(OcclusionAnswer& answer) { answer = {}; }
  static void answer_nothing(NearestAnswer& answer) {
    answer.found = false;
    answer.tests = answer.bounds_tests = 0;
  }

  /// Calls `answer(places, count, group, probe, depths)` for packs of queries that share a leaf, and
  /// `unbounded(places, count)` for those in whose way nothing bounded is.
  template <class Pack, class Unbounded>
  static void each_pack(const Batch& batch, std::uint32_t outside, const Unbounded& unbounded,
                        const Pack& pack) {
    for (std::uint32_t first = 0; first < outside; first += RayPack::kMost) {
      unbounded(batch.outside.data() + first,
                static_cast<int>(std::min<std::uint32_t>(RayPack::kMost, outside - first)));
    }
    for (const fas::LeafGroups::Group& group : batch.groups.groups()) {
      std::uint32_t place = group.first, left = group.count;
      while (left > 0) {
        fas::GroupProbe probe;
        std::array<std::uint32_t, RayPack::kMost> places;
        std::array<double, RayPack::kMost> depths;
        for (; left > 0 && probe.count < RayPack::kMost; --left, place = batch.groups.next(place)) {
          const auto k = static_cast<std::size_t>(probe.count);
          places[k] = place;
          depths[k] = batch.depth[place];
          probe.u[k] = batch.u[place];
          probe.v[k] = batch.v[place];
          ++probe.count;
        }
        pack(group, probe, places.data(), depths.data());
      }
    }
  }

  void occluded_batch(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers,
                      fas::ThreadState& state, Batch& batch, TraceScratch& scratch) const {
    const std::uint32_t outside = sort_toward_lights(queries, answers, state, batch, scratch);
    PackTracer tracer(scene_, scratch);
    const LeafId bounded = world_.first + world_.unbounded;
    each_pack(
        batch, outside,
        [&](const std::uint32_t* places, int n) {
          tracer.load(queries, places, n);
          occlude_by_unbounded(tracer);
          tracer.answer_occluded(answers);
        },
        [&](const fas::LeafGroups::Group& group, fas::GroupProbe& probe, const std::uint32_t* places,
            const double* depths) {
          tracer.load(queries, places, probe.count);
          const RayPack::Mask known = occlude_by_unbounded(tracer);
          fas::occluded_in_group(*group.tree, state, *group.leaf, group.any, probe, depths,
                                 [&](std::uint32_t candidate, std::uint64_t mask) {
                                   return tracer.occlude(bounded + candidate, mask & ~known) | (mask & known);
                                 });
          tracer.count_bounds(tracer.pack().all());
          tracer.answer_occluded(answers);
        });
  }

  /// Nearest hits of rays toward lights: those of walks through transparent surfaces.
  void walk_batch(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
                  fas::ThreadState& state, Batch& batch, TraceScratch& scratch) const {
    const std::uint32_t outside = sort_toward_lights(queries, answers, state, batch, scratch);
    PackTracer tracer(scene_, scratch);
    const LeafId bounded = world_.first + world_.unbounded;
    each_pack(
        batch, outside,
        [&](const std::uint32_t* places, int n) {
          tracer.load(queries, answers, places, n);
          improve_by_unbounded(tracer);
          tracer.answer_nearest();
        },
        [&](const fas::LeafGroups::Group& group, fas::GroupProbe& probe, const std::uint32_t* places,
            const double* depths) {
          tracer.load(queries, answers, places, probe.count);
          improve_by_unbounded(tracer);
          // Candidates are in the order of the light, not of the ray, so that every one is tested.
          fas::occluded_in_group(*group.tree, state, *group.leaf, group.any, probe, depths,
                                 [&](std::uint32_t candidate, std::uint64_t mask) {
                                   tracer.improve(bounded + candidate, mask);
                                   return RayPack::Mask{0};
                                 });
          tracer.count_bounds(tracer.pack().all());
          tracer.answer_nearest();
        });
  }

  /// Returns those whose answer is known by that.
  RayPack::Mask occlude_by_unbounded(PackTracer& tracer) const {
    RayPack::Mask known = 0;
    const RayPack::Mask all = tracer.pack().all();
    for (std::uint32_t k = 0; k < world_.unbounded && known != all; ++k)
      known |= tracer.occlude(world_.first + k, all & ~known);
    return known;
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
