// SPDX-License-Identifier: MIT
// A tree after M. Aono and T. Kunii, "Botanical tree image generation", IEEE Computer Graphics and
// Applications 4(5), 1984: every branch, a cone with a sphere at its tip, forks into two, `size` times.
#include "rayshade/math/affine.h"
#include "rayshade/math/functions.h"
#include "scenes/spd/databases.h"

namespace rayshade::spd {
namespace {

constexpr double kTaper = 0.67;  // of the diameter, per generation

struct Fork {
  double bend;         // degrees away from the parent's direction
  double azimuth;      // degrees about the parent's direction
  double contraction;  // of the length
};

// Both forks are turned a further quarter from one generation to the next.
constexpr Fork kForks[2] = {{40, 90, 0.65}, {25, 230, 0.70}};

// `frame` takes +z to the branch's own direction.
void grow(Writer& writer, int generations, const Affine& frame, const Vec3& base, double length,
          double radius) {
  const Vec3 tip = base + length * frame.rows[2];
  writer.cone(radius, base, radius * kTaper, tip);
  writer.sphere(radius * kTaper, tip);
  if (generations == 0) return;
  for (const Fork& fork : kForks) {
    const Affine bent =
        then(rotation_degrees({0, 1, 0}, fork.bend), then(rotation_degrees({0, 0, 1}, fork.azimuth), frame));
    grow(writer, generations - 1, bent, tip, length * fork.contraction, radius * kTaper);
  }
}

}  // namespace

void generate_tree(int size, Writer& writer) {
  View view;
  view.eye = {4.5, 0.4, 2};
  view.look = {0, 0, 1.5};
  view.lights = equal_lights(std::array<Vec3, 7>{{{-5, 5, 50},
                                                  {30, -30, 30},
                                                  {-40, -30, 20},
                                                  {10, 30, 40},
                                                  {-30, 40, 10},
                                                  {50, 25, 20},
                                                  {-10, -60, 30}}});
  writer.header("tree", view);
  writer.surface({.color = {0.2, 0.7, 0.2}, .diffuse = 1});
  write_square(writer, 50, 0);
  writer.surface({.color = {0.55, 0.4, 0.2}, .diffuse = 1});
  grow(writer, size, rotation_degrees({0, 0, 1}, -90), {}, 1, 0.15);
}

}  // namespace rayshade::spd
