// SPDX-License-Identifier: MIT
// The rays of a picture, as the renderer asks for them: every span of queries, in order, with the answers.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rayshade/geometry/intersector.h"
#include "rayshade/lang/parse.h"
#include "rayshade/render/renderer.h"

namespace rayshade::bench {

struct Recording {
  struct Span {
    bool nearest;
    std::size_t first, count;  ///< in `nearest` or `shadow`
  };
  std::vector<Span> spans;
  std::vector<NearestQuery> nearest;
  std::vector<OcclusionQuery> shadow;
  std::vector<double> distance;  ///< of the nearest hits; negative: none
  std::vector<LeafId> leaf;
  std::vector<std::uint8_t> occluded;
};

/// Passes everything on, and keeps it.
class Recorder final : public Intersector {
 public:
  Recorder(std::unique_ptr<Intersector> inner, Recording& out) : inner_(std::move(inner)), out_(out) {}
  std::size_t preferred_span() const override { return 512; }
  void nearest(std::span<const NearestQuery> queries, std::span<NearestAnswer> answers,
               TraceScratch& scratch) const override {
    inner_->nearest(queries, answers, scratch);
    out_.spans.push_back({true, out_.nearest.size(), queries.size()});
    out_.nearest.insert(out_.nearest.end(), queries.begin(), queries.end());
    for (std::size_t i = 0; i < queries.size(); ++i) {
      out_.distance.push_back(answers[i].found ? answers[i].hit.t() : -1);
      out_.leaf.push_back(answers[i].found ? answers[i].hit.leaf : kNone);
    }
  }
  void occluded(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers,
                TraceScratch& scratch) const override {
    inner_->occluded(queries, answers, scratch);
    out_.spans.push_back({false, out_.shadow.size(), queries.size()});
    out_.shadow.insert(out_.shadow.end(), queries.begin(), queries.end());
    for (std::size_t i = 0; i < queries.size(); ++i) out_.occluded.push_back(answers[i].occluded);
  }

 private:
  std::unique_ptr<Intersector> inner_;
  Recording& out_;
};

}  // namespace rayshade::bench
