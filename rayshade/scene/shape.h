// SPDX-License-Identifier: MIT
// Primitives as written (language.md 3.7, objects.md 4), after the checks of the parser: degenerate ones
// never get here, corners of boxes are sorted, cones with equal radii are cylinders. Passive; tests are in
// rayshade/geometry.
#pragma once

#include <vector>

#include "rayshade/math/vec.h"
#include "rayshade/scene/texture.h"

namespace rayshade::shape {

struct Plane {
  Vec3 point, normal;
};  ///< normal as written, not normalised
struct Sphere {
  double radius = 1;
  Vec3 center;
};
struct Box {
  Vec3 lo, hi;
};
struct Disc {
  double radius = 1;
  Vec3 center, normal;
};
struct Cylinder {
  double radius = 1;
  Vec3 bottom, top;
};
struct Cone {
  double bottom_radius = 1;
  Vec3 bottom;
  double top_radius = 0;
  Vec3 top;
};
struct Torus {
  double swept = 1, tube = 0.5;
  Vec3 center, axis;
};
struct Triangle {
  Vec3 p[3];
};
struct SmoothTriangle {
  Vec3 p[3], n[3];
};  ///< Phong; normals as written
struct UvTriangle {
  Vec3 p[3], n[3];
  double u[3], v[3];
};
struct Polygon {
  std::vector<Vec3> points;
};
struct Metaball {
  double strength = 1, radius = 1;
  Vec3 center;
};
struct Blob {
  double threshold = 0;
  std::vector<Metaball> balls;
};
struct HeightField {
  FileReference file;
};

}  // namespace rayshade::shape
