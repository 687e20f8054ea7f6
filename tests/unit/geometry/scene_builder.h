// SPDX-License-Identifier: MIT
// Scenes for tests, written as values: what the parser would have made of the text beside each test.
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <random>
#include <vector>

#include "rayshade/geometry/compiled_scene.h"
#include "rayshade/geometry/intersector.h"
#include "rayshade/math/functions.h"
#include "rayshade/scene/scene.h"

namespace rayshade::test {

/// With so many primitives at most in copies of an object.
inline CompileOptions at_most_copies(std::uint64_t copies) {
  CompileOptions options;
  options.most_copies = copies;
  return options;
}

class SceneBuilder {
 public:
  Scene scene;

  NodeId sphere(double radius, const Vec3& center) {
    scene.spheres.push_back({radius, center});
    return primitive(NodeKind::kSphere, scene.spheres.size());
  }
  NodeId box(const Vec3& lo, const Vec3& hi) {
    scene.boxes.push_back({lo, hi});
    return primitive(NodeKind::kBox, scene.boxes.size());
  }
  NodeId plane(const Vec3& point, const Vec3& normal) {
    scene.planes.push_back({point, normal});
    return primitive(NodeKind::kPlane, scene.planes.size());
  }
  NodeId disc(double radius, const Vec3& center, const Vec3& normal) {
    scene.discs.push_back({radius, center, normal});
    return primitive(NodeKind::kDisc, scene.discs.size());
  }
  NodeId cylinder(double radius, const Vec3& bottom, const Vec3& top) {
    scene.cylinders.push_back({radius, bottom, top});
    return primitive(NodeKind::kCylinder, scene.cylinders.size());
  }
  NodeId cone(double bottom_radius, const Vec3& bottom, double top_radius, const Vec3& top) {
    scene.cones.push_back({bottom_radius, bottom, top_radius, top});
    return primitive(NodeKind::kCone, scene.cones.size());
  }
  NodeId torus(double swept, double tube, const Vec3& center, const Vec3& axis) {
    scene.tori.push_back({swept, tube, center, axis});
    return primitive(NodeKind::kTorus, scene.tori.size());
  }
  NodeId triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    scene.triangles.push_back({{a, b, c}});
    return primitive(NodeKind::kTriangle, scene.triangles.size());
  }
  NodeId smooth_triangle(const Vec3 (&p)[3], const Vec3 (&n)[3]) {
    scene.smooth_triangles.push_back({{p[0], p[1], p[2]}, {n[0], n[1], n[2]}});
    return primitive(NodeKind::kSmoothTriangle, scene.smooth_triangles.size());
  }
  NodeId polygon(std::vector<Vec3> points) {
    scene.polygons.push_back({std::move(points)});
    return primitive(NodeKind::kPolygon, scene.polygons.size());
  }
  NodeId blob(double threshold, std::vector<shape::Metaball> balls) {
    scene.blobs.push_back({threshold, std::move(balls)});
    return primitive(NodeKind::kBlob, scene.blobs.size());
  }
  NodeId height_field(const std::string& file, const Location& where = {}) {
    scene.height_fields.push_back({{file, where}});
    return primitive(NodeKind::kHeightField, scene.height_fields.size());
  }
  NodeId aggregate(NodeKind kind, std::vector<NodeId> members) {
    scene.aggregates.push_back({std::move(members), {2, 2, 2}});
    Node node;
    node.kind = kind;
    node.payload = static_cast<std::uint32_t>(scene.aggregates.size() - 1);
    return add(node);
  }
  NodeId list(std::vector<NodeId> members) { return aggregate(NodeKind::kList, std::move(members)); }
  NodeId grid(std::vector<NodeId> members) { return aggregate(NodeKind::kGrid, std::move(members)); }
  NodeId unite(std::vector<NodeId> members) { return aggregate(NodeKind::kUnion, std::move(members)); }
  NodeId intersect(std::vector<NodeId> members) {
    return aggregate(NodeKind::kIntersect, std::move(members));
  }
  NodeId difference(std::vector<NodeId> members) {
    return aggregate(NodeKind::kDifference, std::move(members));
  }

  /// `name`: gives what `object` takes.
  std::uint32_t name(NodeId node) {
    scene.named_objects.push_back({"object" + std::to_string(scene.named_objects.size()), node});
    return static_cast<std::uint32_t>(scene.named_objects.size() - 1);
  }
  NodeId object(std::uint32_t named) {
    Node node;
    node.kind = NodeKind::kInstance;
    node.payload = named;
    return add(node);
  }

