// SPDX-License-Identifier: MIT
// The ray tree of a pixel as text (--explain).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "rayshade/render/block_renderer.h"

namespace rayshade {

/// Collects what happens in a ray tree, and prints it as an indented tree: one paragraph per ray with its
/// hit, surface, lights and colour, children below their parents.
class ExplainText : public TreeObserver {
 public:
  explicit ExplainText(const FrameScene& frame) : frame_(frame) {}
  void on_hit(const HitEvent& event) override;
  void on_light(const LightEvent& event) override;
  void on_finish(std::uint32_t node, const Color& color) override;
  /// The text of everything observed.
  std::string text() const;

 private:
  struct Entry {
    std::string head;
    std::vector<std::string> lines;
    std::vector<std::size_t> children;
    Color color;
    bool root = false;
  };
  void print(std::size_t entry, int depth, std::string& out) const;
  std::string object_name(const Hit& hit) const;

  const FrameScene& frame_;
  std::vector<Entry> entries_;
  std::map<std::uint32_t, std::size_t> open_;  ///< tree nodes are reused; these are alive
};

}  // namespace rayshade
