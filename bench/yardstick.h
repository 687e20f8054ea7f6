// SPDX-License-Identifier: MIT
// Embree 3 over the leaves of a compiled world, in its best form: triangles (polygons cut up) as its own,
// everything else as user geometry with the very exact tests that we use. For benchmarks only.
#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <span>
#include <vector>

#include "bench/recording.h"
#include "rayshade/geometry/tree_candidates.h"

namespace rayshade::bench {

/// What Embree hands back to the callbacks of user geometry.
struct UserGeometry {
  const CompiledScene* scene;
  const std::vector<LeafId>* leaves;
  TraceScratch* scratch;
};

class Yardstick {
 public:
  Yardstick(const CompiledScene& scene, bool robust);
  ~Yardstick();
  Yardstick(const Yardstick&) = delete;
  Yardstick& operator=(const Yardstick&) = delete;

  /// Distances of the nearest hits; negative: none.
  void nearest(std::span<const NearestQuery> queries, double* distances);
  void nearest16(std::span<const NearestQuery> queries, double* distances);
  void occluded(std::span<const OcclusionQuery> queries, std::uint8_t* answers);
  /// Seconds to build: the better of two commits.
  double build_seconds() const { return build_seconds_; }
  std::size_t bytes() const { return bytes_; }

  std::size_t bytes_ = 0;

 private:
  void build(bool robust);

  const CompiledScene& scene_;
  TraceScratch scratch_;
  std::vector<float> vertices_;
  std::vector<LeafId> others_;  ///< leaves that are user geometry
  UserGeometry user_{&scene_, &others_, &scratch_};
  RTCDevice device_ = nullptr;
  RTCScene embree_ = nullptr;
  double build_seconds_ = 0;
};

}  // namespace rayshade::bench