  NodeId moved(NodeId node, const Affine& map) {
    list_of(node).append(map);
    return node;
  }
  NodeId moved(NodeId node, AnimatedStep step) {
    list_of(node).append(std::move(step));
    return node;
  }
  /// translate (a + b time) for each axis.
  NodeId moving(NodeId node, const Vec3& from, const Vec3& speed) {
    AnimatedStep step;
    step.kind = StepKind::kTranslate;
    for (int axis = 0; axis < 3; ++axis) {
      step.arguments[static_cast<std::size_t>(axis)] = Expression::apply(
          Operation::kAdd,
          {Expression(from[axis]),
           Expression::apply(Operation::kMultiply, {Expression(speed[axis]), Expression::time(), {}, {}}),
           {},
           {}});
    }
    return moved(node, std::move(step));
  }
  /// rotate axis (degrees_per_time time).
  NodeId turning(NodeId node, const Vec3& axis, double degrees_per_time) {
    AnimatedStep step;
    step.kind = StepKind::kRotate;
    step.arguments = {
        Expression(axis.x), Expression(axis.y), Expression(axis.z),
        Expression::apply(Operation::kMultiply, {Expression(degrees_per_time), Expression::time(), {}, {}})};
    return moved(node, std::move(step));
  }
  NodeId surfaced(NodeId node, const Surface& surface) {
    scene.surfaces.push_back(surface);
    scene.nodes[node].surface = static_cast<std::uint32_t>(scene.surfaces.size() - 1);
    return node;
  }
  NodeId transparent(NodeId node, double transparency = 1) {
    Surface surface;
    surface.transparency = transparency;
    return surfaced(node, surface);
  }
  NodeId at(NodeId node, std::uint32_t line) {
    scene.nodes[node].location.line = line;
    return node;
  }
  NodeId textured(NodeId node) {
    scene.texture_lists.emplace_back(1);
    scene.nodes[node].textures = static_cast<std::uint32_t>(scene.texture_lists.size() - 1);
    return node;
  }
  void show(NodeId node) { scene.world.push_back(node); }

  MemoryProvider files;
  /// Objects used several times are instances, unless `options` say otherwise: there are not many in a test.
  std::unique_ptr<CompiledScene> compile(const CompileOptions& options = at_most_copies(0)) {
    return compile_scene(scene, files, options);
  }

 private:
  NodeId add(const Node& node) {
    scene.nodes.push_back(node);
    return static_cast<NodeId>(scene.nodes.size() - 1);
  }
  NodeId primitive(NodeKind kind, std::size_t pool_size) {
    Node node;
    node.kind = kind;
    node.payload = static_cast<std::uint32_t>(pool_size - 1);
    return add(node);
  }
  TransformList& list_of(NodeId node) {
    std::uint32_t& transform = scene.nodes[node].transform;
    if (transform == kNone) {
      scene.transforms.emplace_back();
      transform = static_cast<std::uint32_t>(scene.transforms.size() - 1);
    }
    return scene.transforms[transform];
  }
};

inline Affine about(const Vec3& axis, double degrees) { return rotation_degrees(axis, degrees); }

inline NearestAnswer nearest(const Intersector& intersector, const Ray& ray, TraceScratch& scratch,
                             double lo = kEpsilon, double hi = kFar, Opacity mask = kAnyOpacity) {
  NearestQuery query;
  query.ray = ray;
  query.lo = lo;
  query.hi = hi;
  query.mask = mask;
  NearestAnswer answer;
  intersector.nearest({&query, 1}, {&answer, 1}, scratch);
  return answer;
}

inline bool occluded(const Intersector& intersector, const Ray& ray, TraceScratch& scratch, double lo,
                     double hi, Opacity mask = kAnyOpacity) {
  OcclusionQuery query;
  query.ray = ray;
  query.lo = lo;
  query.hi = hi;
  query.mask = mask;
  OcclusionAnswer answer;
  intersector.occluded({&query, 1}, {&answer, 1}, scratch);
  return answer.occluded;
}

/// Uniform numbers and directions for property tests.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  double uniform(double lo = 0, double hi = 1) {
    return lo + (hi - lo) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }
  Vec3 in_box(double half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
  Vec3 direction() {
    for (;;) {
      const Vec3 v = in_box(1);
      const double square = length_squared(v);
      if (square > 0.01 && square <= 1) return normalize(v);
    }
  }

 private:
  std::mt19937_64 engine_;
};

/// The bytes of a height field file.
inline std::string height_field_bytes(int n, const std::vector<float>& values) {
  std::string out(4 + values.size() * 4, '\0');
  std::memcpy(out.data(), &n, 4);
  std::memcpy(out.data() + 4, values.data(), values.size() * 4);
  return out;
}

}  // namespace rayshade::test
