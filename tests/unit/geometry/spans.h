// SPDX-License-Identifier: MIT
// Boolean algebra of solids along a line: the stretches of it that are inside.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "rayshade/scene/scene.h"

namespace rayshade::test {

/// The parts of a line inside a solid: sorted, disjoint.
template <class Number>
using Spans = std::vector<std::pair<Number, Number>>;

template <class Number>
bool inside(const Spans<Number>& spans, const Number& t) {
  return std::any_of(spans.begin(), spans.end(), [&](const auto& s) { return t > s.first && t < s.second; });
}

template <class Number>
Spans<Number> combine(NodeKind operation, const Spans<Number>& a, const Spans<Number>& b) {
  std::vector<Number> ends;
  for (const Spans<Number>* spans : {&a, &b}) {
    for (const auto& [from, to] : *spans) ends.insert(ends.end(), {from, to});
  }
  std::sort(ends.begin(), ends.end());
  Spans<Number> out;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    if (ends[i] == ends[i + 1]) continue;
    const Number middle = (ends[i] + ends[i + 1]) / 2;
    const bool in_a = inside(a, middle), in_b = inside(b, middle);
    const bool in = operation == NodeKind::kUnion       ? in_a || in_b
                    : operation == NodeKind::kIntersect ? in_a && in_b
                                                        : in_a && !in_b;
    if (!in) continue;
    if (!out.empty() && out.back().second == ends[i]) {
      out.back().second = ends[i + 1];
    } else {
      out.emplace_back(ends[i], ends[i + 1]);
    }
  }
  return out;
}

}  // namespace rayshade::test
