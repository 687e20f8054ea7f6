// SPDX-License-Identifier: MIT
// Rays from their birth to their colours, batch by batch.
#include "rayshade/shading/ray_tree.h"

#include <algorithm>
#include <memory>

#include "rayshade/math/functions.h"
#include "rayshade/sampling/sample_numbers.h"
#include "rayshade/shading/atmosphere.h"
#include "rayshade/shading/ray_tree_records.h"

namespace rayshade {
namespace {

/// The uniforms of gloss textures at one hit, addressed by the path of its ray (rule 6).
class Gloss final : public GlossDraws {
 public:
  Gloss(const SampleNumbers& numbers, std::uint64_t path) : numbers_(numbers), path_(path) {}
  std::array<double, 2> operator()(unsigned nth) const override {
    return numbers_.two(dimension(path_, Purpose::kGloss, nth));
  }

 private:
  SampleNumbers numbers_;
  std::uint64_t path_;
};

}  // namespace

RayTree::RayTree(const ShadingScene& scene) : scene_(scene) {
  // Small enough that a batch and its answers stay in the second-level cache.
  batch_ = std::clamp<std::size_t>(kQueriesPerRun / std::max<std::size_t>(1, scene.lights.size()), 1,
                                   scene.intersector->preferred_span());
}

RayTree::~RayTree() = default;

std::size_t RayTree::peak_nodes() const { return nodes_.size(); }

std::uint32_t RayTree::allocate() {
  if (!free_.empty()) {
    const std::uint32_t id = free_.back();
    free_.pop_back();
    return id;
  }
  nodes_.emplace_back();
  return static_cast<std::uint32_t>(nodes_.size() - 1);
}

void RayTree::trace(std::span<const NearestQuery> rays, std::span<const EyeSample> samples,
                    std::span<SampleResult> results, std::span<SampleDetail> details) {
  counts_.eye_rays += rays.size();
  rays_ = rays;
  samples_ = samples;
  results_ = results;
  details_ = details;
  std::fill(details.begin(), details.end(), SampleDetail{});
  for (std::size_t first = 0; first < rays.size(); first += batch_) {
    start_batch(first, std::min(batch_, rays.size() - first));
    while (!pending_.empty()) run_batch();
  }
}

/// Eye rays are asked for before they become nodes: one that hits nothing never does.
void RayTree::start_batch(std::size_t first, std::size_t count) {
  const std::span<const NearestQuery> queries = rays_.subspan(first, count);
  ask_nearest(queries, [&](std::size_t i) { return first + i; });
  batch_nodes_.clear();
  batch_answers_.clear();
  const bool misses_are_background = scene_.settings->effects.empty() && !observer_;
  for (std::size_t i = 0; i < count; ++i) {
    const NearestAnswer& answer = nearest_answers_[i];
    results_[first + i].hit = answer.found;
    if (!answer.found && misses_are_background) {
      results_[first + i].color = scene_.settings->background;
      note_tests(static_cast<std::uint32_t>(first + i), answer);
      continue;
    }
    const std::uint32_t id = allocate();
    Node& node = nodes_[id];
    node.ray = queries[i].ray;
    node.lo = queries[i].lo;
    node.contribution = {1, 1, 1};
    node.path = kRootPath;
    node.parent = kNone;
    node.root = static_cast<std::uint32_t>(first + i);
    node.depth = 0;
    node.kind = RayKind::kEye;
    node.slot = kTransmittedSlot;
    node.children = node.waiting = 0;
    node.medium = kNone;
    batch_nodes_.push_back(id);
    batch_answers_.push_back(static_cast<std::uint32_t>(i));
  }
  shade_batch();
}

void RayTree::run_batch() {
  // The newest nodes first: their subtrees are finished, and their memory free, before older ones are begun.
  const std::size_t count = std::min(batch_, pending_.size());
  batch_nodes_.assign(pending_.end() - static_cast<std::ptrdiff_t>(count), pending_.end());
  std::reverse(batch_nodes_.begin(), batch_nodes_.end());
  pending_.resize(pending_.size() - count);

  if (nearest_queries_.size() < count) nearest_queries_.resize(count);
  batch_answers_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Node& node = nodes_[batch_nodes_[i]];
    NearestQuery& query = nearest_queries_[i];
    query.ray = node.ray;
    query.lo = node.lo;
    query.hi = kFar;
    query.mask = kAnyOpacity;
    query.kind = node.kind;
    query.depth = static_cast<std::uint16_t>(std::min<std::uint32_t>(node.depth, 0xffff));
    query.light = kNone;
    batch_answers_[i] = static_cast<std::uint32_t>(i);
  }
  ask_nearest(std::span(nearest_queries_).first(count),
              [&](std::size_t i) { return nodes_[batch_nodes_[i]].root; });
  shade_batch();
}

