// SPDX-License-Identifier: MIT
// The templates of tree.h, batch.h and hierarchy.h around the caller's exact tests.
#include <bit>
#include <cmath>

#include "fas/structure.h"

namespace fas {
namespace {

using Class = Structure::Parts::Class;

}  // namespace

struct Tracer::Parts {
  explicit Parts(const Structure::Parts& s) : structure(s), state(const_cast<Pool&>(s.pool)) {}

  const Structure::Parts& structure;
  ThreadState state;
  LeafGroups groups;
  std::vector<std::uint8_t> u, v;
  std::vector<double> depth;
  std::vector<std::uint32_t> which;
  std::vector<std::uint64_t> elsewhere;  ///< by class: rays that went to the hierarchy by choice

  template <class Job>
  void ask(RayClass rays, Job& job);
  template <class Job>
  void through_hierarchy(Job& job, std::uint32_t i, const Cut& cut);
  template <class Job>
  void through_flat(const Class& rays, Job& job, std::span<const std::uint32_t> some);
  template <class Job>
  void through_beams(const Class& rays, Job& job, std::span<const std::uint32_t> some);
  template <class Job>
  void trace_groups(const Class& rays, Job& job);
};

namespace {

/// Nearest hits. What both kinds of jobs offer: `rays`, limit(i), whether ray i is settled, and
/// try_on(primitive, i), which answers whether that changed anything for ray i.
struct NearestJob {
  static constexpr bool kNearest = true;
  const Primitives& primitives;
  std::span<const Ray> rays;
  std::span<Hit> hits;
  std::uint64_t tests = 0;

  void start(std::uint32_t i) { hits[i] = {rays[i].far, Hit::kNone}; }
  double limit(std::uint32_t i) const { return hits[i].t; }
  bool settled(std::uint32_t /*i*/) const { return false; }
  bool any(std::uint32_t i) const { return hits[i].primitive != Hit::kNone; }
  bool try_on(std::uint32_t primitive, std::uint32_t i) {
    ++tests;
    Hit& best = hits[i];
    double t = 0;
    if (!primitives.intersect(primitive, rays[i], best.t, t)) return false;
    if (!(t < best.t || (t == best.t && primitive < best.primitive))) return false;
    best = {t, primitive};
    return true;
  }
};

struct OcclusionJob {
  static constexpr bool kNearest = false;
  const Primitives& primitives;
  std::span<const Ray> rays;
  std::span<std::uint8_t> occluded;
  std::uint64_t tests = 0;

  void start(std::uint32_t i) { occluded[i] = 0; }
  double limit(std::uint32_t i) const { return rays[i].far; }
  bool settled(std::uint32_t i) const { return occluded[i] != 0; }
  bool any(std::uint32_t i) const { return occluded[i] != 0; }
  bool try_on(std::uint32_t primitive, std::uint32_t i) {
    ++tests;
    occluded[i] = primitives.occludes(primitive, rays[i]) ? 1 : 0;
    return occluded[i] != 0;
  }
};

bool is_ray(const Point& direction) {
  const double sum = std::fabs(direction[0]) + std::fabs(direction[1]) + std::fabs(direction[2]);
  return sum > 0 && std::isfinite(sum);
}

/// Where a ray is in the flat tree of its class, and what the loops over leaves want of its depth: depth per
/// t from a point, where it starts otherwise. False: it is not of the class.
bool place(const Class& rays, const Ray& ray, HyperTree::Query& out, double& depth) {
  if (!is_ray(ray.direction)) return false;
  if (rays.kind == Class::Kind::kFromPoint) {
    if (ray.origin != rays.view.apex) return false;
    out = rays.flat->from_apex(ray.direction.data());
    depth = std::fabs(ray.direction[static_cast<std::size_t>(out.face >> 1)]);
    return true;
  }
  if (!aims_at(rays.view, ray.origin.data(), ray.direction.data(), ray.far)) return false;
  out = rays.flat->toward(ray.origin.data());
  depth = out.depth;
  return true;
}

bool place(const Class& rays, const Ray& ray, BeamTree::Query& out) {
  switch (rays.kind) {
    case Class::Kind::kFromBox:
      return rays.beams->place(ray.origin.data(), ray.direction.data(), out);
    case Class::Kind::kTowardBox: {
      Point end, back;
      for (std::size_t i = 0; i < 3; ++i) {
        end[i] = ray.origin[i] + ray.far * ray.direction[i];
        back[i] = -ray.direction[i];
      }
      return rays.beams->place(end.data(), back.data(), out);
    }
    default:
      return rays.beams->enter(ray.origin.data(), ray.direction.data(), out);
  }
}

}  // namespace

template <class Job>
void Tracer::Parts::through_hierarchy(Job& job, std::uint32_t i, const Cut& cut) {
  const Ray& ray = job.rays[i];
  const Hierarchy& hierarchy = *structure.hierarchy;
  BoxProbe probe;
  const ClipRay clip_ray(ray.origin.data(), ray.direction.data());
  if (!make_probe(hierarchy.clip_box(), structure.options.condition, clip_ray, ray.near, job.limit(i), probe))
    return;
  const auto visit = [&](std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t k = first; k < first + count && !job.settled(i); ++k)
      job.try_on(structure.order[k], i);
    return job.settled(i);
  };
  if (!probe.usable) {
    visit(0, static_cast<std::uint32_t>(structure.order.size()));
    return;
  }
  std::uint32_t box_tests = 0;
  traverse(
      hierarchy, cut, probe, 1, box_tests, [&] { return job.limit(i); }, visit);
}

