// SPDX-License-Identifier: MIT
// Answers as another intersector does, except for one query in so many: what verification must catch.
#pragma once

#include <atomic>
#include <cmath>
#include <memory>

#include "rayshade/geometry/intersector.h"

namespace rayshade::test {

class LyingIntersector final : public Intersector {
 public:
  /// One nearest answer in `every_nearest` and one occlusion answer in `every_occlusion` is wrong; 0: none.
  LyingIntersector(std::unique_ptr<Intersector> inner, std::uint64_t every_nearest,
                   std::uint64_t every_occlusion)
      : inner_(std::move(inner)), every_nearest_(every_nearest), every_occlusion_(every_occlusion) {}

  void nearest(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
               TraceScratch& scratch) const override {
    inner_->nearest(queries, answers, scratch);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      if (every_nearest_ == 0 || ++asked_ % every_nearest_ != 0) continue;
      ++lies_;
      lie(answers[i]);
    }
  }
  void occluded(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers,
                TraceScratch& scratch) const override {
    inner_->occluded(queries, answers, scratch);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      if (every_occlusion_ == 0 || ++occlusions_asked_ % every_occlusion_ != 0) continue;
      answers[i].occluded = !answers[i].occluded;
      ++lies_;
    }
  }
  void scene_changed() override { inner_->scene_changed(); }
  std::uint64_t lies() const { return lies_; }

 private:
  /// What is nothing can only be wrong as a whole; a hit from crudely to the last bit.
  void lie(NearestAnswer& answer) const {
    Hit& hit = answer.hit;
    if (!answer.found) {
      answer.found = true;
      hit.shape = {1, 0, 0, 0};
      hit.leaf = 0;
      hit.instances.count = 0;
      return;
    }
    switch (turn_++ % 5) {
      case 0:
        answer.found = false;
        break;
      case 1:
        hit.rank ^= 1;
        break;
      case 2:
        hit.instances.leaves[hit.instances.count++] = 0;
        break;
      case 3:
        hit.leaf = hit.leaf == 0 ? 1 : 0;
        break;
      default:
        hit.shape.t = std::nextafter(hit.shape.t, 2 * hit.shape.t);
    }
  }

  std::unique_ptr<Intersector> inner_;
  std::uint64_t every_nearest_, every_occlusion_;
  mutable std::atomic<std::uint64_t> asked_{0}, occlusions_asked_{0}, lies_{0}, turn_{0};
};

}  // namespace rayshade::test
