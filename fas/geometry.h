// SPDX-License-Identifier: MIT
// What the library knows of primitives: their bounds and, where the caller can say more, a convex hull that
// is tighter than the box. Everything here only serves to leave primitives out; whether a ray hits one is for
// the exact test.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace fas {

using Point = std::array<double, 3>;

/// A closed axis-aligned box.
struct Bounds {
  Point lo{}, hi{};
};

/// What a primitive looks like from outside. Its hull is convex and holds every point at which the exact test
/// may report a hit, to within the slack given to the trees.
struct Geometry {
  enum class Form : std::uint8_t {
    kBox,      ///< `box` alone
    kPoints,   ///< the convex hull of `points`
    kPolygon,  ///< the same; the points are, in order, the corners of a flat convex polygon
    kSpheres,  ///< the convex hull of `spheres` balls: a sphere, or a cylinder or cone by its two ends
  };
  Form form = Form::kBox;
  /// Polygons only: the exact test never reports a hit from the side into which the normal of the
  /// right-handed rule over the points does not look, so that beams from there may leave it out.
  bool one_sided = false;
  /// Polygons only: a ray that passes well inside of the outline is certainly stopped there, so that rays
  /// from a point need not look at what lies behind (truncation).
  bool opaque = false;
  int spheres = 0;
  Bounds box;  ///< always set
  Point center[2]{};
  double radius[2]{};
  std::vector<Point> points;
};

/// The primitives of one structure, and the hierarchy over them as something that is opened step by step.
/// Thread-safe for any number of readers; must outlive every tree that is grown from it.
class Candidates {
 public:
  /// An entry of a candidate set is a primitive, or a subtree of the hierarchy (with this bit).
  static constexpr std::uint32_t kSubtree = 0x80000000u;
  /// The whole hierarchy.
  static constexpr std::uint32_t kWhole = 0xffffffffu;
  static constexpr int kMostChildren = 16;

  struct Child {
    std::uint32_t entry = 0;
    std::uint32_t below = 1;  ///< primitives in it
    Bounds box;               ///< of subtrees; primitives are asked for their geometry
  };

  virtual ~Candidates() = default;
  virtual std::uint32_t count() const = 0;
  virtual Bounds bounds() const = 0;
  /// Fills `out`; its vector is reused.
  virtual void geometry(std::uint32_t primitive, Geometry& out) const = 0;
  /// The parts of a subtree (or of kWhole); returns how many.
  virtual int open(std::uint32_t subtree, Child (&out)[kMostChildren]) const = 0;
};

}  // namespace fas