template <class Job>
void Tracer::Parts::through_beams(const Class& rays, Job& job, std::span<const std::uint32_t> some) {
  BeamCache& cache = state.beam_cache(rays.beams->number());
  for (const std::uint32_t i : some) {
    BeamTree::Query at;
    if (!place(rays, job.rays[i], at)) {
      ++cache.counts.elsewhere;
      through_hierarchy(job, i, {});
      continue;
    }
    const BeamLeaf& leaf = rays.beams->find(at, cache);
    const std::uint64_t before = job.tests;
    through_hierarchy(job, i, leaf.cut);
    const auto tests = static_cast<std::uint32_t>(job.tests - before);
    rays.beams->charge(at, state, cache, leaf, 1 + leaf.cut.count + tests, tests, job.any(i));
  }
}

template <class Job>
void Tracer::Parts::through_flat(const Class& rays, Job& job, std::span<const std::uint32_t> some) {
  const std::uint32_t most = some.back() + 1;
  if (u.size() < most) {
    u.resize(most);
    v.resize(most);
    depth.resize(most);
  }
  groups.clear();
  TreeCache& cache = state.cache(rays.flat->number());
  for (const std::uint32_t i : some) {
    HyperTree::Query at;
    const Leaf* leaf = nullptr;
    const HyperTree::Place found = place(rays, job.rays[i], at, depth[i])
                                       ? rays.flat->find(at, state, cache, leaf, u[i], v[i])
                                       : HyperTree::Place::kElsewhere;
    if (found == HyperTree::Place::kLeaf) {
      groups.add(*rays.flat, leaf, at, i, most);
    } else if (found == HyperTree::Place::kElsewhere) {
      ++cache.counts.elsewhere;
      through_hierarchy(job, i, {});
    } else {
      ++cache.counts.rays;
      ++cache.counts.outside;
    }
  }
  trace_groups(rays, job);
}

template <class Job>
void Tracer::Parts::trace_groups(const Class& rays, Job& job) {
  for (const LeafGroups::Group& group : groups.groups()) {
    std::uint32_t next = group.first, left = group.count;
    while (left > 0) {
      GroupProbe probe;
      std::uint32_t at[GroupProbe::kMost];
      double depths[GroupProbe::kMost];
      for (; left > 0 && probe.count < GroupProbe::kMost; --left, next = groups.next(next)) {
        at[probe.count] = next;
        depths[probe.count] = depth[next];
        probe.u[probe.count] = u[next];
        probe.v[probe.count] = v[next];
        ++probe.count;
      }
      const auto test = [&](std::uint32_t place, std::uint64_t mask) {
        std::uint64_t changed = 0;
        for (; mask != 0; mask &= mask - 1) {
          const int k = std::countr_zero(mask);
          if (job.try_on(structure.order[place], at[k])) changed |= std::uint64_t{1} << k;
        }
        return changed;
      };
      if constexpr (Job::kNearest) {
        if (rays.kind == Class::Kind::kFromPoint)
          nearest_in_group(*rays.flat, state, *group.leaf, group.any, probe, test,
                           [&](int k) { return job.limit(at[k]) * depths[k]; });
        else
          nearest_toward_in_group(*rays.flat, state, *group.leaf, group.any, probe, depths, test);
      } else if (rays.kind == Class::Kind::kFromPoint) {
        std::uint64_t open = ~std::uint64_t{0};
        nearest_in_group(
            *rays.flat, state, *group.leaf, group.any, probe,
            [&](std::uint32_t place, std::uint64_t mask) {
              const std::uint64_t stopped = test(place, mask & open);
              open &= ~stopped;
              return stopped;
            },
            [&](int k) { return (open >> k & 1) != 0 ? job.limit(at[k]) * depths[k] : 0; });
      } else {
        occluded_in_group(*rays.flat, state, *group.leaf, group.any, probe, depths, test);
      }
    }
  }
}

