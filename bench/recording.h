// SPDX-License-Identifier: MIT
// The rays of a picture, as the renderer asks for them: every span of queries, in order, with the answers.
#pragma once

#include <functional>
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

  std::size_t rays() const { return nearest.size() + shadow.size(); }
  void clear() {
    spans.clear();
    nearest.clear();
    shadow.clear();
    distance.clear();
    leaf.clear();
    occluded.clear();
  }
};

/// Passes everything on, and keeps it. A recording of at least `limit` rays is handed to `full` and emptied,
/// in the rendering thread; what is left at the end stays in it. For one rendering thread.
class Recorder final : public Intersector {
 public:
  Recorder(std::unique_ptr<Intersector> inner, Recording& out, std::size_t limit,
           std::function<void(const Recording&)> full)
      : inner_(std::move(inner)), out_(out), limit_(limit), full_(std::move(full)) {}
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
    pass_on();
  }
  void occluded(std::span<const OcclusionQuery> queries, std::span<OcclusionAnswer> answers,
                TraceScratch& scratch) const override {
    inner_->occluded(queries, answers, scratch);
    out_.spans.push_back({false, out_.shadow.size(), queries.size()});
    out_.shadow.insert(out_.shadow.end(), queries.begin(), queries.end());
    for (std::size_t i = 0; i < queries.size(); ++i) out_.occluded.push_back(answers[i].occluded);
    pass_on();
  }

 private:
  void pass_on() const {
    if (out_.rays() < limit_) return;
    full_(out_);
    out_.clear();
  }

  std::unique_ptr<Intersector> inner_;
  Recording& out_;
  std::size_t limit_;
  std::function<void(const Recording&)> full_;
};

}  // namespace rayshade::bench
