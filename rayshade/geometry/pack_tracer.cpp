// SPDX-License-Identifier: MIT
#include "rayshade/geometry/pack_tracer.h"

#include <limits>

#include "rayshade/geometry/rank.h"

namespace rayshade {

template <class Query>
void PackTracer::load_ray(const Query& query, int i) {
  const Ray& ray = query.ray;
  pack_.origin[0][i] = ray.origin.x, pack_.origin[1][i] = ray.origin.y, pack_.origin[2][i] = ray.origin.z;
  pack_.direction[0][i] = ray.direction.x, pack_.direction[1][i] = ray.direction.y;
  pack_.direction[2][i] = ray.direction.z;
  pack_.lo[i] = query.lo;
  pack_.t[i] = query.hi;
  all_unit_ &= ray.unit;
}

void PackTracer::load(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
                      const std::uint32_t* places, int count) {
  pack_.count = count;
  pack_.clip_ready = false;
  found_ = 0;
  all_unit_ = true;
  nearest_ = queries.data();
  answers_ = answers.data();
  for (int i = 0; i < count; ++i) {
    const std::uint32_t place = places ? places[i] : static_cast<std::uint32_t>(i);
    places_[static_cast<std::size_t>(i)] = place;
    load_ray(queries[place], i);
    pack_.rank[i] = RayPack::kNoRank;
  }
  opacity_ = queries[places_[0]].mask;
  counter_.reset(pack_);
  csg_.load(pack_);
}

void PackTracer::load(std::span<const OcclusionQuery> queries, const std::uint32_t* places, int count) {
  pack_.count = count;
  pack_.clip_ready = false;
  stopped_ = others_ = 0;
  all_unit_ = true;
  occlusion_ = queries.data();
  for (int i = 0; i < count; ++i) {
    const std::uint32_t place = places ? places[i] : static_cast<std::uint32_t>(i);
    places_[static_cast<std::size_t>(i)] = place;
    load_ray(queries[place], i);
  }
  opacity_ = queries[places_[0]].mask;
  counter_.reset(pack_);
  csg_.load(pack_);
}

RayPack::Mask PackTracer::improve(LeafId id, RayPack::Mask mask) {
  const Leaf& leaf = context_.scene.leaves[id];
  if ((leaf.opacity & opacity_) == 0) return 0;
  if (vectorised(leaf, mask)) {
    const RayPack::Mask better = improve_pack(context_.scene, id, pack_, mask);
    counter_.add_tests(leaf, mask, better);
    found_ |= better;
    return better;
  }
  if (csg_in_packs(leaf, mask)) {
    const RayPack::Mask better = csg_.improve(leaf, pack_, mask);
    found_ |= better;
    return better;
  }
  RayPack::Mask better = 0;
  for_each_ray(mask, [&](std::size_t i) {
    const NearestQuery& query = nearest_[places_[i]];
    Hit& hit = answers_[places_[i]].hit;
    hit.shape.t = pack_.t[i];
    hit.rank = pack_.rank[i] == RayPack::kNoRank ? std::numeric_limits<std::uint64_t>::max()
                                                 : static_cast<std::uint64_t>(pack_.rank[i]);
    const std::uint32_t tests = context_.tests, bounds_tests = context_.bounds_tests;
    if (improve_by_leaf(context_, id, query.ray, query.lo, query.mask, 0, hit)) {
      pack_.t[i] = hit.shape.t;
      pack_.rank[i] = static_cast<std::int64_t>(hit.rank);
      pack_.leaf[i] = kInAnswer;
      better |= RayPack::Mask{1} << i;
    }
    counter_.add_to_ray(i, context_.tests - tests, context_.bounds_tests - bounds_tests);
  });
  found_ |= better;
  return better;
}

void PackTracer::answer_nearest() {
  const PackCounter::Sums sums = counter_.finish();
  for (int k = 0; k < pack_.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    NearestAnswer& answer = answers_[places_[i]];
    answer.tests = sums.tests[i];
    answer.bounds_tests = sums.bounds_tests[i];
    answer.found = false;
    if ((found_ >> i & 1) == 0) continue;
    const auto rank = static_cast<std::uint64_t>(pack_.rank[i]);
    if (!before_far_limit(pack_.t[i], rank, nearest_[places_[i]].hi)) continue;
    answer.found = true;
    if (pack_.leaf[i] == kInAnswer) continue;
    Hit& hit = answer.hit;
    hit.shape = {pack_.t[i], pack_.a[i], pack_.b[i], static_cast<std::uint32_t>(pack_.part[i])};
    hit.leaf = pack_.leaf[i];
    hit.flag = pack_.flag[i];
    hit.rank = rank;
    hit.instances.count = 0;
  }
}

RayPack::Mask PackTracer::occlude(LeafId id, RayPack::Mask mask) {
  const Leaf& leaf = context_.scene.leaves[id];
  const bool within = (leaf.opacity & ~opacity_) == 0;
  if (within || leaf.kind == LeafKind::kInstance)
    stopped_ |= occluded_by(id, leaf, opacity_, mask & ~stopped_);
  if (opacity_ == kAnyOpacity) return mask & stopped_;
  // An instance may hold both kinds; that it is met at all is then enough to have to look closer.
  if (!within) others_ |= occluded_by(id, leaf, kAnyOpacity, mask & ~others_);
  return mask & stopped_ & others_;
}

RayPack::Mask PackTracer::occluded_by(LeafId id, const Leaf& leaf, Opacity opacity, RayPack::Mask mask) {
  if (mask == 0) return 0;
  if (vectorised(leaf, mask)) {
    const RayPack::Mask stopped = occlude_pack(context_.scene, leaf, pack_, mask);
    counter_.add_tests(leaf, mask, stopped);
    return stopped;
  }
  if (csg_in_packs(leaf, mask)) return csg_.occlude(leaf, pack_, mask);
  RayPack::Mask stopped = 0;
  for_each_ray(mask, [&](std::size_t i) {
    const OcclusionQuery& query = occlusion_[places_[i]];
    const std::uint32_t tests = context_.tests, bounds_tests = context_.bounds_tests;
    if (leaf_occludes(context_, id, query.ray, query.lo, query.hi, opacity)) stopped |= RayPack::Mask{1} << i;
    counter_.add_to_ray(i, context_.tests - tests, context_.bounds_tests - bounds_tests);
  });
  return stopped;
}

void PackTracer::answer_occluded(std::span<OcclusionAnswer> answers) {
  const PackCounter::Sums sums = counter_.finish();
  for (int k = 0; k < pack_.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    answers[places_[i]] = {(stopped_ >> i & 1) != 0, (others_ >> i & 1) != 0, sums.tests[i],
                           sums.bounds_tests[i]};
  }
}

}  // namespace rayshade
