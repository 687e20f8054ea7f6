// SPDX-License-Identifier: MIT
// fas: which primitives does a ray meet? Ray casting by adaptive subdivision of the space of rays.
//
// The library finds, for rays, the nearest of many primitives, or whether any is in the way. It knows nothing
// of what the primitives are: the caller gives each a box, perhaps a tighter hull, and a function that tests
// a ray against it. That function alone decides what is hit; the library only leaves out tests that cannot
// succeed, so that its answers are those of testing every primitive, bit by bit.
//
// It works on classes of rays. Rays that share a point (an eye, a lamp) or a direction (the sun) have two
// dimensions, and are answered from trees over them, many at once where they come together; rays with extent
// have up to five. Below the trees lies a bounding volume hierarchy. Trees are made where rays come by, while
// they come, as far as it pays, within a budget of memory. Nothing needs to be tuned.
//
//   Boxes boxes;                                     // derived from fas::Primitives
//   fas::Structure structure(boxes);
//   const fas::RayClass eye = structure.rays_from({0, 0, 9});
//   fas::Tracer tracer(structure);                   // one for every thread
//   fas::Hit hit;
//   if (tracer.nearest(eye, {{0, 0, 9}, {0, 0, -1}}, hit)) ...
//
// Units: t counts lengths of the ray's direction, which need not be 1; coordinates are in the caller's units.
// Threads: a Structure may be used by any number of threads at once, each with a Tracer of its own; making
// classes, clear() and destruction must not overlap with anything. Failure: where memory within the budget is
// spent, trees stop growing and rays become slower; std::bad_alloc comes from constructors and classes only.
//
// G. Simiakakis, A. M. Day, "Five-dimensional adaptive subdivision for ray tracing", Computer Graphics Forum
// 13(2), 1994. J. Arvo, D. Kirk, "Fast ray tracing by ray classification", SIGGRAPH 1987.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace fas {

using Point = std::array<double, 3>;

/// A closed axis-aligned box.
struct Bounds {
  Point lo{}, hi{};
};

/// What a primitive looks like from outside. Its hull is convex and holds every point at which
/// Primitives::intersect may report a hit, to within the rounding of Options::condition. Whatever tells more
/// than the box only saves tests.
struct Geometry {
  enum class Form : std::uint8_t {
    kBox,      ///< `box` alone
    kPoints,   ///< the convex hull of `points`
    kPolygon,  ///< the same; the points are, in order, the corners of a flat convex polygon, e.g. a triangle
    kSpheres,  ///< the convex hull of `spheres` balls: a sphere, or a cylinder or cone by its two ends
  };
  Form form = Form::kBox;
  /// Polygons only: no ray is stopped that goes the way of the normal of the right-handed rule over the
  /// points, so that the primitive may be left out for them (backface culling).
  bool one_sided = false;
  /// Polygons only: every ray that passes well inside of the outline is stopped, so that rays from a point
  /// need not look at what lies behind (truncation).
  bool opaque = false;
  int spheres = 0;  ///< 1 or 2
  /// Always set. With infinite sides: a primitive without bounds, tested for every ray. Inside out: nothing
  /// is ever hit there. Not a number: refused.
  Bounds box;
  Point center[2]{};
  double radius[2]{};
  std::vector<Point> points;
};

/// origin + t direction for near <= t <= far.
struct Ray {
  Point origin{}, direction{};
  double near = 0, far = std::numeric_limits<double>::max();
};

struct Hit {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  double t = 0;
  std::uint32_t primitive = kNone;
};

/// What the caller supplies. Every function may be called by many threads at once, gives the same for the
/// same arguments as long as the Structure lives, and does not throw.
class Primitives {
 public:
  virtual ~Primitives() = default;
  /// Below 2^27.
  virtual std::uint32_t count() const = 0;
  /// Fills `out`, which holds what an earlier call for any primitive left there: set all that the form needs.
  virtual void geometry(std::uint32_t primitive, Geometry& out) const = 0;
  /// Whether the ray meets the primitive at a t with ray.near <= t <= limit, and the least such t. `limit` is
  /// at most ray.far, and less where something nearer is known; the t reported must not depend on it. Whether
  /// the ends of the range belong to it is the caller's business: the library never makes up a t.
  virtual bool intersect(std::uint32_t primitive, const Ray& ray, double limit, double& t) const = 0;
  /// Whether the primitive is in the way of a ray between its ends.
  virtual bool occludes(std::uint32_t primitive, const Ray& ray) const {
    double t = 0;
    return intersect(primitive, ray, ray.far, t);
  }
};