template <class SampleOf>
void RayTree::ask_nearest(std::span<const NearestQuery> queries, const SampleOf& sample_of) {
  counts_.nearest_queries += queries.size();
  const Owners owners(*this, sample_of);
  if (nearest_answers_.size() < queries.size()) nearest_answers_.resize(queries.size());
  scene_.intersector->nearest(queries, {nearest_answers_.data(), queries.size()}, scratch_);
}

/// Whether secondary rays may leave a surface.
inline bool may_spawn(const Surface& surface) { return surface.reflectance != 0 || surface.transparency > 0; }

/// From the answers of a batch to its lights and its secondary rays.
void RayTree::shade_batch() {
  if (shades_.size() < batch_nodes_.size()) shades_.resize(batch_nodes_.size());
  shade_hits();
  const std::size_t lights = scene_.lights.size();
  if (shade_count_ > 0) {
    const std::size_t run = std::max<std::size_t>(1, kQueriesPerRun / shade_count_);
    for (std::size_t first = 0; first < lights; first += run) {
      emit_lights(first, std::min(first + run, lights));
      answer_shadows();
      combine_lights();
    }
  }
  for (std::size_t i = 0; i < shade_count_; ++i) {
    if (may_spawn(*shades_[i].surface)) spawn(shades_[i]);
    if (nodes_[shades_[i].node].waiting == 0) finish(shades_[i].node);
  }
}

/// Misses become background at once; hits are textured and get their ambient part (shading.md 2.2, 2.3 step
/// 1).
void RayTree::shade_hits() {
  shade_count_ = 0;
  for (std::size_t i = 0; i < batch_nodes_.size(); ++i) {
    const std::uint32_t id = batch_nodes_[i];
    Node& node = nodes_[id];
    const NearestAnswer& answer = nearest_answers_[batch_answers_[i]];
    note_tests(node.root, answer);
    if (!answer.found) {
      node.color = scene_.settings->background;
      node.distance = kFar;
      node.end = node.ray.at(kFar);
      if (observer_) {
        observer_->on_hit({id, node.parent, node.kind, &node.ray, node.contribution,
                           static_cast<int>(node.depth), false, kFar, nullptr, nullptr});
      }
      finish(id);
      continue;
    }
    ++counts_.shaded_hits;
    Shade& shade = shades_[shade_count_++];
    shade.node = id;
    const EyeSample& sample = samples_[node.root];
    const Gloss gloss({*scene_.settings, scene_.frame, sample.x, sample.y, sample.sample}, node.path);
    const SampleContext context{sample.sample_number, scene_.settings->strata(), &gloss};
    shade.surface = &evaluate_hit(*scene_.compiled, *scene_.textures, answer.hit, node.ray, context, scratch_,
                                  shade.world, shade.textured);
    const WorldHit& world = shade.world;
    shade.starts.leave(world, world_extent(*scene_.compiled, answer.hit));
    shade.k = -dot(node.ray.direction, world.normal);
    shade.mirror = node.ray.direction + (2 * shade.k) * world.normal;
    node.distance = answer.hit.t();
    node.end = world.point;
    node.color = shade.surface->ambient * scene_.settings->ambient_light;
    if (node.kind == RayKind::kEye && !details_.empty()) {
      SampleDetail& detail = details_[node.root];
      detail.distance = node.distance;
      detail.normal = world.normal;
      detail.leaf = answer.hit.leaf;
    }
    if (observer_) {
      const TexturedHit textured{world, *shade.surface};
      observer_->on_hit({id, node.parent, node.kind, &node.ray, node.contribution,
                         static_cast<int>(node.depth), true, node.distance, &answer.hit, &textured});
    }
  }
}

/// Adds up a node whose children are known, and goes on to its parent if that was the last it waited for.
void RayTree::finish(std::uint32_t id) {
  for (;;) {
    Node& node = nodes_[id];
    if (node.children & (1u << kTransmittedSlot)) {
      Color through = node.child_color[kTransmittedSlot] * node.factor[kTransmittedSlot];
      if (node.child_extinction != 1) through *= fn::pow(node.child_extinction, node.child_distance);
      node.color += through;
    }
    if (node.children & (1u << kReflectedSlot)) {
      node.color += node.factor[kReflectedSlot] * node.child_color[kReflectedSlot];
    }
    if (node.medium == kNone && !scene_.settings->effects.empty()) {
      node.color = apply_atmosphere(scene_.settings->effects, node.color, node.ray, node.distance, node.end);
    }
    if (observer_) observer_->on_finish(id, node.color);
    free_.push_back(id);
    if (node.parent == kNone) {
      results_[node.root].color = node.color;
      return;
    }
    Node& parent = nodes_[node.parent];
    parent.child_color[node.slot] = node.color;
    if (node.slot == kTransmittedSlot) parent.child_distance = node.distance;
    if (--parent.waiting > 0) return;
    id = node.parent;
  }
}

}  // namespace rayshade
