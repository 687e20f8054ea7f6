// SPDX-License-Identifier: MIT
// The scene as it was written: a passive value. It owns no global state; any number of scenes can be parsed
// and rendered in one process, at once. Pools are deques so that a million triangles grow without copies.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "rayshade/scene/light.h"
#include "rayshade/scene/node.h"
#include "rayshade/scene/settings.h"
#include "rayshade/scene/shape.h"
#include "rayshade/scene/surface.h"
#include "rayshade/scene/texture.h"
#include "rayshade/scene/transform.h"

namespace rayshade {

struct Scene {
  std::vector<std::string> file_names{"-"};  ///< Location::file indexes this
  SceneSettings settings;
  std::vector<Light> lights;  ///< without `ambient`; in the order written; none: see default_light
  std::deque<Node> nodes;
  std::vector<NodeId> world;  ///< top-level objects in the order written
  std::deque<Aggregate> aggregates;
  std::deque<NamedObject> named_objects;
  std::deque<Surface> surfaces;
  std::deque<TransformList> transforms;
  std::deque<std::vector<Texture>> texture_lists;

  std::deque<shape::Plane> planes;
  std::deque<shape::Sphere> spheres;
  std::deque<shape::Box> boxes;
  std::deque<shape::Disc> discs;
  std::deque<shape::Cylinder> cylinders;
  std::deque<shape::Cone> cones;
  std::deque<shape::Torus> tori;
  std::deque<shape::Triangle> triangles;
  std::deque<shape::SmoothTriangle> smooth_triangles;
  std::deque<shape::UvTriangle> uv_triangles;
  std::deque<shape::Polygon> polygons;
  std::deque<shape::Blob> blobs;
  std::deque<shape::HeightField> height_fields;

  /// "file:line:column", or just the file where the line is unknown.
  std::string describe(const Location& where) const;
  /// Primitives under a node as objects.md 6.6 counts them (instances count fully), saturating at 2^63.
  std::uint64_t primitive_count(NodeId node) const;
};

/// The light of a scene that defines none (language.md 3.5).
Light default_light();

/// The scene as canonical text: parsing it again gives the same text, and rendering it the same bytes.
std::string canonical_text(const Scene& scene);
/// A 128-bit name of the scene, as 32 hexadecimal digits: a hash of its canonical text with numbers in binary
/// (NumberForm::kBits), so that scenes have the same name where they have the same text.
std::string scene_hash(const Scene& scene);

}  // namespace rayshade
