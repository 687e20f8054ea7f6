// SPDX-License-Identifier: MIT
// The compile step between scene and rays (rule 1): the scene is flattened into groups of leaves over typed
// pools.
//
// A *leaf* is what an intersector tests: a primitive, a CSG object, or an instance of a shared group. A
// *group* is a set of leaves in one space: the world, the body of an object that is instanced more than once,
// or an operand of CSG. Lists, grids and objects used once vanish: their transforms are composed into the
// *placement* of each leaf, their surfaces and textures are found through the leaf's *path*, a chain of nodes
// from the primitive outward. Named objects that are never instanced are never compiled.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fas/clip_box.h"
#include "rayshade/geometry/hit.h"
#include "rayshade/geometry/ray.h"
#include "rayshade/geometry/shapes.h"
#include "rayshade/scene/node.h"
#include "rayshade/scene/provider.h"
#include "rayshade/scene/scene.h"

namespace fas {
class Hierarchy;
}

namespace rayshade {

enum class LeafKind : std::uint8_t {
  kPlane,
  kSphere,
  kBox,
  kDisc,
  kCylinder,
  kCone,
  kTorus,
  kTriangle,
  kSmoothTriangle,
  kUvTriangle,
  kPolygon,
  kBlob,
  kHeightField,
  kCsg,
  kInstance,
};
inline constexpr int kLeafKinds = static_cast<int>(LeafKind::kInstance) + 1;

/// What the kind is called in reports about single objects.
constexpr const char* name_of(LeafKind kind) {
  constexpr const char* kNames[kLeafKinds] = {"plane",           "sphere",      "box",     "disc",
                                              "cylinder",        "cone",        "torus",   "triangle",
                                              "smooth triangle", "uv triangle", "polygon", "blob",
                                              "height field",    "CSG object",  "instance"};
  return kNames[static_cast<int>(kind)];
}

/// What the untextured surfaces below a leaf may be (rule 5); CSG and instances may be both.
enum Opacity : std::uint8_t { kOpaque = 1, kTransparent = 2, kAnyOpacity = 3 };

/// 24 bytes.
struct Leaf {
  LeafKind kind = LeafKind::kPlane;
  std::uint8_t opacity = kOpaque;   ///< Opacity bits
  bool animated = false;            ///< its placement varies with time
  std::uint32_t shape = 0;          ///< index in the pool of its kind (CSG: csgs, instance: instances)
  std::uint32_t placement = kNone;  ///< index in placements; kNone: the group's own space
  std::uint32_t path = kNone;       ///< index in path_nodes: the primitive's own node; CSG and instances: the
                                    ///< innermost of their nodes that has something to say, or kNone
  std::uint64_t order = 0;  ///< place in the original's order of tests within the group (objects.md 6.2);
                            ///< 64 bits because shared structures hold exponentially many places
};

/// One step of the way from a primitive to the world. The world itself has no node.
struct PathNode {
  std::uint32_t parent = kNone;    ///< next node outward within the group; kNone: the group's top
  std::uint32_t surface = kNone;   ///< Scene::surfaces
  std::uint32_t textures = kNone;  ///< Scene::texture_lists
  std::uint32_t transform =
      kNone;  ///< Scene::transforms: this node's own list; also index of level_transforms
};

/// All transforms between a primitive and the space of its group, composed.
struct Placement {
  AffinePair map;                           ///< animated ones: at the start of the frame, for sizes only
  std::vector<const TransformList*> lists;  ///< animated ones: innermost first
  bool animated() const { return !lists.empty(); }
};

/// One of union, intersect, difference over two operand groups (objects.md 7).
struct Csg {
  NodeKind operation = NodeKind::kUnion;
  std::uint32_t left = 0, right = 0;  ///< groups, in the space of the leaf's group
  std::uint32_t placement = kNone;    ///< the CSG object's own space: the scale of its tolerance
  double tolerance = kEpsilon;        ///< EPS of `next`, in its own space (objects.md 7.2), smaller for
                                      ///< objects smaller than one unit
  bool in_packs = false;              ///< evaluated for many rays at once (csg_pack.h)
};

/// A shared group standing somewhere. The order of its leaf shifts the ranks of its members.
struct Instance {
  std::uint32_t group = 0;
};

struct Group {
  std::uint32_t first = 0, count = 0;  ///< leaves; unbounded ones come first
  std::uint32_t unbounded = 0;         ///< how many are unbounded
  std::uint64_t order_span = 0;        ///< how many orders its leaves use, instances' contents included
  Bounds3 bounds;                      ///< of the bounded leaves, over the frame's shutter interval
  fas::ClipBox clip_box;               ///< of the same
  double condition = 1;                ///< largest growth of rounding errors by the placements below
  bool few_simple = false;             ///< at most two bounded leaves, cheaper to test than a box
  bool solid = false;                  ///< one closed solid: whoever leaves it was inside its bounds
  std::shared_ptr<const fas::Hierarchy> hierarchy;  ///< none where a loop over the leaves is as good
};

/// An error found while compiling: a height field that cannot be read, a structure that cannot be held.
struct CompileError : std::runtime_error {
  CompileError(const std::string& what, Location where) : std::runtime_error(what), location(where) {}
  Location location;
};

struct CompileOptions {
  bool flip_normals = false;  ///< -f (objects.md 4.4)
  Interval shutter;           ///< of the first frame
  double frame = 0;
  bool hierarchies = true;  ///< false: loops over all leaves everywhere (the oracle)
  /// Objects used several times are shared where their copies would have more primitives than this. Copies
  /// are faster: nothing needs to be taken into the space of an instance one ray at a time, and what is met
  /// is found among primitives, not among instances. Sharing saves memory, which is not worth it for so few.
  std::uint64_t most_copies = 4096;
  int threads = 1;  ///< at most so many build hierarchies; the result does not depend on it
  bool unused_files =
      false;  ///< looks also at files of objects that are not used, only to see if they are good
};

/// Counts for the statistics.
struct CompileCounts {
  std::uint64_t primitives = 0;  ///< as objects.md 6.6 counts them
  std::uint64_t leaves = 0;
  std::uint64_t shared_groups = 0;
  std::uint64_t unused_objects = 0;  ///< named objects never instanced, hence never built
  std::uint64_t bytes = 0;           ///< of pools, leaves and hierarchies
};

class CompiledScene {
 public:
  CompiledScene() = default;
  CompiledScene(const CompiledScene&) = delete;
  CompiledScene& operator=(const CompiledScene&) = delete;

