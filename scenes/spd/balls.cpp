// SPDX-License-Identifier: MIT
// Sphereflake: a sphere carries nine of a third its radius, each of which carries nine, down to `size`
// generations.
#include "rayshade/math/affine.h"
#include "rayshade/math/functions.h"
#include "scenes/spd/databases.h"

namespace rayshade::spd {
namespace {

using Directions = std::array<Vec3, 9>;

// Nine of the twelve directions toward the neighbours in a close packing, without the lower three, where the
// parent is. Three are 35 degrees from the z axis, six on the equator.
Directions child_directions() {
  const double d = 1 / std::sqrt(2.0);
  const Vec3 trio[3] = {{d, d, 0}, {d, 0, -d}, {0, d, -d}};
  const Affine upright = rotation({d, -d, 0}, fn::asin(2 / std::sqrt(6.0)));
  Directions out;
  for (int turn = 0; turn < 3; ++turn) {
    const Affine around = rotation({0, 0, 1}, turn * (2 * fn::kPi / 3));
    for (int i = 0; i < 3; ++i) out[3 * turn + i] = around.vector(upright.vector(trio[i]));
  }
  return out;
}

// The smallest turn that takes +z to `direction`; for -z the half turn about y.
Affine turn_up_to(const Vec3& direction) {
  const double across = fn::hypot(direction.x, direction.y);
  if (across < 1e-9) return direction.z > 0 ? Affine{} : rotation({0, 1, 0}, fn::kPi);
  return rotation({-direction.y / across, direction.x / across, 0}, fn::atan2(across, direction.z));
}

// The children are turned with their parent's direction as seen from the grandparent, not with its whole
// frame.
void grow(Writer& writer, const Directions& children, int generations, double radius, const Vec3& center,
          const Vec3& direction) {
  writer.sphere(radius, center);
  if (generations == 0) return;
  const Affine frame = turn_up_to(direction);
  const double child_radius = radius / 3;
  for (const Vec3& child : children) {
    const Vec3 toward = frame.vector(child);
    grow(writer, children, generations - 1, child_radius, center + (radius + child_radius) * toward, toward);
  }
}

}  // namespace

void generate_balls(int size, Writer& writer) {
  View view;
  view.eye = {2.1, 1.3, 1.7};
  view.lights = equal_lights(std::array<Vec3, 3>{{{4, 3, 2}, {1, -4, 4}, {-3, 1, 5}}});
  writer.header("balls", view);
  writer.surface({.color = {1, 0.75, 0.33}, .ambient = 0.2, .diffuse = 0.8});
  write_square(writer, 12, -0.5);
  writer.surface(
      {.color = {1, 0.9, 0.7}, .diffuse = 0.5, .highlight = 0.5, .exponent = 3.0827, .reflection = 0.5});
  grow(writer, child_directions(), size, 0.5, {}, {0, 0, 1});
}

}  // namespace rayshade::spd
