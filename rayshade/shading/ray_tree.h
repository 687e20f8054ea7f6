// SPDX-License-Identifier: MIT
// The ray tree (shading.md 2 to 5), evaluated without ever waiting inside it (rule 4).
//
// Rays are nodes of an arena. A round takes the newest pending nodes (the deepest first, so that what is
// pending stays bounded by batch x depth whatever the scene), asks the Intersector for their nearest hits in
// one span, textures the hits, asks for all their shadows in one span per run of lights, adds up the lights
// in their fixed order, and pushes the secondary rays. A node is finished when its children are; its colour
// then goes to its parent. All sums have an order of their own, so batches of any size and answers that come
// later give the same bytes.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "rayshade/geometry/intersector.h"
#include "rayshade/scene/settings.h"
#include "rayshade/shading/counts.h"
#include "rayshade/shading/light_aims.h"
#include "rayshade/shading/reused_list.h"
#include "rayshade/texture/apply.h"

namespace rayshade {

/// All that shading reads; shared by threads, immutable while rendering.
struct ShadingScene {
  const CompiledScene* compiled = nullptr;
  const CompiledTextures* textures = nullptr;
  const RenderSettings* settings = nullptr;
  const Intersector* intersector = nullptr;
  std::vector<ShadingLight> lights;  ///< prepare_lights
  int frame = 0;
  double look_distance = 1;  ///< Camera::look_distance

  /// Where eye rays begin: kEpsilon from the eye (shading.md 1), or that share of the scene's extent or of
  /// the way to what is looked at, whichever is least: an eye amid small things sees them.
  double eye_start() const { return kEpsilon * std::min({1.0, compiled->scale, look_distance}); }
};

/// Whose an eye ray is. `sample` is k, the number of the cell within the pixel; `sample_number` is s
/// (shading.md 7.6).
struct EyeSample {
  std::uint32_t x = 0, y = 0;  ///< pixel in screen coordinates
  std::uint32_t sample = 0;
  int sample_number = 0;
};

/// What an eye ray brought back.
struct SampleResult {
  Color color;
  bool hit = false;  ///< alpha
};

/// What else is known of it, for layers and maps of costs.
struct SampleDetail {
  double distance = kFar;  ///< of the eye ray's own hit
  Vec3 normal;             ///< shading normal there, world space, after textures
  LeafId leaf = 0;
  std::uint32_t tests = 0;  ///< exact tests by all rays of the tree, shadows included
  std::uint32_t bounds_tests = 0;
};

/// Told of everything that happens in the tree of one eye ray (--explain). Calls come in the order of
/// evaluation.
class TreeObserver {
 public:
  struct HitEvent {
    std::uint32_t node, parent;
    RayKind kind;
    const Ray* ray;
    Color contribution;
    int depth;
    bool found;
    double distance;
    const Hit* hit;
    const TexturedHit* surface;  ///< null where nothing was hit
  };
  struct LightEvent {
    std::uint32_t node;
    std::uint32_t light;  ///< index in ShadingScene::lights
    double cosine;
    bool skipped;    ///< no shadow ray was needed
    Color arriving;  ///< after shadows; black where blocked
    Color added;
  };
  virtual ~TreeObserver() = default;
  virtual void on_hit(const HitEvent& event) = 0;
  virtual void on_light(const LightEvent& event) = 0;
  virtual void on_finish(std::uint32_t node, const Color& color) = 0;
};

/// Evaluates ray trees; one per thread.
class RayTree {
 public:
  explicit RayTree(const ShadingScene& scene);
  ~RayTree();
  RayTree(const RayTree&) = delete;
  RayTree& operator=(const RayTree&) = delete;
  /// Colours of the samples; results[i] belongs to samples[i], whose ray is rays[i] (of RayKind::kEye).
  /// `details` are filled where they are not empty.
  void trace(std::span<const NearestQuery> rays, std::span<const EyeSample> samples,
             std::span<SampleResult> results, std::span<SampleDetail> details);

  void set_observer(TreeObserver* observer) { observer_ = observer; }
  TraceScratch& scratch() { return scratch_; }
  const ShadingCounts& counts() const { return counts_; }
  /// Largest number of tree nodes alive at once, a measure of pending work.
  std::size_t peak_nodes() const;

 private:
  struct Node;
  struct Shade;
  struct PendingLight;
  struct LitHit;
  struct Walk;
  template <class SampleOf>
  class Owners;

  std::uint32_t allocate();
  void start_batch(std::size_t first, std::size_t count);
  void run_batch();
  /// `sample_of`: the number of the eye sample that the i-th query is for.
  template <class SampleOf>
  void ask_nearest(std::span<const NearestQuery> queries, const SampleOf& sample_of);
  /// Counts what was tested for a sample.
  template <class Answer>
  void note_tests(std::uint32_t sample, const Answer& answer) {
    if (details_.empty()) return;
    details_[sample].tests += answer.tests;
    details_[sample].bounds_tests += answer.bounds_tests;
  }
  void shade_batch();
  void shade_hits();
  void emit_lights(std::size_t first_light, std::size_t last_light);
  void emit_light(std::uint32_t number, std::span<const LitHit> hits);
  std::array<double, 2> light_draws(const ShadingLight& light, const Node& node) const;
  void answer_shadows();
  void follow_transparent(bool through_all);
  void raise_highlights();
  void combine_lights();
  void spawn(Shade& shade);
  void finish(std::uint32_t node);

  const ShadingScene& scene_;
  TraceScratch scratch_;
  ShadingCounts counts_;
  TreeObserver* observer_ = nullptr;
  std::size_t batch_ = 64;
  // Being traced:
  std::span<const NearestQuery> rays_;
  std::span<const EyeSample> samples_;
  std::span<SampleResult> results_;
  std::span<SampleDetail> details_;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> free_;
  std::vector<std::uint32_t> pending_;  ///< a stack
  std::vector<std::uint32_t> batch_nodes_;
  std::vector<std::uint32_t> batch_answers_;  ///< index in nearest_answers_ of each node of the batch
  std::vector<NearestQuery> nearest_queries_;
  std::vector<NearestAnswer> nearest_answers_;
  std::vector<Shade> shades_;
  std::size_t shade_count_ = 0;
  LightAims aims_;
  ReusedList<PendingLight> lights_;
  ReusedList<OcclusionQuery> shadow_queries_;
  std::vector<OcclusionAnswer> shadow_answers_;
  std::vector<std::uint32_t> shadow_owner_;  ///< index in lights_ of each shadow query
  bool any_highlight_ = false;               ///< among lights_
  std::vector<double> power_bases_, power_exponents_;
  std::vector<std::uint32_t> power_owner_;  ///< index in lights_ of each power
  std::vector<Walk> walks_;
  std::vector<NearestQuery> walk_queries_;
  std::vector<NearestAnswer> walk_answers_;
};

}  // namespace rayshade