template <class Job>
void Tracer::Parts::ask(RayClass number, Job& job) {
  const Class& rays = structure.classes.at(number.number);
  which.clear();
  for (std::uint32_t i = 0; i < job.rays.size(); ++i) {
    job.start(i);
    for (const std::uint32_t primitive : structure.unbounded) {
      job.try_on(primitive, i);
      if (job.settled(i)) break;
    }
    if (structure.hierarchy && !job.settled(i)) which.push_back(i);
  }
  if (which.empty()) return;
  const auto building = [&] {
    return rays.flat ? state.cache(rays.flat->number()).counts.nanoseconds
                     : state.beam_cache(rays.beams->number()).counts.nanoseconds;
  };
  const auto tree = [&](std::span<const std::uint32_t> some) {
    const std::uint64_t before = building();
    if (rays.flat)
      through_flat(rays, job, some);
    else
      through_beams(rays, job, some);
    return building() - before;
  };
  if (structure.options.always_split) {
    tree(which);
    return;
  }
  const auto hierarchy = [&](std::span<const std::uint32_t> some) {
    if (elsewhere.size() <= number.number) elsewhere.resize(number.number + 1);
    elsewhere[number.number] += some.size();
    const std::uint64_t before = job.tests;
    for (const std::uint32_t i : some) through_hierarchy(job, i, {});
    return job.tests - before;
  };
  ask_by_choice(*rays.choice, which, tree, hierarchy, hierarchy);
}

Tracer::Tracer(const Structure& structure) : parts_(std::make_unique<Parts>(*structure.parts_)) {}
Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;
Tracer& Tracer::operator=(Tracer&&) noexcept = default;

void Tracer::nearest(RayClass rays, std::span<const Ray> all, std::span<Hit> hits) {
  NearestJob job{parts_->structure.primitives, all, hits};
  parts_->ask(rays, job);
}

void Tracer::occluded(RayClass rays, std::span<const Ray> all, std::span<std::uint8_t> occluded) {
  OcclusionJob job{parts_->structure.primitives, all, occluded};
  parts_->ask(rays, job);
}

bool Tracer::nearest(RayClass rays, const Ray& ray, Hit& hit) {
  nearest(rays, {&ray, 1}, {&hit, 1});
  return hit.primitive != Hit::kNone;
}

bool Tracer::occluded(RayClass rays, const Ray& ray) {
  std::uint8_t answer = 0;
  occluded(rays, {&ray, 1}, {&answer, 1});
  return answer != 0;
}

Statistics Tracer::statistics(RayClass rays) const {
  const Class& of = parts_->structure.classes.at(rays.number);
  TreeCounts counts;
  if (of.flat)
    counts = parts_->state.cache(of.flat->number()).counts;
  else if (of.beams)
    counts = parts_->state.beam_cache(of.beams->number()).counts;
  Statistics out;
  out.rays = counts.rays;
  out.elsewhere =
      counts.elsewhere + (rays.number < parts_->elsewhere.size() ? parts_->elsewhere[rays.number] : 0);
  out.tests = counts.tests;
  out.leaves = counts.leaves;
  out.candidates = counts.candidates;
  out.splits = counts.splits;
  out.bytes = counts.bytes;
  out.nanoseconds = counts.nanoseconds;
  return out;
}

}  // namespace fas
