// SPDX-License-Identifier: MIT
// A pyramid of ring clusters. A ring is five cylinders joined by spheres; a cluster is six interlocked rings,
// one about each five-fold axis of an icosahedron. Layer k of the pyramid, seen along y from its apex, has
// k*k clusters.
#include "rayshade/math/functions.h"
#include "scenes/spd/databases.h"

namespace rayshade::spd {
namespace {

constexpr double kRingRadius = 0.9309948;  // measured
constexpr double kTubeRadius = 0.07412;    // measured
constexpr double kSpacing = 2;             // of clusters within a layer
constexpr int kCorners = 5;

constexpr Color kColors[6] = {{0.5, 0, 0},   {0, 0.5, 0},   {0, 0, 0.5},
                              {0, 0.5, 0.5}, {0.5, 0, 0.5}, {0.5, 0.5, 0}};

using Ring = std::array<Vec3, kCorners>;

// Ring 0 lies in the xy plane. The other five each contain one direction of that plane and are tilted about
// it by the angle between two five-fold axes, whose tangent is 2.
Ring ring_corners(int ring) {
  const double azimuth = ring == 0 ? 0 : (36 + 72 * (ring - 1)) * (fn::kPi / 180);
  const double cos_tilt = ring == 0 ? 1 : 1 / std::sqrt(5.0);
  const double sin_tilt = ring == 0 ? 0 : 2 / std::sqrt(5.0);
  const Vec3 first{fn::cos(azimuth), fn::sin(azimuth), 0};
  const Vec3 second{-fn::sin(azimuth) * cos_tilt, fn::cos(azimuth) * cos_tilt, sin_tilt};
  Ring out;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = i * (2 * fn::kPi / kCorners);
    out[i] = kRingRadius * (fn::cos(angle) * first + fn::sin(angle) * second);
  }
  return out;
}

void write_cluster(Writer& writer, const Vec3& center) {
  for (int ring = 0; ring < 6; ++ring) {
    writer.surface(
        {.color = kColors[ring], .diffuse = 1, .highlight = 0.3, .exponent = 3.0827, .reflection = 0.2});
    const Ring corners = ring_corners(ring);
    for (int i = 0; i < kCorners; ++i) {
      const Vec3 here = center + corners[i], before = center + corners[(i + kCorners - 1) % kCorners];
      writer.cone(kTubeRadius, here, kTubeRadius, before);
      writer.sphere(kTubeRadius, here);
    }
  }
}

}  // namespace

void generate_rings(int size, Writer& writer) {
  // A layer fills the view of 45 degrees from one layer's distance in front of the apex.
  const double half_angle = fn::kPi / 8;
  const double layer = 1 / fn::sin(half_angle);
  const Vec3 center{-1, 0, 0.5};
  View view;
  view.eye = {center.x, -layer, center.z};
  view.look = {center.x, -layer + 1, center.z};
  view.lights = equal_lights(std::array<Vec3, 3>{{{3, -layer, 3}, {-4, -layer, 1}, {2, -layer, -4}}});
  writer.header("rings", view);

  // The wall is one per cent larger than what is seen of it.
  const double wall = (size + 1) * layer;
  const double half = 1.01 * (wall + layer) * fn::tan(half_angle);
  writer.surface({.color = {1, 1, 1}, .diffuse = 1});
  writer.polygon(std::array<Vec3, 4>{{{center.x + half, wall, center.z + half},
                                      {center.x - half, wall, center.z + half},
                                      {center.x - half, wall, center.z - half},
                                      {center.x + half, wall, center.z - half}}});
  for (int k = 1; k <= size; ++k)
    for (int row = 0; row < k; ++row)
      for (int column = 0; column < k; ++column)
        write_cluster(writer, {1 - k + kSpacing * column, k * layer, 1 - k + kSpacing * row});
}

}  // namespace rayshade::spd
