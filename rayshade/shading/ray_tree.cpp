// SPDX-License-Identifier: MIT
#include "rayshade/shading/ray_tree.h"

#include <algorithm>

#include "rayshade/math/functions.h"
#include "rayshade/sampling/random.h"
#include "rayshade/shading/atmosphere.h"

namespace rayshade {
namespace {

/// Lights of one run of shadow queries; bounds what is pending for scenes with thousands of area cells.
constexpr std::size_t kQueriesPerRun = 4096;
/// Scenes of so few leaves have their transparent shadows walked at once, through all leaves.
constexpr std::uint32_t kFewLeaves = 16;
/// A shadow ray that meets more transparent surfaces than this is taken as blocked.
constexpr int kLongestWalk = 100'000;

bool any_above(const Color& c, const Color& limit) { return c.r > limit.r || c.g > limit.g || c.b > limit.b; }
bool any_above(const Color& c, double limit) { return c.r > limit || c.g > limit || c.b > limit; }
bool all_below(const Color& c, double limit) { return c.r < limit && c.g < limit && c.b < limit; }
bool is_black(const Color& c) { return c.r == 0 && c.g == 0 && c.b == 0; }

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

enum Slot : std::uint8_t { kTransmittedSlot = 0, kReflectedSlot = 1 };

/// The uniforms of gloss textures at one hit, addressed by the path of its ray (rule 6).
class Gloss final : public GlossDraws {
 public:
  Gloss(const RandomKey& key, std::uint64_t path) : key_(key), path_(path) {}
  std::array<double, 2> operator()(unsigned nth) const override {
    return uniform2(key_, dimension(path_, Purpose::kGloss, nth));
  }

 private:
  RandomKey key_;
  std::uint64_t path_;
};

}  // namespace

/// A ray of the tree, from its birth until its colour has gone to its parent. Nodes are reused without being
/// cleared: each group of members is written before it is read.
struct RayTree::Node {
  // At birth:
  Ray ray;
  double lo;
  Color contribution;
  std::uint64_t path;
  std::uint32_t parent;
  std::uint32_t root;  ///< index of the eye sample
  std::uint32_t depth;
  RayKind kind;
  Slot slot;
  std::uint8_t children;  ///< bit per slot
  std::uint8_t waiting;
  // The media stack is a chain of the ancestors that pushed an entry; they outlive their descendants.
  std::uint32_t medium;  ///< node whose entry is on top; kNone: the stack is empty

  // If it entered a medium, the entry pushed by this ray:
  std::uint32_t medium_below;
  double medium_index, medium_extinction;

  // Known after its own hit was shaded:
  double distance;
  Vec3 end;
  Color color;
  // Per child that was spawned; child_color and child_distance when it is finished:
  Color factor[2];
  Color child_color[2];
  double child_distance;
  double child_extinction;
};

/// A hit being shaded.
struct RayTree::Shade {
  std::uint32_t node = 0;
  const Surface* surface = nullptr;  ///< the scene's own, or `textured`
  WorldHit world;
  Surface textured;
  Vec3 mirror;   ///< R
  double k = 0;  ///< -I.N
  RayStarts starts;
};

/// One light at one hit, waiting for its shadow.
struct RayTree::PendingLight {
  std::uint32_t shade = 0;
  std::uint32_t light = 0;
  double cosine = 0;
  double highlight = 0;   ///< R.L; to be combined: to its exponent
  Color color;            ///< before shadows; after them when answered
  bool shadowed = false;  ///< a shadow ray decides
  bool blocked = false;
  bool skipped = false;     ///< has no effect; kept only for the observer
  bool highlights = false;  ///< there is a highlight
};

/// A shadow ray on its way through transparent surfaces (shading.md 5.3).
struct RayTree::Walk {
  std::uint32_t pending = 0;
  std::uint32_t query = 0;
  double near = 0;
  bool in_medium = false;
  double extinction = 1;
  int steps = 0;
  bool opaque = false;       ///< something certainly opaque is in the way
  bool through_all = false;  ///< asks for all leaves, not just transparent ones
};

/// Tells for whom the queries of a span are, as long as it lives.
template <class SampleOf>
class RayTree::Owners final : public QueryOwners {
 public:
  Owners(RayTree& tree, const SampleOf& sample_of) : tree_(tree), sample_of_(sample_of) {
    tree_.scratch_.owners = this;
  }
  ~Owners() override { tree_.scratch_.owners = nullptr; }
  Owners(const Owners&) = delete;
  Owners& operator=(const Owners&) = delete;
  RayOwner owner(std::size_t query) const override {
    const EyeSample& sample = tree_.samples_[sample_of_(query)];
    return {sample.x, sample.y, sample.sample};
  }

