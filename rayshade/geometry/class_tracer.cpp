// SPDX-License-Identifier: MIT
#include "rayshade/geometry/class_tracer.h"

#include <array>
#include <cmath>

#include "rayshade/geometry/hierarchy_packs.h"
#include "rayshade/geometry/pack_tracer.h"
#include "rayshade/geometry/trace_context.h"

namespace rayshade {
namespace {

using Place = fas::HyperTree::Place;

/// Rays go through the hierarchy in packs, so that boxes cost little: trees spare them exact tests. Rays
/// through trees of beams go alone.
constexpr fas::Choice::Saving kFlatSaving{0.25, 3}, kDeepSaving{0.25, 8};

std::size_t mask_number(Opacity mask) { return static_cast<std::size_t>(mask) - 1; }

bool has_hit(const NearestAnswer& answer) { return answer.found; }
bool has_hit(const OcclusionAnswer& answer) { return answer.occluded; }

void set_free(NearestAnswer& answer) {
  answer.found = false;
  answer.tests = answer.bounds_tests = 0;
}
void set_free(OcclusionAnswer& answer) { answer = {}; }

bool place(const fas::BeamTree& tree, const NearestQuery& query, fas::BeamTree::Query& out) {
  const Vec3 &o = query.ray.origin, &d = query.ray.direction;
  const double origin[3] = {o.x, o.y, o.z}, direction[3] = {d.x, d.y, d.z};
  return tree.enter(origin, direction, out);
}

/// Rays toward a light are seen from the light, where they have little extent: what is between the ends of a
/// segment does not depend on the direction in which it is run through.
bool place(const fas::BeamTree& tree, const OcclusionQuery& query, fas::BeamTree::Query& out) {
  const Vec3 end = query.ray.at(query.hi);
  const Vec3& d = query.ray.direction;
  const double origin[3] = {end.x, end.y, end.z}, direction[3] = {-d.x, -d.y, -d.z};
  return tree.place(origin, direction, out);
}

// What nearest hits and occlusion do differently in a pack. Masks are of the rays whose answer is known.

void load(PackTracer& tracer, std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
          const std::uint32_t* places, int count) {
  tracer.load(queries, answers, places, count);
}
void load(PackTracer& tracer, std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> /*answers*/,
          const std::uint32_t* places, int count) {
  tracer.load(queries, places, count);
}

RayPack::Mask try_leaf(PackTracer& tracer, std::span<const NearestQuery> /*kind*/, LeafId leaf,
                       RayPack::Mask mask) {
  tracer.improve(leaf, mask);
  return 0;
}
RayPack::Mask try_leaf(PackTracer& tracer, std::span<const OcclusionQuery> /*kind*/, LeafId leaf,
                       RayPack::Mask mask) {
  return mask != 0 ? tracer.occlude(leaf, mask) : 0;
}

void answer(PackTracer& tracer, std::span<NearestAnswer> /*answers*/) { tracer.answer_nearest(); }
void answer(PackTracer& tracer, std::span<OcclusionAnswer> answers) { tracer.answer_occluded(answers); }

template <class Query>
RayPack::Mask try_unbounded(PackTracer& tracer, const Group& world, std::span<const Query> kind) {
  RayPack::Mask known = 0;
  for (LeafId leaf = world.first; leaf < world.first + world.unbounded; ++leaf)
    known |= try_leaf(tracer, kind, leaf, tracer.pack().all() & ~known);
  return known;
}

}  // namespace

ClassTracer::ClassTracer(const CompiledScene& scene, std::unique_ptr<fas::HyperTree> tree, bool from_apex,
                         double expected, bool always)
    : scene_(scene),
      flat_(std::move(tree)),
      choice_(std::make_unique<fas::Choice>(expected, fas::Choice::kMakePrimitive * scene.groups[0].count,
                                            kFlatSaving)),
      from_apex_(from_apex),
      always_(always) {}

ClassTracer::ClassTracer(const CompiledScene& scene, std::unique_ptr<fas::BeamTree> tree, double expected,
                         bool always)
    : scene_(scene),
      beams_(std::move(tree)),
      choice_(std::make_unique<fas::Choice>(expected, 0, kDeepSaving)),
      always_(always) {}

void ClassTracer::ask(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
                      std::span<const std::uint32_t> which, fas::ThreadState& state, Batch& batch,
                      TraceScratch& scratch) const {
  choose(queries, answers, which, state, batch, scratch);
}

void ClassTracer::ask(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers,
                      std::span<const std::uint32_t> which, fas::ThreadState& state, Batch& batch,
                      TraceScratch& scratch) const {
  choose(queries, answers, which, state, batch, scratch);
}

template <class Query, class Answer>
void ClassTracer::choose(std::span<const Query> queries, std::span<Answer> answers,
                         std::span<const std::uint32_t> which, fas::ThreadState& state, Batch& batch,
                         TraceScratch& scratch) const {
  const auto tree = [&](std::span<const std::uint32_t> some) {
    return ask_tree(queries, answers, some, state, batch, scratch);
  };
  const auto hierarchy = [&](std::span<const std::uint32_t> some) {
    return ask_hierarchy(queries, answers, some, batch, scratch);
  };
  const auto later = [&](std::span<const std::uint32_t> some) {
    batch.rest.insert(batch.rest.end(), some.begin(), some.end());
    batch.rest_of_classes.push_back({batch.rest.size(), batch.counts});
  };
  if (!choice_)
    later(which);
  else if (always_)
    tree(which);
  else
    fas::ask_by_choice(*choice_, which, tree, hierarchy, later);
}

template <class Query, class Answer>
void ask_rest(const CompiledScene& scene, std::span<const Query> queries, std::span<Answer> answers,
              Batch& batch, TraceScratch& scratch) {
  if (batch.rest.empty()) return;
  HierarchyPacks packs(scene, scratch);
  // Those of one class stand in rising order.
  if (batch.rest_of_classes.size() == 1 && batch.rest.size() == queries.size())
    packs.ask(queries, answers);
  else
    packs.ask(queries, answers, batch.rest);
  std::size_t k = 0;
  for (const Batch::RestOfClass& part : batch.rest_of_classes) {
    HierarchyCounts sum;
    for (; k < part.end; ++k) {
      const Answer& answer = answers[batch.rest[k]];
      sum.add({1, answer.tests, answer.bounds_tests});
    }
    part.counts->add(sum);
  }
  batch.rest.clear();
  batch.rest_of_classes.clear();
}
template void ask_rest(const CompiledScene&, std::span<const NearestQuery>, std::span<NearestAnswer>, Batch&,
                       TraceScratch&);
template void ask_rest(const CompiledScene&, std::span<const OcclusionQuery>, std::span<OcclusionAnswer>,
                       Batch&, TraceScratch&);

template <class Query, class Answer>
std::uint64_t ClassTracer::ask_hierarchy(std::span<const Query> queries, std::span<Answer> answers,
                                         std::span<const std::uint32_t> which, Batch& batch,
                                         TraceScratch& scratch) const {
  HierarchyPacks packs(scene_, scratch);
  packs.ask(queries, answers, which);
  const std::uint64_t before = batch.counts->tests;
  for (const std::uint32_t i : which) batch.counts->add({1, answers[i].tests, answers[i].bounds_tests});
  return batch.counts->tests - before;
}

template <class Query, class Answer>
void ClassTracer::ask_hierarchy(const Query& query, Answer& answer, Batch& batch,
                                TraceScratch& scratch) const {
  ask_world(scene_, query, answer, scratch);
  batch.counts->add({1, answer.tests, answer.bounds_tests});
}

template <class Query, class Answer>
std::uint64_t ClassTracer::ask_tree(std::span<const Query> queries, std::span<Answer> answers,
                                    std::span<const std::uint32_t> which, fas::ThreadState& state,
                                    Batch& batch, TraceScratch& scratch) const {
  const auto building = [&] {
    return flat_ ? state.cache(flat_->number()).counts.nanoseconds
                 : state.beam_cache(beams_->number()).counts.nanoseconds;
  };
  const std::uint64_t before = building();
  if (flat_)
    ask_flat(queries, answers, which, state, batch, scratch);
  else
    ask_beams(queries, answers, which, state, batch, scratch);
  return building() - before;
}

template <class Query, class Answer>
void ClassTracer::ask_beams(std::span<const Query> queries, std::span<Answer> answers,
                            std::span<const std::uint32_t> which, fas::ThreadState& state, Batch& batch,
                            TraceScratch& scratch) const {
  fas::BeamCache& cache = state.beam_cache(beams_->number());
  for (const std::uint32_t i : which) {
    fas::BeamTree::Query at;
    if (!rayshade::place(*beams_, queries[i], at)) {
      ++cache.counts.elsewhere;
      ask_hierarchy(queries[i], answers[i], batch, scratch);
      continue;
    }
    const fas::BeamLeaf& leaf = beams_->find(at, cache);
    ask_world(scene_, queries[i], answers[i], scratch, leaf.cut);
    beams_->charge(at, state, cache, leaf, answers[i].bounds_tests, answers[i].tests, has_hit(answers[i]));
  }
}

bool ClassTracer::place(const NearestQuery& query, fas::HyperTree::Query& out, double& depth) const {
  if (!from_apex_) return place_toward(query.ray, query.lo, query.hi, out, depth);
  const Vec3 &o = query.ray.origin, &d = query.ray.direction;
  const fas::Point& apex = flat_->view().apex;
  if (!(o.x == apex[0] && o.y == apex[1] && o.z == apex[2] && max_abs(d) > 0 && is_finite(d))) return false;
  const double direction[3] = {d.x, d.y, d.z};
  out = flat_->from_apex(direction);
  depth = std::fabs(direction[out.face >> 1]);
  return true;
}

bool ClassTracer::place(const OcclusionQuery& query, fas::HyperTree::Query& out, double& depth) const {
  return place_toward(query.ray, query.lo, query.hi, out, depth);
}

bool ClassTracer::place_toward(const Ray& ray, double lo, double hi, fas::HyperTree::Query& out,
                               double& depth) const {
  const Vec3 &o = ray.origin, &d = ray.direction;
  const double origin[3] = {o.x, o.y, o.z}, direction[3] = {d.x, d.y, d.z};
  if (!fas::aims_at(flat_->view(), origin, direction, hi)) return false;
  out = flat_->toward(origin);
  // Where t = lo: what is farther from the light than that is of no interest. (The rounding of this sum of
  // two is well within what quantised() allows for.)
  const bool parallel = flat_->view().kind == fas::View::Kind::kParallel;
  depth = out.depth - lo * (parallel ? 1 : std::fabs(direction[out.face >> 1]));
  return true;
}

template <class Query, class Answer>
void ClassTracer::ask_flat(std::span<const Query> queries, std::span<Answer> answers,
                           std::span<const std::uint32_t> which, fas::ThreadState& state, Batch& batch,
                           TraceScratch& scratch) const {
  for (std::size_t mask = 0; mask < Batch::kMasks; ++mask) {
    batch.groups[mask].clear();
    batch.outside[mask].clear();
  }
  const std::uint32_t most = which.back() + 1;
  if (batch.u.size() < most) {
    batch.u.resize(most);
    batch.v.resize(most);
    batch.depth.resize(most);
  }
  fas::TreeCache& cache = state.cache(flat_->number());
  for (const std::uint32_t i : which) {
    const Query& query = queries[i];
    fas::HyperTree::Query at;
    const fas::Leaf* leaf = nullptr;
    const Place found = place(query, at, batch.depth[i])
                            ? flat_->find(at, state, cache, leaf, batch.u[i], batch.v[i])
                            : Place::kElsewhere;
    switch (found) {
      case Place::kElsewhere:
        ++cache.counts.elsewhere;
        ask_hierarchy(query, answers[i], batch, scratch);
        break;
      case Place::kNothing:
        ++cache.counts.outside;
        ++cache.counts.rays;
        batch.outside[mask_number(query.mask)].push_back(i);
        break;
      case Place::kLeaf:
        batch.groups[mask_number(query.mask)].add(*flat_, leaf, at, i, most);
        break;
    }
  }
  PackTracer tracer(scene_, scratch);
  for (std::size_t mask = 0; mask < Batch::kMasks; ++mask) {
    trace_outside(queries, answers, batch.outside[mask], tracer);
    trace_groups(queries, answers, batch.groups[mask], batch, state, tracer);
  }
}

/// Rays with only unbounded leaves in their way.
template <class Query, class Answer>
void ClassTracer::trace_outside(std::span<const Query> queries, std::span<Answer> answers,
                                std::span<const std::uint32_t> which, PackTracer& tracer) const {
  const Group& world = scene_.groups[0];
  if (world.unbounded == 0) {
    for (const std::uint32_t i : which) set_free(answers[i]);
    return;
  }
  for (std::size_t first = 0; first < which.size(); first += RayPack::kMost) {
    const int n = static_cast<int>(std::min<std::size_t>(RayPack::kMost, which.size() - first));
    load(tracer, queries, answers, which.data() + first, n);
    try_unbounded(tracer, world, queries);
    answer(tracer, answers);
  }
}

template <class Query, class Answer>
void ClassTracer::trace_groups(std::span<const Query> queries, std::span<Answer> answers,
                               const fas::LeafGroups& groups, const Batch& batch, fas::ThreadState& state,
                               PackTracer& tracer) const {
  const Group& world = scene_.groups[0];
  const LeafId bounded = world.first + world.unbounded;
  for (const fas::LeafGroups::Group& group : groups.groups()) {
    std::uint32_t place = group.first, left = group.count;
    while (left > 0) {
      fas::GroupProbe probe;
      std::array<std::uint32_t, RayPack::kMost> places;
      std::array<double, RayPack::kMost> depths;
      for (; left > 0 && probe.count < RayPack::kMost; --left, place = groups.next(place)) {
        const auto k = static_cast<std::size_t>(probe.count);
        places[k] = place;
        depths[k] = batch.depth[place];
        probe.u[k] = batch.u[place];
        probe.v[k] = batch.v[place];
        ++probe.count;
      }
      load(tracer, queries, answers, places.data(), probe.count);
      const RayPack::Mask known = try_unbounded(tracer, world, queries);
      if constexpr (std::is_same_v<Query, NearestQuery>) {
        const auto improve = [&](std::uint32_t candidate, std::uint64_t mask) {
          return tracer.improve(bounded + candidate, mask);
        };
        if (from_apex_) {
          fas::nearest_in_group(*flat_, state, *group.leaf, group.any, probe, improve, [&](int i) {
            return tracer.pack().t[i] * depths[static_cast<std::size_t>(i)];
          });
        } else {
          fas::nearest_toward_in_group(*flat_, state, *group.leaf, group.any, probe, depths.data(), improve);
        }
      } else {
        fas::occluded_in_group(*flat_, state, *group.leaf, group.any, probe, depths.data(),
                               [&](std::uint32_t candidate, std::uint64_t mask) {
                                 return try_leaf(tracer, queries, bounded + candidate, mask & ~known) |
                                        (mask & known);
                               });
      }
      tracer.count_bounds(tracer.pack().all());
      answer(tracer, answers);
    }
  }
}

}  // namespace rayshade