struct Options {
  /// Most threads that build the hierarchy. What is built does not depend on it.
  int threads = 1;
  /// Bytes for all trees together; the hierarchy, 50 to 80 bytes for a primitive, is not counted.
  std::size_t memory = std::size_t{256} << 20;
  /// Hits may lie outside of their hulls by 64 `condition` units of rounding of the largest coordinate at
  /// hand (of ray, hull and whole): 1 for tests made in the coordinates of the hulls; the condition number of
  /// the matrix where rays are taken into a space of the primitive's own.
  double condition = 1;
  /// About how many rays of a class are expected: how much building may pay.
  double expected_rays = 1e6;
  /// Trees are used, and split as deeply as they go, whether that pays or not; for study.
  bool always_split = false;
};

/// Which rays are asked about; see Structure. A ray that does not belong to the class it is said to be of is
/// answered all the same, slower.
struct RayClass {
  std::uint32_t number = 0;
};

/// What was done for one class by one Tracer.
struct Statistics {
  std::uint64_t rays = 0;  ///< answered by the tree of the class
  std::uint64_t elsewhere =
      0;                     ///< by the hierarchy alone: not of the class, no memory, or found to be faster
  std::uint64_t tests = 0;   ///< exact tests of `rays`
  std::uint64_t leaves = 0;  ///< cells made
  std::uint64_t candidates = 0;   ///< in them
  std::uint64_t splits = 0;       ///< of cells that had been in use
  std::uint64_t bytes = 0;        ///< taken of Options::memory
  std::uint64_t nanoseconds = 0;  ///< spent on making them
};

/// Primitives and what has been built over them.
class Structure {
 public:
  /// `primitives` are kept by reference and must outlive the structure. Throws std::invalid_argument where a
  /// box is not a number or there are too many, std::bad_alloc.
  explicit Structure(const Primitives& primitives, const Options& options = {});
  ~Structure();
  Structure(const Structure&) = delete;
  Structure& operator=(const Structure&) = delete;

  /// Rays that start at a point.
  RayClass rays_from(const Point& point);
  /// Rays that go toward a point and end there or before.
  RayClass rays_toward(const Point& point);
  /// Rays of one direction, which is of unit length and that of the rays to the last bit.
  RayClass rays_along(const Point& direction);
  /// Rays that start within a box: from a lens. Sides may be of no length.
  RayClass rays_from(const Bounds& box);
  /// Rays that end, at `far`, within a box: toward a lamp.
  RayClass rays_toward(const Bounds& box);
  /// Rays that have something else in common: reflected by the same things, say.
  RayClass rays();

  /// The box around all bounded primitives; inside out where there are none.
  Bounds bounds() const;
  /// Forgets all trees, and keeps their memory for those to come. Tracers made before must not be used again.
  void clear();
  /// Bytes of the hierarchy, and of the trees at present.
  std::size_t hierarchy_bytes() const;
  std::size_t tree_bytes() const;

  struct Parts;  ///< not for callers

 private:
  friend class Tracer;
  std::unique_ptr<Parts> parts_;
};

/// What one thread needs to ask. Must not outlive the structure.
class Tracer {
 public:
  explicit Tracer(const Structure& structure);
  ~Tracer();
  Tracer(Tracer&&) noexcept;
  Tracer& operator=(Tracer&&) noexcept;

  /// The nearest hit; of several at the same t that of the primitive with the smallest number. False, and
  /// `hit.primitive` is Hit::kNone: none.
  bool nearest(RayClass rays, const Ray& ray, Hit& hit);
  /// Whether some primitive occludes the ray.
  bool occluded(RayClass rays, const Ray& ray);

  /// The same for many rays of a class: hits[i] and occluded[i] (0 or 1) are those of ray i. A few hundred
  /// neighbours at once are much faster than one after the other.
  void nearest(RayClass rays, std::span<const Ray> all, std::span<Hit> hits);
  void occluded(RayClass rays, std::span<const Ray> all, std::span<std::uint8_t> occluded);

  /// Since the tracer was made.
  Statistics statistics(RayClass rays) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace fas