 private:
  RayTree& tree_;
  const SampleOf& sample_of_;
};

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

void RayTree::trace(std::span<const EyeSample> samples, std::span<SampleResult> results) {
  counts_.eye_rays += samples.size();
  samples_ = samples;
  for (std::size_t first = 0; first < samples.size(); first += batch_) {
    start_batch(first, std::min(batch_, samples.size() - first), samples, results);
    while (!pending_.empty()) run_batch(samples, results);
  }
}

/// Eye rays are asked for before they become nodes: one that hits nothing never does.
void RayTree::start_batch(std::size_t first, std::size_t count, std::span<const EyeSample> samples,
                          std::span<SampleResult> results) {
  nearest_queries_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    NearestQuery& query = nearest_queries_[i];
    query.ray = samples[first + i].ray;
    query.lo = kEpsilon;
    query.hi = kFar;
    query.mask = kAnyOpacity;
    query.kind = RayKind::kEye;
    query.depth = 0;
    query.light = kNone;
  }
  ask_nearest([&](std::size_t i) { return first + i; });
  batch_nodes_.clear();
  batch_answers_.clear();
  const bool misses_are_background = scene_.settings->effects.empty() && !observer_;
  for (std::size_t i = 0; i < count; ++i) {
    SampleResult& result = results[first + i];
    result = SampleResult{};
    const NearestAnswer& answer = nearest_answers_[i];
    if (!answer.found && misses_are_background) {
      result.color = scene_.settings->background;
      result.tests = answer.tests;
      result.bounds_tests = answer.bounds_tests;
      continue;
    }
    const std::uint32_t id = allocate();
    Node& node = nodes_[id];
    node.ray = samples[first + i].ray;
    node.lo = kEpsilon;
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
  shade_batch(samples, results);
}

void RayTree::run_batch(std::span<const EyeSample> samples, std::span<SampleResult> results) {
  // The newest nodes first: their subtrees are finished, and their memory free, before older ones are begun.
  const std::size_t count = std::min(batch_, pending_.size());
  batch_nodes_.assign(pending_.end() - static_cast<std::ptrdiff_t>(count), pending_.end());
  std::reverse(batch_nodes_.begin(), batch_nodes_.end());
  pending_.resize(pending_.size() - count);

  nearest_queries_.resize(count);
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
  ask_nearest([&](std::size_t i) { return nodes_[batch_nodes_[i]].root; });
  shade_batch(samples, results);
}

template <class SampleOf>
void RayTree::ask_nearest(const SampleOf& sample_of) {
  const std::size_t count = nearest_queries_.size();
  counts_.nearest_queries += count;
  const Owners owners(*this, sample_of);
  if (nearest_answers_.size() < count) nearest_answers_.resize(count);
  scene_.intersector->nearest(nearest_queries_, {nearest_answers_.data(), count}, scratch_);
}

/// From the answers of a batch to its lights and its secondary rays.
void RayTree::shade_batch(std::span<const EyeSample> samples, std::span<SampleResult> results) {
  if (shades_.size() < batch_nodes_.size()) shades_.resize(batch_nodes_.size());
  shade_hits(samples, results);
  const std::size_t lights = scene_.lights.size();
  if (shade_count_ > 0) {
    const std::size_t run = std::max<std::size_t>(1, kQueriesPerRun / shade_count_);
    for (std::size_t first = 0; first < lights; first += run) {
      emit_lights(first, std::min(first + run, lights), samples);
      answer_shadows(results);
      combine_lights();
    }
  }
  for (std::size_t i = 0; i < shade_count_; ++i) {
    spawn(shades_[i]);
    if (nodes_[shades_[i].node].waiting == 0) finish(shades_[i].node, results);
  }
}

/// Misses become background at once; hits are textured and get their ambient part (shading.md 2.2, 2.3 step
/// 1).
void RayTree::shade_hits(std::span<const EyeSample> samples, std::span<SampleResult> results) {
  shade_count_ = 0;
  for (std::size_t i = 0; i < batch_nodes_.size(); ++i) {
    const std::uint32_t id = batch_nodes_[i];
    Node& node = nodes_[id];
    const NearestAnswer& answer = nearest_answers_[batch_answers_[i]];
    SampleResult& result = results[node.root];
    result.tests += answer.tests;
    result.bounds_tests += answer.bounds_tests;
    if (!answer.found) {
      node.color = scene_.settings->background;
      node.distance = kFar;
      node.end = node.ray.at(kFar);
      if (observer_) {
        observer_->on_hit({id, node.parent, node.kind, &node.ray, node.contribution,
                           static_cast<int>(node.depth), false, kFar, nullptr, nullptr});
      }
      finish(id, results);
      continue;
    }
    ++counts_.shaded_hits;
    Shade& shade = shades_[shade_count_++];
    shade.node = id;
    const EyeSample& sample = samples[node.root];
    const Gloss gloss({scene_.settings->seed, scene_.frame, sample.x, sample.y, sample.sample}, node.path);
    const SampleContext context{sample.sample_number, scene_.settings->samples, &gloss};
    shade.surface = &evaluate_hit(*scene_.compiled, *scene_.textures, answer.hit, node.ray, context, scratch_,
                                  shade.world, shade.textured);
    const WorldHit& world = shade.world;
    shade.starts = RayStarts(world, world_extent(*scene_.compiled, answer.hit));
    shade.k = -dot(node.ray.direction, world.normal);
    shade.mirror = node.ray.direction + (2 * shade.k) * world.normal;
    node.distance = answer.hit.t();
    node.end = world.point;
    node.color = shade.surface->ambient * scene_.settings->ambient_light;
    if (node.kind == RayKind::kEye) {
      result.hit = true;
      result.distance = node.distance;
      result.normal = world.normal;
      result.leaf = answer.hit.leaf;
    }
    if (observer_) {
      const TexturedHit textured{world, *shade.surface};
      observer_->on_hit({id, node.parent, node.kind, &node.ray, node.contribution,
                         static_cast<int>(node.depth), true, node.distance, &answer.hit, &textured});
    }
  }
}

/// Sections 2.4 steps 1 and 2 and 4: which lights matter at which hit, and the shadow rays they need.
void RayTree::emit_lights(std::size_t first_light, std::size_t last_light,
                          std::span<const EyeSample> samples) {
  lights_.clear();
  shadow_queries_.clear();
  shadow_owner_.clear();
  const RenderSettings& settings = *scene_.settings;
  const Opacity mask =
      settings.transparent_shadows && scene_.compiled->has_transparent ? kOpaque : kAnyOpacity;
  for (std::uint32_t s = 0; s < shade_count_; ++s) {
    const Shade& shade = shades_[s];
    const Node& node = nodes_[shade.node];
    const WorldHit& world = shade.world;
    const Surface& surface = *shade.surface;
    const EyeSample& sample = samples[node.root];
    const bool answers_highlight = surface.specular_exponent >= kEpsilon && !is_black(surface.specular);
    for (std::size_t l = first_light; l < last_light; ++l) {
      const ShadingLight& light = scene_.lights[l];
      const RandomKey key{settings.seed, scene_.frame, sample.x, sample.y, sample.sample};
      std::array<double, 2> draws{};
      if (light.kind == LightKind::kArea) draws = uniform2(key, dimension(node.path, Purpose::kLight, l));
      const Illumination light_in = illuminate(light, world.point, draws[0], draws[1]);
      // Records are made where they stay: copies of fresh ones stall on their own stores.
      PendingLight& pending = lights_.emplace_back();
      pending.shade = s;
      pending.light = static_cast<std::uint32_t>(l);
      double c = dot(light_in.direction, world.normal);
      if (world.smooth && c <= 0) {
        const double geometric = dot(light_in.direction, world.geometric_normal);
        if (geometric > 0) c = geometric;
      }
      pending.cosine = c;
      pending.color = light_in.color;
      pending.highlight = dot(shade.mirror, light_in.direction);
      if (!light_in.reaches) {
        ++counts_.skipped_dark_lights;
        pending.skipped = true;
      } else if (c > 0) {
        const bool highlight = answers_highlight && pending.highlight > 0;
        if (light.black || (is_black(surface.diffuse) && !highlight)) {
          ++counts_.skipped_dark_lights;
          pending.skipped = true;
        }
      } else if (surface.translucency < kEpsilon) {
        ++counts_.skipped_back_lights;
        pending.skipped = true;
      }
      if (pending.skipped) {
        if (!observer_) lights_.pop_back();
        continue;
      }
      if (!settings.shadows || light.no_shadow || surface.no_shadow) {
        ++counts_.skipped_unshadowed;
      } else {
        pending.shadowed = true;
        ++counts_.shadow_rays;
        Vec3 direction = light_in.direction;
        double far = light_in.distance;
        if (light.kind == LightKind::kExtended) {
          draws = uniform2(key, dimension(node.path, Purpose::kLight, l));
          const Vec3 target =
              extended_target(light, world.point, sample.sample_number, settings.samples, draws[0], draws[1]);
          far = length(target);
          direction = target / far;
        }
        const RayStart start = shade.starts.toward(direction, 1, true);
        OcclusionQuery& query = shadow_queries_.emplace_back();
        query.ray.origin = start.origin;
        query.ray.direction = direction;
        query.ray.time = node.ray.time;
        query.lo = start.lo;
        query.hi = far;
        query.mask = mask;
        query.light = static_cast<std::uint32_t>(l);
        shadow_owner_.push_back(static_cast<std::uint32_t>(lights_.size() - 1));
      }
    }
  }
}

void RayTree::answer_shadows(std::span<SampleResult> results) {
  if (shadow_queries_.empty()) return;
  if (shadow_answers_.size() < shadow_queries_.size()) shadow_answers_.resize(shadow_queries_.size());
  const bool walk = scene_.settings->transparent_shadows && scene_.compiled->has_transparent;
  if (walk && scene_.compiled->groups[0].count <= kFewLeaves) {
    follow_transparent(true, results);
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
    SampleResult& result = results[nodes_[shades_[pending.shade].node].root];
    result.tests += answers[i].tests;
    result.bounds_tests += answers[i].bounds_tests;
    pending.blocked = answers[i].occluded;
    if (pending.blocked) ++counts_.shadow_hits;
  }
  if (walk) follow_transparent(false, results);
}

/// The ordered walk of shading.md 5.3. Where something certainly opaque is in the way, a shadow ray that
/// meets no transparent leaf is blocked at once; but an opaque surface that coincides with a transparent one
/// is passed with it (the walk goes on behind it), so those that meet one walk through all leaves.
/// `through_all`: so do all, where a question about opaque leaves has not been asked because it would cost as
/// much.
void RayTree::follow_transparent(bool through_all, std::span<SampleResult> results) {
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
      results[node.root].tests += answers[i].tests;
      results[node.root].bounds_tests += answers[i].bounds_tests;
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
      if (all_below(pending.color, kEpsilon)) {
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

/// Takes the highlights of the lights that arrive to their exponents, those that need a real power together.
void RayTree::raise_highlights() {
  power_bases_.clear();
  power_exponents_.clear();
  power_owner_.clear();
  for (std::uint32_t i = 0; i < lights_.size(); ++i) {
    PendingLight& pending = lights_[i];
    if (pending.skipped || pending.blocked) continue;
    const Surface& surface = *shades_[pending.shade].surface;
    const bool front = pending.cosine > 0;
    const double base = front ? pending.highlight : -pending.highlight;
    const double exponent = front ? surface.specular_exponent : surface.transmitted_exponent;
    pending.highlight = 0;
    if (!(exponent >= kEpsilon && base > 0)) continue;
    pending.highlights = true;
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

/// Section 2.4 steps 3 and 4, in the fixed order of the lights.
void RayTree::combine_lights() {
  raise_highlights();
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

/// Sections 2.3 steps 3 to 6 and 2.5.
void RayTree::spawn(Shade& shade) {
  const RenderSettings& settings = *scene_.settings;
  const Surface& surface = *shade.surface;
  const WorldHit& world = shade.world;
  Color reflect = surface.specular * surface.reflectance;
  const bool transmits = surface.transparency > kEpsilon;
  if (nodes_[shade.node].depth >= static_cast<std::uint32_t>(settings.max_depth)) {
    if (transmits || any_above(reflect, kEpsilon)) ++counts_.skipped_depth;
    return;
  }
  const auto child = [&](RayKind kind, Slot slot, const Vec3& direction, const Color& factor,
                         const Color& contribution) {
    const std::uint32_t id = allocate();
    Node& node = nodes_[shade.node];
    Node& out = nodes_[id];
    const double square = length_squared(direction);
    const bool unit = std::fabs(square - 1) < 1e-8;
    const RayStart start = shade.starts.toward(direction, unit ? 1 : std::sqrt(square), false);
    out.ray.origin = start.origin;
    out.ray.direction = direction;
    out.ray.time = node.ray.time;
    out.ray.unit = unit;
    out.lo = start.lo;
    out.contribution = contribution;
    out.path = child_path(node.path, slot);
    out.parent = shade.node;
    out.root = node.root;
    out.depth = node.depth + 1;
    out.kind = kind;
    out.slot = slot;
    out.children = out.waiting = 0;
    out.medium = node.medium;
    node.factor[slot] = factor;
    node.children = static_cast<std::uint8_t>(node.children | (1u << slot));
    ++node.waiting;
    return id;
  };

  std::uint32_t transmitted = kNone;
  if (transmits) {
    const Color filter = surface.body * surface.transparency;
    const Color contribution = filter * nodes_[shade.node].contribution;
    if (!any_above(contribution, settings.cutoff)) {
      ++counts_.skipped_cutoff;
    } else {
      const Node& node = nodes_[shade.node];
      const auto index_of = [&](std::uint32_t medium) {
        return medium == kNone ? settings.atmosphere_index : nodes_[medium].medium_index;
      };
      const double own_index = surface.index > 0 ? surface.index : 1;
      const std::uint32_t below = node.medium == kNone ? kNone : nodes_[node.medium].medium_below;
      const double n1 = world.entering ? index_of(node.medium) : own_index;
      const double n2 = world.entering ? own_index : index_of(below);
      const Vec3 normal = shade.k < 0 ? -world.normal : world.normal;
      const double k = std::fabs(shade.k);
      const double m = n1 / n2;
      const double s = 1 - m * m * (1 - k * k);
      if (s < 0) {
        ++counts_.total_reflections;
        reflect += filter;
      } else {
        const Vec3 direction = m * node.ray.direction + (m * k - std::sqrt(s)) * normal;
        if (is_finite(direction)) {
          transmitted = child(RayKind::kTransmitted, kTransmittedSlot, direction, filter, contribution);
          Node& out = nodes_[transmitted];
          if (world.entering) {
            out.medium_below = out.medium;
            out.medium_index = own_index;
            out.medium_extinction = surface.extinction;
            out.medium = transmitted;
          } else {
            out.medium = below;
          }
          nodes_[shade.node].child_extinction =
              out.medium == kNone ? 1 : nodes_[out.medium].medium_extinction;
          ++counts_.transmitted_rays;
        }
      }
    }
  }
  if (any_above(reflect, kEpsilon)) {
    const Color contribution = reflect * nodes_[shade.node].contribution;
    if (!any_above(contribution, settings.cutoff)) {
      ++counts_.skipped_cutoff;
    } else if (is_finite(shade.mirror)) {
      pending_.push_back(child(RayKind::kReflected, kReflectedSlot, shade.mirror, reflect, contribution));
      ++counts_.reflected_rays;
    }
  }
  if (transmitted != kNone) pending_.push_back(transmitted);
}

/// Adds up a node whose children are known, and goes on to its parent if that was the last it waited for.
void RayTree::finish(std::uint32_t id, std::span<SampleResult> results) {
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
      results[node.root].color = node.color;
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
