// SPDX-License-Identifier: MIT
// A structure of primitives for the tests of the trees: its hierarchy halves at the median, nothing more.
#pragma once

#include <numeric>

#include "fas/tree.h"
#include "tests/unit/fas/random_geometry.h"

namespace fas::test {

class Scene final : public Candidates {
 public:
  explicit Scene(std::vector<Geometry> primitives) : primitives_(std::move(primitives)) {
    order_.resize(primitives_.size());
    std::iota(order_.begin(), order_.end(), 0u);
    nodes_.reserve(2 * primitives_.size() + 1);
    make(0, static_cast<std::uint32_t>(order_.size()));
  }

  std::uint32_t count() const override { return static_cast<std::uint32_t>(primitives_.size()); }
  Bounds bounds() const override { return nodes_[0].box; }
  void geometry(std::uint32_t primitive, Geometry& out) const override { out = primitives_[primitive]; }
  int open(std::uint32_t subtree, Child (&out)[kMostChildren]) const override {
    const Node& node = nodes_[subtree == kWhole ? 0 : subtree & ~kSubtree];
    int count = 0;
    if (node.children == 0) {
      for (std::uint32_t i = node.first; i < node.last; ++i) {
        out[count] = {};
        out[count++].entry = order_[i];
      }
      return count;
    }
    for (const std::uint32_t child : {node.children, node.second}) {
      const Node& below = nodes_[child];
      out[count++] = {kSubtree | child, below.last - below.first, below.box};
    }
    return count;
  }

  const Geometry& operator[](std::uint32_t i) const { return primitives_[i]; }

 private:
  struct Node {
    Bounds box;
    std::uint32_t first = 0, last = 0, children = 0, second = 0;
  };

  std::uint32_t make(std::uint32_t first, std::uint32_t last) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Bounds box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
    for (std::uint32_t i = first; i < last; ++i) {
      add(box, primitives_[order_[i]].box.lo);
      add(box, primitives_[order_[i]].box.hi);
    }
    Node node{box, first, last, 0, 0};
    if (last - first > 3) {
      std::size_t axis = 0;
      for (std::size_t i = 1; i < 3; ++i)
        if (box.hi[i] - box.lo[i] > box.hi[axis] - box.lo[axis]) axis = i;
      const std::uint32_t middle = (first + last) / 2;
      std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                       [&](std::uint32_t a, std::uint32_t b) {
                         return primitives_[a].box.lo[axis] < primitives_[b].box.lo[axis];
                       });
      node.children = make(first, middle);
      node.second = make(middle, last);
    }
    nodes_[index] = node;
    return index;
  }

  std::vector<Geometry> primitives_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

/// The distance along a ray at which it meets a triangle, negative where it does not: by the sides of its
/// edges, relative to the ray's origin.
inline double triangle_hit(const Geometry& triangle, const double* o, const double* d) {
  double a[3][3];
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 3; ++i) a[k][i] = triangle.points[k][i] - o[i];
  const auto side = [&](const double* p, const double* q) {
    return d[0] * (p[1] * q[2] - p[2] * q[1]) + d[1] * (p[2] * q[0] - p[0] * q[2]) +
           d[2] * (p[0] * q[1] - p[1] * q[0]);
  };
  const double u = side(a[1], a[2]), v = side(a[2], a[0]), w = side(a[0], a[1]);
  if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0))) return -1;
  const double sum = u + v + w;
  if (!(std::fabs(sum) > 0)) return -1;
  double along = 0, square = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    along += d[i] * (u * a[0][i] + v * a[1][i] + w * a[2][i]) / sum;
    square += d[i] * d[i];
  }
  return along / square;
}

}  // namespace fas::test
