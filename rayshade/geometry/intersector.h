// SPDX-License-Identifier: MIT
// The seam between shading and intersection: spans of queries in, answers out (rules 3 to 5 and 13). Shading does
// not know who answers: brute force (the oracle), the bounding hierarchy, or adaptive subdivision.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "rayshade/geometry/trace.h"

namespace rayshade {

enum class RayKind : std::uint8_t { kEye, kReflected, kTransmitted, kShadow };

struct NearestQuery {
  Ray ray;
  double lo = 0, hi = kFar;
  Opacity mask = kAnyOpacity;       ///< leaves to consider
  RayKind kind = RayKind::kEye;
  std::uint16_t depth = 0;
  std::uint32_t light = kNone;      ///< shadow rays: which light
};

struct NearestAnswer {
  Hit hit;
  bool found = false;
  std::uint32_t tests = 0;          ///< exact tests made for this query
  std::uint32_t bounds_tests = 0;
};

/// Is anything that is certainly opaque (mask kOpaque), or anything at all (kAnyOpacity), between lo and hi?
struct OcclusionQuery {
  Ray ray;
  double lo = 0, hi = kFar;
  Opacity mask = kAnyOpacity;
  std::uint32_t light = kNone;
};

struct OcclusionAnswer {
  bool occluded = false;
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
};

/// Tests every leaf for every ray; stays for ever as the oracle.
std::unique_ptr<Intersector> make_brute_force(const CompiledScene& scene);
/// A bounding hierarchy per group.
std::unique_ptr<Intersector> make_hierarchy(const CompiledScene& scene);

}  // namespace rayshade
