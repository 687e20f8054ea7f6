// SPDX-License-Identifier: MIT
#include "fas/hierarchy_candidates.h"

namespace fas {
namespace {

constexpr std::uint32_t kWidth = Hierarchy::kWidth;
static_assert(kWidth <= Candidates::kMostChildren);

}  // namespace

HierarchyCandidates::HierarchyCandidates(const Hierarchy& hierarchy, std::uint32_t count)
    : hierarchy_(hierarchy), count_(count), below_(hierarchy.nodes().size(), 0) {
  const auto nodes = hierarchy.nodes();
  for (std::size_t i = nodes.size(); i-- > 0;) {  // children come after their parents
    for (std::size_t lane = 0; lane < kWidth; ++lane) {
      if (nodes[i].opacity[lane] == 0) continue;
      const std::uint32_t child = nodes[i].child[lane];
      below_[i] += (child & Hierarchy::kLeafBit) != 0 ? Hierarchy::count(child) : below_[child];
    }
  }
}

int HierarchyCandidates::open(std::uint32_t subtree, Child (&out)[kMostChildren]) const {
  const auto nodes = hierarchy_.nodes();
  std::uint32_t index = 0;
  if (subtree != kWhole) {
    const std::uint32_t place = subtree & ~kSubtree;
    const std::uint32_t child = nodes[place / kWidth].child[place % kWidth];
    if ((child & Hierarchy::kLeafBit) != 0) {
      const auto count = static_cast<int>(Hierarchy::count(child));
      for (int i = 0; i < count; ++i) out[i].entry = Hierarchy::first(child) + static_cast<std::uint32_t>(i);
      return count;
    }
    index = child;
  }
  const Hierarchy::Node& node = nodes[index];
  const Point& center = hierarchy_.center();
  int count = 0;
  for (std::uint32_t lane = 0; lane < kWidth; ++lane) {
    if (node.opacity[lane] == 0) continue;
    Child& child = out[count++];
    const std::uint32_t below = node.child[lane];
    if ((below & Hierarchy::kLeafBit) != 0 && Hierarchy::count(below) == 1) {
      child.entry = Hierarchy::first(below);
      continue;
    }
    child.entry = kSubtree | (index * kWidth + lane);
    child.below = (below & Hierarchy::kLeafBit) != 0 ? Hierarchy::count(below) : below_[below];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      child.box.lo[axis] = center[axis] + static_cast<double>(node.planes[0][axis][lane]);
      child.box.hi[axis] = center[axis] + static_cast<double>(node.planes[1][axis][lane]);
    }
  }
  return count;
}

}  // namespace fas
