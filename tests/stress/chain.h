// SPDX-License-Identifier: MIT
// A chain of transforms in 113 bits.
#pragma once

#include "rayshade/math/affine.h"
#include "tests/unit/geometry/scene_builder.h"
#include "tests/unit/geometry/shapes_quad.h"

namespace rayshade::stress {

using quad::Q;
using quad::V;

/// p' = p.x rows[0] + p.y rows[1] + p.z rows[2] + shift, and its inverse by cross products.
struct Chain {
  V rows[3] = {V(1, 0, 0), V(0, 1, 0), V(0, 0, 1)}, shift{0, 0, 0};

  V vector(const V& p) const { return p.x * rows[0] + p.y * rows[1] + p.z * rows[2]; }
  V point(const V& p) const { return vector(p) + shift; }
  void append(const Affine& map) {
    Chain next;
    for (int i = 0; i < 3; ++i) next.rows[i] = V(map.rows[i]);
    next.shift = V(map.translation);
    for (V& row : rows) row = next.vector(row);
    shift = next.point(shift);
  }
  /// Gradients of the inner coordinates in the outer space.
  V gradient(int i) const {
    const V across = cross(rows[(i + 1) % 3], rows[(i + 2) % 3]);
    return (1 / dot(rows[i], across)) * across;
  }
  V inner_point(const V& p) const { return inner_vector(p - shift); }
  V inner_vector(const V& p) const { return {dot(p, gradient(0)), dot(p, gradient(1)), dot(p, gradient(2))}; }
  quad::Line inner(const Ray& ray) const {
    quad::Line line(ray);
    line.o = inner_point(line.o);
    line.d = inner_vector(line.d);
    return line;
  }
  V outer_normal(const V& n) const {
    return quad::unit(n.x * gradient(0) + n.y * gradient(1) + n.z * gradient(2));
  }
  double growth() const {
    return static_cast<double>(quad::length(rows[0]) + quad::length(rows[1]) + quad::length(rows[2]));
  }
  double inverse_growth() const {
    return static_cast<double>(quad::length(gradient(0)) + quad::length(gradient(1)) +
                               quad::length(gradient(2)));
  }
};

/// A map that stretches, mirrors, turns and moves things of about `size`.
inline Affine odd_map(test::Dice& dice, double size) {
  const auto factor = [&] { return (dice.below(2) ? 1 : -1) * fn::exp(dice.uniform(-1.2, 1.2)); };
  const double x = factor(), y = factor(), z = factor();
  const Vec3 axis = dice.direction();
  const double angle = dice.uniform(0, 360);
  return then(then(scaling({x, y, z}), test::about(axis, angle)), translation(dice.in_box(3 * size)));
}

}  // namespace rayshade::stress
