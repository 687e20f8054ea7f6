// SPDX-License-Identifier: MIT
// The lights of a batch of hits: which matter, the shadow rays they need, and their sum (shading.md 2.4, 4).
#include <algorithm>
#include <cmath>

#include "rayshade/math/functions.h"
#include "rayshade/sampling/sample_numbers.h"
#include "rayshade/shading/ray_tree_records.h"

namespace rayshade {
namespace {

/// Scenes of so few leaves have their transparent shadows walked at once, through all leaves.
constexpr std::uint32_t kFewLeaves = 16;

/// The exponent, where highlights are computed by multiplication: whole ones, which most are (relative error
/// below exponent ulps, far below what a pixel holds). Otherwise 0.
unsigned whole_exponent(double exponent) {
  constexpr int kMost = 256;
  if (!(exponent > 0 && exponent <= kMost)) return 0;
  const auto whole = static_cast<unsigned>(exponent);
  return static_cast<double>(whole) == exponent ? whole : 0;
}

double power(double base, unsigned exponent) {
  double out = exponent & 1u ? base : 1;
  for (double square = base; exponent >>= 1;) {
    square *= square;
    if (exponent & 1u) out *= square;
  }
  return out;
}

}  // namespace

/// What of a hit matters to its lights.
struct RayTree::LitHit {
  std::uint32_t shade;
  bool answers_highlight, diffuse_black;
};

/// Sections 2.4 steps 1 and 2 and 4: which lights matter at which hit, and the shadow rays they need. Hits go
/// 64 at a time, light by light.
void RayTree::emit_lights(std::size_t first_light, std::size_t last_light) {
  lights_.clear();
  shadow_queries_.clear();
  shadow_owner_.clear();
  any_highlight_ = false;
  std::array<LitHit, LightAims::kMost> hits;
  for (std::size_t first = 0; first < shade_count_; first += LightAims::kMost) {
    const std::size_t count = aims_.count = std::min(LightAims::kMost, shade_count_ - first);
    for (std::size_t i = 0; i < count; ++i) {
      const Shade& shade = shades_[first + i];
      const Surface& surface = *shade.surface;
      aims_.set_hit(i, shade.world.point, shade.world.normal, shade.mirror);
      hits[i] = {static_cast<std::uint32_t>(first + i),
                 surface.specular_exponent >= kEpsilon && !is_black(surface.specular),
                 is_black(surface.diffuse)};
    }
    for (std::size_t l = first_light; l < last_light; ++l)
      emit_light(static_cast<std::uint32_t>(l), std::span(hits).first(count));
  }
}

/// The two random numbers of a light at a hit.
std::array<double, 2> RayTree::light_draws(const ShadingLight& light, const Node& node) const {
  const EyeSample& sample = samples_[node.root];
  const SampleNumbers numbers(*scene_.settings, scene_.frame, sample.x, sample.y, sample.sample);
  return numbers.two_of_several(dimension(node.path, Purpose::kLight, light.sequence), light.turn,
                                light.turns);
}

/// One light at the hits of aims_.
void RayTree::emit_light(std::uint32_t number, std::span<const LitHit> hits) {
  const RenderSettings& settings = *scene_.settings;
  const Opacity mask =
      settings.transparent_shadows && scene_.compiled->has_transparent ? kOpaque : kAnyOpacity;
  const ShadingLight& light = scene_.lights[number];
  if (light.kind == LightKind::kArea) {
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const auto draws = light_draws(light, nodes_[shades_[hits[i].shade].node]);
      aims_.set_place(i, area_place(light, draws[0], draws[1]));
    }
  }
  aim_at(light, aims_);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const LitHit& hit = hits[i];
    const Shade& shade = shades_[hit.shade];
    const WorldHit& world = shade.world;
    const Surface& surface = *shade.surface;
    Vec3 direction = aims_.direction_of(i);
    double far = aims_.distance[i];
    double c = aims_.cosine[i];
    if (world.smooth && c <= 0) {
      const double geometric = dot(direction, world.geometric_normal);
      if (geometric > 0) c = geometric;
    }
    const double highlight = aims_.highlight[i];
    const double factor =
        light.kind == LightKind::kSpot ? spot_factor(light, -dot(light.axis, direction)) : 1;
    bool skipped = false;
    if (!(far > 0) || factor == 0) {
      ++counts_.skipped_dark_lights;
      skipped = true;
    } else if (c > 0) {
      if (light.black || (hit.diffuse_black && !(hit.answers_highlight && highlight > 0))) {
        ++counts_.skipped_dark_lights;
        skipped = true;
      }
    } else if (surface.translucency < kEpsilon) {
      ++counts_.skipped_back_lights;
      skipped = true;
    }
    if (skipped && !observer_) continue;
    // Records are made where they stay: copies of fresh ones stall on their own stores.
    PendingLight& pending = lights_.add();
    pending.shade = hit.shade;
    pending.light = number;
    pending.cosine = far > 0 ? c : 0;
    pending.highlight = highlight;
    pending.color = light.kind == LightKind::kSpot ? light.intensity * factor : light.intensity;
    pending.blocked = pending.highlights = false;
    pending.skipped = skipped;
    if (skipped) continue;
    pending.highlights = c > 0 ? hit.answers_highlight && highlight > 0
                               : surface.transmitted_exponent >= kEpsilon && highlight < 0;
    any_highlight_ |= pending.highlights;
    if (!settings.shadows || light.no_shadow || surface.no_shadow) {
      ++counts_.skipped_unshadowed;
      continue;
    }
    ++counts_.shadow_rays;
    const Node& node = nodes_[shade.node];
    if (light.kind == LightKind::kExtended) {
      const auto draws = light_draws(light, node);
      const Vec3 target = extended_target(light, world.point, samples_[node.root].sample_number,
                                          settings.strata(), draws[0], draws[1]);
      far = length(target);
      direction = target / far;
    }
    const RayStart start = shade.starts.toward(direction, 1, true);
    OcclusionQuery& query = shadow_queries_.add();
    query.ray.origin = start.origin;
    query.ray.direction = direction;
    query.ray.time = node.ray.time;
    query.ray.unit = true;
    query.lo = start.lo;
    query.hi = far;
    query.mask = mask;
    query.light = number;
    shadow_owner_.push_back(static_cast<std::uint32_t>(lights_.size() - 1));
  }
}

