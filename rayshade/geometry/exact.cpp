// SPDX-License-Identifier: MIT
// exact(leaf, ray, interval), and the loops over groups.
#include <numeric>

#include "fas/hierarchy.h"
#include "rayshade/geometry/trace_context.h"

namespace rayshade {
namespace {

template <class Shape>
bool improve_by_shape(TraceContext& context, const Shape& shape, const Leaf& leaf, LeafId id,
                      const Ray& local, double lo, std::uint64_t base, Hit& best) {
  ++context.tests;
  TraceCounts& counts = context.scratch.counts;
  ++counts.tests[static_cast<std::size_t>(leaf.kind)];
  ShapeHit hit;
  if (!shape.intersect(local, lo, best.shape.t, hit)) return false;
  const std::uint64_t rank = rank_of(leaf.kind, base + leaf.order);
  if (hit.t == best.shape.t && rank >= best.rank) return false;
  ++counts.hits[static_cast<std::size_t>(leaf.kind)];
  best.shape = hit;
  best.leaf = id;
  best.flag = EnterFlag::kUnset;
  best.rank = rank;
  best.instances = context.instances;
  return true;
}

bool improve_by_instance(TraceContext& context, LeafId id, const Leaf& leaf, const Ray& inner, double lo,
                         Opacity mask, std::uint64_t base, Hit& best) {
  InstancePath& path = context.instances;
  if (path.count >= InstancePath::kCapacity) return false;  // the compile step refuses such scenes
  path.leaves[path.count++] = id;
  GroupRay ray(inner);
  const bool improved = improve_by_group(context, context.scene.instances[leaf.shape].group, ray, lo, mask,
                                         base + leaf.order, best);
  --path.count;
  return improved;
}

/// The one switch over kinds.
inline bool improve(TraceContext& context, LeafId id, const Leaf& leaf, GroupRay& ray, double lo,
                    Opacity mask, std::uint64_t base, Hit& best) {
  const CompiledScene& scene = context.scene;
  const auto shape = [&](const auto& pool) {
    return improve_by_shape(context, pool[leaf.shape], leaf, id, ray.in(context, leaf), lo, base, best);
  };
  switch (leaf.kind) {
    case LeafKind::kPlane:
      return shape(scene.planes);
    case LeafKind::kSphere:
      return shape(scene.spheres);
    case LeafKind::kBox:
      return shape(scene.boxes);
    case LeafKind::kDisc:
      return shape(scene.discs);
    case LeafKind::kCylinder:
      return shape(scene.cylinders);
    case LeafKind::kCone:
      return shape(scene.cones);
    case LeafKind::kTorus:
      return shape(scene.tori);
    case LeafKind::kTriangle:
      return shape(scene.triangles);
    case LeafKind::kSmoothTriangle:
      return shape(scene.smooth_triangles);
    case LeafKind::kUvTriangle:
      return shape(scene.uv_triangles);
    case LeafKind::kPolygon:
      return shape(scene.polygons);
    case LeafKind::kBlob:
      return shape(scene.blobs);
    case LeafKind::kHeightField:
      return shape(scene.height_fields);
    case LeafKind::kCsg:
      return improve_by_csg(context, leaf, ray, lo, base, best);
    case LeafKind::kInstance:
      return improve_by_instance(context, id, leaf, ray.in(context, leaf), lo, mask, base, best);
  }
  return false;
}

bool occludes(TraceContext& context, LeafId id, const Leaf& leaf, GroupRay& ray, double lo, double hi,
              Opacity mask) {
  if (leaf.kind == LeafKind::kInstance) {
    if ((leaf.opacity & mask) == 0) return false;
    GroupRay inner(ray.in(context, leaf));
    return group_occludes(context, context.scene.instances[leaf.shape].group, inner, lo, hi, mask);
  }
  if ((leaf.opacity & ~mask) != 0) return false;
  Hit hit;
  start_search(hit, hi);
  return improve(context, id, leaf, ray, lo, mask, 0, hit) && before_far_limit(hit, hi);
}

/// Runs `test(first, last)` over the bounded leaves of a group that the ray may meet, until it answers true.
template <class Limit, class Test>
bool through_hierarchy(TraceContext& context, const Group& group, GroupRay& ray, double lo, Opacity mask,
                       const fas::Cut& cut, const Limit& limit, const Test& test) {
  ++context.bounds_tests;
  const LeafId bounded = group.first + group.unbounded;
  fas::BoxProbe probe;
  if (!fas::make_probe(group.hierarchy->clip_box(), group.condition, ray.clip(), lo, limit(), probe))
    return false;
  if (!probe.usable) return test(bounded, group.first + group.count);
  return fas::traverse(*group.hierarchy, cut, probe, mask, context.bounds_tests, limit,
                       [&](std::uint32_t first, std::uint32_t count) {
                         return test(bounded + first, bounded + first + count);
                       });
}

/// Whether the bounded leaves of a group without a hierarchy need to be tested.
inline bool may_meet_bounded(TraceContext& context, const Group& group, GroupRay& ray, double lo, double hi) {
  if (group.few_simple) return true;
  if (group.unbounded == group.count) return false;
  ++context.bounds_tests;
  return fas::may_meet(group.clip_box, group.condition, ray.clip(), lo, hi);
}

void improve_by_leaves(TraceContext& context, LeafId first, LeafId last, GroupRay& ray, double lo,
                       Opacity mask, std::uint64_t base, Hit& best, bool& improved) {
  for (LeafId id = first; id < last; ++id) {
    const Leaf& leaf = context.scene.leaves[id];
    if ((leaf.opacity & mask) != 0) improved |= improve(context, id, leaf, ray, lo, mask, base, best);
  }
}

[[gnu::noinline]] void improve_by_hierarchy(TraceContext& context, const Group& group, GroupRay& ray,
                                            double lo, Opacity mask, std::uint64_t base, const fas::Cut& cut,
                                            Hit& best, bool& improved) {
  through_hierarchy(
      context, group, ray, lo, mask, cut, [&] { return best.shape.t; },
      [&](LeafId first, LeafId last) {
        improve_by_leaves(context, first, last, ray, lo, mask, base, best, improved);
        return false;
      });
}

inline bool improve_by_group(TraceContext& context, const Group& group, GroupRay& ray, double lo,
                             Opacity mask, std::uint64_t base, const fas::Cut& cut, Hit& best) {
  const LeafId bounded = group.first + group.unbounded, end = group.first + group.count;
  const bool all = context.scratch.brute_force;
  bool improved = false;
  improve_by_leaves(context, group.first, all ? end : bounded, ray, lo, mask, base, best, improved);
  if (all) return improved;
  if (group.hierarchy)
    improve_by_hierarchy(context, group, ray, lo, mask, base, cut, best, improved);
  else if (may_meet_bounded(context, group, ray, lo, best.shape.t))
    improve_by_leaves(context, bounded, end, ray, lo, mask, base, best, improved);
  return improved;
}

bool leaves_occlude(TraceContext& context, LeafId first, LeafId last, GroupRay& ray, double lo, double hi,
                    Opacity mask) {
  for (LeafId id = first; id < last; ++id) {
    if (occludes(context, id, context.scene.leaves[id], ray, lo, hi, mask)) return true;
  }
  return false;
}

[[gnu::noinline]] bool hierarchy_occludes(TraceContext& context, const Group& group, GroupRay& ray, double lo,
                                          double hi, Opacity mask, const fas::Cut& cut) {
  return through_hierarchy(
      context, group, ray, lo, mask, cut, [&] { return hi; },
      [&](LeafId first, LeafId last) { return leaves_occlude(context, first, last, ray, lo, hi, mask); });
}

inline bool group_occludes(TraceContext& context, const Group& group, GroupRay& ray, double lo, double hi,
                           Opacity mask, const fas::Cut& cut) {
  const LeafId bounded = group.first + group.unbounded, end = group.first + group.count;
  const bool all = context.scratch.brute_force;
  if (leaves_occlude(context, group.first, all ? end : bounded, ray, lo, hi, mask)) return true;
  if (all) return false;
  if (group.hierarchy) return hierarchy_occludes(context, group, ray, lo, hi, mask, cut);
  return may_meet_bounded(context, group, ray, lo, hi) &&
         leaves_occlude(context, bounded, end, ray, lo, hi, mask);
}

}  // namespace

bool improve_by_leaf(TraceContext& context, LeafId id, const Ray& ray, double lo, Opacity mask,
                     std::uint64_t base, Hit& best) {
  GroupRay shared(ray);
  return improve(context, id, context.scene.leaves[id], shared, lo, mask, base, best);
}

bool leaf_occludes(TraceContext& context, LeafId id, const Ray& ray, double lo, double hi, Opacity mask) {
  GroupRay shared(ray);
  return occludes(context, id, context.scene.leaves[id], shared, lo, hi, mask);
}

bool improve_by_group(TraceContext& context, std::uint32_t index, GroupRay& ray, double lo, Opacity mask,
                      std::uint64_t base, Hit& best) {
  return improve_by_group(context, context.scene.groups[index], ray, lo, mask, base, {}, best);
}

bool group_occludes(TraceContext& context, std::uint32_t index, GroupRay& ray, double lo, double hi,
                    Opacity mask) {
  return group_occludes(context, context.scene.groups[index], ray, lo, hi, mask, {});
}

void ask_world(const CompiledScene& scene, const NearestQuery& query, NearestAnswer& answer,
               TraceScratch& scratch, const fas::Cut& cut) {
  TraceContext context(scene, scratch);
  start_search(answer.hit, query.hi);
  GroupRay ray(query.ray);
  answer.found = improve_by_group(context, scene.groups[0], ray, query.lo, query.mask, 0, cut, answer.hit) &&
                 before_far_limit(answer.hit, query.hi);
  answer.tests = context.tests;
  answer.bounds_tests = context.bounds_tests;
}

void ask_world(const CompiledScene& scene, const OcclusionQuery& query, OcclusionAnswer& answer,
               TraceScratch& scratch, const fas::Cut& cut) {
  TraceContext context(scene, scratch);
  GroupRay ray(query.ray);
  answer.occluded = group_occludes(context, scene.groups[0], ray, query.lo, query.hi, query.mask, cut);
  answer.others = query.mask != kAnyOpacity;  // who knows
  answer.tests = context.tests;
  answer.bounds_tests = context.bounds_tests;
}

bool primitive_enters(const CompiledScene& scene, const Leaf& leaf, const Ray& local, double lo,
                      const ShapeHit& hit) {
  switch (leaf.kind) {
    case LeafKind::kPlane:
      return scene.planes[leaf.shape].entering(local, lo, hit);
    case LeafKind::kSphere:
      return scene.spheres[leaf.shape].entering(local, lo, hit);
    case LeafKind::kBox:
      return scene.boxes[leaf.shape].entering(local, lo, hit);
    case LeafKind::kDisc:
      return scene.discs[leaf.shape].entering(local, lo, hit);
    case LeafKind::kCylinder:
      return scene.cylinders[leaf.shape].entering(local, lo, hit);
    case LeafKind::kCone:
      return scene.cones[leaf.shape].entering(local, lo, hit);
    case LeafKind::kTorus:
      return scene.tori[leaf.shape].entering(local, lo, hit);
    case LeafKind::kTriangle:
      return scene.triangles[leaf.shape].entering(local, lo, hit);
    case LeafKind::kSmoothTriangle:
      return scene.smooth_triangles[leaf.shape].entering(local, lo, hit);
    case LeafKind::kUvTriangle:
      return scene.uv_triangles[leaf.shape].entering(local, lo, hit);
    case LeafKind::kPolygon:
      return scene.polygons[leaf.shape].entering(local, lo, hit);
    case LeafKind::kBlob:
      return scene.blobs[leaf.shape].entering(local, lo, hit);
    case LeafKind::kHeightField:
      return scene.height_fields[leaf.shape].entering(local, lo, hit);
    case LeafKind::kCsg:
    case LeafKind::kInstance:
      break;
  }
  return true;
}

bool exact_nearest(const CompiledScene& scene, LeafId leaf, const Ray& ray, double lo, double hi,
                   std::uint64_t order_base, TraceScratch& scratch, Hit& hit) {
  TraceContext context(scene, scratch);
  context.instances = hit.instances;
  Hit best;
  start_search(best, hi);
  if (!improve_by_leaf(context, leaf, ray, lo, kAnyOpacity, order_base, best)) return false;
  hit = best;
  return true;
}

bool nearest_in_group(const CompiledScene& scene, std::uint32_t group, const Ray& ray, double lo, double hi,
                      Opacity mask, std::uint64_t order_base, TraceScratch& scratch, Hit& hit) {
  TraceContext context(scene, scratch);
  context.instances = hit.instances;
  Hit best;
  start_search(best, hi);
  GroupRay shared(ray);
  if (!improve_by_group(context, group, shared, lo, mask, order_base, best) || !before_far_limit(best, hi))
    return false;
  hit = best;
  return true;
}

bool occluded_in_group(const CompiledScene& scene, std::uint32_t group, const Ray& ray, double lo, double hi,
                       Opacity mask, TraceScratch& scratch) {
  TraceContext context(scene, scratch);
  GroupRay shared(ray);
  return group_occludes(context, group, shared, lo, hi, mask);
}

void TraceCounts::add(const TraceCounts& other) {
  for (std::size_t i = 0; i < tests.size(); ++i) {
    tests[i] += other.tests[i];
    hits[i] += other.hits[i];
  }
  bounds_tests += other.bounds_tests;
}

std::uint64_t TraceCounts::total_tests() const {
  return std::accumulate(tests.begin(), tests.begin() + kPrimitiveKinds, std::uint64_t{0});
}

}  // namespace rayshade
