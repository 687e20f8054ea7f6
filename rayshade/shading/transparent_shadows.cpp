// SPDX-License-Identifier: MIT
// Shadow rays on their way through transparent surfaces (shading.md 5.3).
#include <algorithm>
#include <cmath>

#include "rayshade/math/functions.h"
#include "rayshade/shading/ray_tree_records.h"

namespace rayshade {
namespace {

/// A shadow ray that meets more transparent surfaces than this is taken as blocked.
constexpr int kLongestWalk = 100'000;

bool all_below(const Color& c, double limit) { return c.r < limit && c.g < limit && c.b < limit; }

}  // namespace

/// The ordered walk of shading.md 5.3. Where something certainly opaque is in the way, a shadow ray that
/// meets no transparent leaf is blocked at once; but an opaque surface that coincides with a transparent one
/// is passed with it (the walk goes on behind it), so those that meet one walk through all leaves.
/// `through_all`: so do all, where a question about opaque leaves has not been asked because it would cost as
/// much.
void RayTree::follow_transparent(bool through_all) {
  walks_.clear();
  for (std::uint32_t i = 0; i < shadow_queries_.size(); ++i) {
    if (!through_all && !shadow_answers_[i].others) continue;
    Walk& walk = walks_.emplace_back();
    walk.pending = shadow_owner_[i];
    walk.query = i;
    walk.near = shadow_queries_[i].lo;
    walk.in_medium = false;
    walk.extinction = 1;
    walk.steps = 0;
    // The threshold is meant for light that the factor of a spot has not yet dimmed (shading.md 4.1).
    const ShadingLight& light = scene_.lights[lights_[walk.pending].light];
    walk.least = kEpsilon;
    if (light.kind == LightKind::kSpot)
      walk.least *= spot_factor(light, -dot(light.axis, shadow_queries_[i].ray.direction));
    walk.opaque = lights_[shadow_owner_[i]].blocked;
    walk.through_all = through_all;
  }
  std::vector<NearestQuery>& queries = walk_queries_;
  while (!walks_.empty()) {
    if (queries.size() < walks_.size()) queries.resize(walks_.size());
    if (walk_answers_.size() < walks_.size()) walk_answers_.resize(walks_.size());
    const std::span<NearestAnswer> answers(walk_answers_.data(), walks_.size());
    for (std::size_t i = 0; i < walks_.size(); ++i) {
      const OcclusionQuery& query = shadow_queries_[walks_[i].query];
      NearestQuery& out = queries[i];
      out.ray = query.ray;
      out.lo = walks_[i].near;
      out.hi = query.hi;
      out.mask = walks_[i].through_all ? kAnyOpacity : kTransparent;
      out.kind = RayKind::kShadow;
      out.depth = 0;
      out.light = query.light;
    }
    counts_.nearest_queries += walks_.size();
    {
      const auto sample_of = [&](std::size_t i) {
        return nodes_[shades_[lights_[walks_[i].pending].shade].node].root;
      };
      const Owners owners(*this, sample_of);
      scene_.intersector->nearest({queries.data(), walks_.size()}, answers, scratch_);
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < walks_.size(); ++i) {
      Walk& walk = walks_[i];
      PendingLight& pending = lights_[walk.pending];
      const Node& node = nodes_[shades_[pending.shade].node];
      note_tests(node.root, answers[i]);
      if (!answers[i].found) continue;
      if (walk.opaque && !walk.through_all) {
        walk.through_all = true;
        pending.blocked = false;
        if (kept != i) walks_[kept] = walk;
        ++kept;
        continue;
      }
      if (walk.steps++ == 0) counts_.shadow_hits += !walk.opaque;
      const Hit& hit = answers[i].hit;
      if (walk.steps > kLongestWalk || surface_of(*scene_.compiled, hit).transparency < kEpsilon) {
        pending.blocked = true;
        continue;
      }
      counts_.transparent_walks += walk.steps == 1;
      if (walk.in_medium && walk.extinction != 1) {
        pending.color *= fn::pow(walk.extinction, hit.t() - walk.near);
      }
      const Transmittance through =
          evaluate_transmittance(*scene_.compiled, *scene_.textures, hit, queries[i].ray, scratch_);
      pending.color *= through.color;
      walk.in_medium = through.entering;
      walk.extinction = through.extinction;
      if (all_below(pending.color, walk.least)) {
        pending.blocked = true;
        continue;
      }
      const double step = kEpsilon * std::min(1.0, world_extent(*scene_.compiled, hit));
      walk.near = std::max(hit.t() + step, std::nextafter(hit.t(), kFar));
      if (walk.near >= queries[i].hi) continue;
      if (kept != i) walks_[kept] = walk;
      ++kept;
    }
    walks_.resize(kept);
  }
}

}  // namespace rayshade