void RayTree::answer_shadows() {
  if (shadow_queries_.empty()) return;
  if (shadow_answers_.size() < shadow_queries_.size()) shadow_answers_.resize(shadow_queries_.size());
  const bool walk = scene_.settings->transparent_shadows && scene_.compiled->has_transparent;
  if (walk && scene_.compiled->groups[0].count <= kFewLeaves) {
    follow_transparent(true);
    return;
  }
  const std::span<OcclusionAnswer> answers(shadow_answers_.data(), shadow_queries_.size());
  counts_.occlusion_queries += shadow_queries_.size();
  {
    const auto sample_of = [&](std::size_t i) {
      return nodes_[shades_[lights_[shadow_owner_[i]].shade].node].root;
    };
    const Owners owners(*this, sample_of);
    scene_.intersector->occluded(shadow_queries_, answers, scratch_);
  }
  for (std::size_t i = 0; i < shadow_queries_.size(); ++i) {
    PendingLight& pending = lights_[shadow_owner_[i]];
    pending.blocked = answers[i].occluded;
    counts_.shadow_hits += pending.blocked;
    if (!details_.empty()) note_tests(nodes_[shades_[pending.shade].node].root, answers[i]);
  }
  if (walk) follow_transparent(false);
}

/// Takes the highlights of the lights that arrive to their exponents, those that need a real power together.
void RayTree::raise_highlights() {
  power_bases_.clear();
  power_exponents_.clear();
  power_owner_.clear();
  for (std::uint32_t i = 0; i < lights_.size(); ++i) {
    PendingLight& pending = lights_[i];
    if (!pending.highlights || pending.blocked) continue;
    const Surface& surface = *shades_[pending.shade].surface;
    const bool front = pending.cosine > 0;
    const double base = std::fabs(pending.highlight);
    const double exponent = front ? surface.specular_exponent : surface.transmitted_exponent;
    if (const unsigned whole = whole_exponent(exponent)) {
      pending.highlight = power(base, whole);
      continue;
    }
    power_bases_.push_back(base);
    power_exponents_.push_back(exponent);
    power_owner_.push_back(i);
  }
  if (power_owner_.empty()) return;
  fn::pow_each(power_bases_.data(), power_exponents_.data(), power_bases_.data(), power_owner_.size());
  for (std::size_t k = 0; k < power_owner_.size(); ++k) lights_[power_owner_[k]].highlight = power_bases_[k];
}

/// Section 2.4 steps 3 and 4, at every hit in the fixed order of the lights.
void RayTree::combine_lights() {
  if (any_highlight_) raise_highlights();
  for (const PendingLight& pending : lights_) {
    const Shade& shade = shades_[pending.shade];
    Node& node = nodes_[shade.node];
    const Surface& surface = *shade.surface;
    const Color before = node.color;
    if (!pending.skipped && !pending.blocked) {
      if (pending.cosine > 0) {
        node.color += (surface.diffuse * pending.cosine) * pending.color;
        if (pending.highlights) node.color += (surface.specular * pending.highlight) * pending.color;
      } else {
        node.color += (surface.translucent * -pending.cosine) * pending.color;
        if (pending.highlights) node.color += (surface.body * pending.highlight) * pending.color;
        node.color *= surface.translucency;
      }
    }
    if (observer_) {
      observer_->on_light({shade.node, pending.light, pending.cosine, pending.skipped,
                           pending.blocked || pending.skipped ? Color{} : pending.color,
                           node.color - before});
    }
  }
}

}  // namespace rayshade
