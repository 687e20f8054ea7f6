// SPDX-License-Identifier: MIT
// Sierpinski's tetrahedron: four half-sized copies in the corners of every tetrahedron, size - 1 times.
#include "scenes/spd/databases.h"

namespace rayshade::spd {
namespace {

// A tetrahedron spans four corners of a cube; `low` is the cube's least corner.
void divide(Writer& writer, int depth, const Vec3& low, double side) {
  const double s = depth > 1 ? side / 2 : side;
  const std::array<Vec3, 4> corners = {low + Vec3{0, 0, s}, low + Vec3{0, s, 0}, low + Vec3{s, 0, 0},
                                       low + Vec3{s, s, s}};
  if (depth > 1) {
    for (const Vec3& corner : corners) divide(writer, depth - 1, corner, s);
    return;
  }
  const auto& [a, b, c, d] = corners;
  writer.polygon(std::array<Vec3, 3>{a, b, c});
  writer.polygon(std::array<Vec3, 3>{d, c, b});
  writer.polygon(std::array<Vec3, 3>{c, d, a});
  writer.polygon(std::array<Vec3, 3>{b, a, d});
}

}  // namespace

void generate_tetra(int size, Writer& writer) {
  View view;
  view.eye = {1.02285, -3.17715, -2.17451};
  view.look = {-0.004103, -0.004103, 0.216539};
  const double third = std::sqrt(2.0 / 3);
  view.up = {-third, -third, third};
  view.lights = {{{2, -18, -5}, 1}};
  writer.header("tetra", view);
  writer.surface({.color = {1, 0.2, 0.2}, .diffuse = 1});
  divide(writer, size, {-1, -1, -1}, 2);
}

}  // namespace rayshade::spd
