// SPDX-License-Identifier: MIT
// The seam between shading and intersection: spans of queries in, answers out (rules 3 to 5 and 13). Shading
// does not know who answers: brute force (the oracle), the bounding hierarchy, or adaptive subdivision.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "rayshade/geometry/trace.h"

namespace rayshade {

struct IntersectorReport;

enum class RayKind : std::uint8_t { kEye, kReflected, kTransmitted, kShadow };

/// What the kind is called in reports.
constexpr const char* name_of(RayKind kind) {
  constexpr const char* kNames[] = {"eye ray", "reflected ray", "transmitted ray", "shadow ray"};
  return kNames[static_cast<int>(kind)];
}

struct NearestQuery {
  Ray ray;
  double lo = 0, hi = kFar;
  Opacity mask = kAnyOpacity;  ///< leaves to consider
  RayKind kind = RayKind::kEye;
  std::uint16_t depth = 0;
  std::uint32_t light = kNone;  ///< shadow rays: which light; `hi` is then no farther than it
};

struct NearestAnswer {
  Hit hit;
  bool found = false;
  std::uint32_t tests = 0;  ///< exact tests made for this query
  std::uint32_t bounds_tests = 0;
};

/// Is anything that is certainly opaque (mask kOpaque), or anything at all (kAnyOpacity), between lo and hi?
struct OcclusionQuery {
  Ray ray;
  double lo = 0, hi = kFar;
  Opacity mask = kAnyOpacity;
  std::uint32_t light = kNone;  ///< which light; `hi` is then no farther than it
};

struct OcclusionAnswer {
  bool occluded = false;
  /// Whether there may be a hit with something outside the mask of the query, found on the way: if not, the
  /// nearest query for the rest of the leaves would find nothing.
  bool others = false;
  std::uint32_t tests = 0;
  std::uint32_t bounds_tests = 0;
};

class Intersector {
 public:
  virtual ~Intersector() = default;
  /// Answers every query; answers[i] belongs to queries[i]. Thread-safe with one scratch per thread.
  virtual void nearest(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
                       TraceScratch& scratch) const = 0;
  virtual void occluded(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers,
                        TraceScratch& scratch) const = 0;
  /// How many queries of a span it likes best: enough to share work, few enough to stay in cache.
  virtual std::size_t preferred_span() const { return 64; }
  /// The compiled scene has been prepared for another frame; scratches used before must not be used again.
  virtual void scene_changed() {}
  /// Adds to `into` what was done with this scratch, which must not be in use; once for each scratch.
  virtual void report(const TraceScratch& /*scratch*/, IntersectorReport& /*into*/) const {}
  /// The tree of rays from the eye's point; null where there is none.
  virtual const fas::HyperTree* eye_tree() const { return nullptr; }
};

/// Tests every leaf for every ray; stays for ever as the oracle.
std::unique_ptr<Intersector> make_brute_force(const CompiledScene& scene);
/// A bounding hierarchy per group.
std::unique_ptr<Intersector> make_hierarchy(const CompiledScene& scene);

/// A class of rays: all pass through one point, all are parallel, or they have extent in space.
struct RayClass {
  enum class Kind : std::uint8_t { kSpread, kPoint, kParallel };
  Kind kind = Kind::kSpread;
  Vec3 point;      ///< kPoint: where they pass; kParallel: their direction, unit length
  Bounds3 bounds;  ///< kSpread: where they start, or, rays toward a light, end; empty: anywhere
};

struct FasOptions {
  RayClass eye;                                 ///< of eye rays
  std::vector<RayClass> lights;                 ///< of shadow rays, by their light number
  std::size_t memory = std::size_t{256} << 20;  ///< bytes for all trees
  fas::Split split = fas::Split::kAdaptive;
  double rays = 1e6;   ///< expected of every class, about: how much building may pay
  bool choose = true;  ///< false: all rays go through the trees of their classes, even where the hierarchy is
                       ///< faster; so does Split::kAlways
};

/// Adaptive subdivision: a hyper-tree per class of rays over the world's leaves. `scene` must have
/// hierarchies.
std::unique_ptr<Intersector> make_fas(const CompiledScene& scene, const FasOptions& options);

}  // namespace rayshade