  const Scene* scene = nullptr;  ///< must outlive this
  std::vector<Leaf> leaves;
  std::vector<Group> groups;  ///< groups[0] is the world
  std::vector<PathNode> path_nodes;
  std::vector<Placement> placements;
  std::vector<Csg> csgs;
  std::vector<Instance> instances;
  /// Per entry of Scene::transforms: its constant map and inverse (unused for animated lists).
  std::vector<AffinePair> level_transforms;

  std::vector<Plane> planes;
  std::vector<Sphere> spheres;
  std::vector<Box> boxes;
  std::vector<Disc> discs;
  std::vector<Cylinder> cylinders;
  std::vector<Cone> cones;
  std::vector<Torus> tori;
  std::vector<Triangle> triangles;
  std::vector<SmoothTriangle> smooth_triangles;
  std::vector<UvTriangle> uv_triangles;
  std::vector<Polygon> polygons;
  std::vector<Blob> blobs;
  std::vector<HeightField> height_fields;

  /// Per path node: whether it or a node further out in the same group has textures.
  std::vector<std::uint8_t> path_textured;
  /// Per path node: the surface of the innermost node outward that has one; kNone: none in the group.
  std::vector<std::uint32_t> path_surfaces;
  /// world_extent() of the primitives of a scene of not too many leaves, seen without instances; else empty.
  std::vector<double> leaf_extents;
  /// Groups, every one after all that it refers to.
  std::vector<std::uint32_t> bottom_up;

  bool has_transparent = false;  ///< some leaf is not opaque: shadow rays may need the ordered walk
  bool has_textures = false;
  bool has_csg = false;
  bool has_motion = false;
  double scale = 1;  ///< largest extent of the bounded part of the world; 1 without one
  CompileCounts counts;

  /// Bounds and hierarchies over another frame's shutter interval; does nothing for a scene without motion.
  /// Leaves may change their numbers within their group. Throws MotionError where a transform is degenerate
  /// at the start of the frame. Returns whether anything changed.
  bool prepare_frame(const Interval& shutter, double frame, bool hierarchies);
  /// Bounds, orders and hierarchies anew, over the present frame. (prepare_frame knows when that is needed.)
  void rebuild(bool hierarchies);
  /// Largest extent of a leaf in the space of its group (planes: `scale`).
  double leaf_extent(LeafId leaf) const;
  /// Conservative bounds in the space of its group at any time of the interval. What CSG and instances refer
  /// to is taken as of the last prepare_frame.
  Bounds3 leaf_bounds(LeafId leaf, const Interval& time, double frame) const;
  /// The box of the primitive of a leaf in its own space; not for CSG and instances.
  Bounds3 shape_bounds(const Leaf& leaf) const;

  Interval shutter{};
  double frame = 0;
  int threads = 1;  ///< CompileOptions::threads

 private:
  friend std::unique_ptr<CompiledScene> compile_scene(const Scene&, Provider&, const CompileOptions&);
  void place_animated();
  void set_tolerances();
  void measure_extents();
  void rebuild_group(Group& group, bool hierarchies);
  Bounds3 group_bounds(std::uint32_t group) const;
  Bounds3 csg_bounds(const Csg& csg) const;
  double leaf_condition(const Leaf& leaf) const;
  void count_bytes();
};

/// Flattens. Throws CompileError.
std::unique_ptr<CompiledScene> compile_scene(const Scene& scene, Provider& provider,
                                             const CompileOptions& options);

}  // namespace rayshade
