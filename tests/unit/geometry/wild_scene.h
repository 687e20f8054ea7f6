// SPDX-License-Identifier: MIT
// Random scenes that look for the weak points of culling: sizes over many powers of ten, slivers, flat and
// empty boxes, polygons off their plane, coincident objects, and points at which rays graze something.
#pragma once

#include <cmath>
#include <limits>

#include "tests/unit/geometry/random_scene.h"

namespace rayshade::test {

struct WildScene : RandomScene {
  std::vector<Vec3> marks;  ///< on, or close to, corners, edges and outlines of what is in the world

  using RandomScene::RandomScene;

  double any_size(double least, double most) { return fn::exp(dice.uniform(fn::log(least), fn::log(most))); }
  /// A point that is where others are as well, every other time.
  Vec3 place(double half) {
    if (!marks.empty() && dice.below(3) == 0) return mark();
    return snapped(half);
  }
  Vec3 mark() { return marks[static_cast<std::size_t>(dice.below(static_cast<int>(marks.size())))]; }
  Vec3 marked(const Vec3& p) {
    marks.push_back(p);
    return p;
  }

  NodeId sliver(double half) {
    const double size = any_size(1e-5, 30);
    const Vec3 a = marked(place(half)), along = dice.direction(), across = dice.direction();
    const Vec3 end = marked(a + size * along);
    const double width = size * any_size(1e-9, 1);
    const Vec3 c = marked(a + size * dice.uniform() * along + width * across);
    marked(0.5 * (a + end));
    if (end.x == a.x && end.y == a.y && end.z == a.z) return b.sphere(size, a);
    return b.triangle(a, end, c);
  }
  NodeId flat_polygon(double half) {
    const double size = any_size(1e-4, 10);
    const Vec3 at = place(half), u = dice.direction(), n = dice.direction();
    const Vec3 v = normalize(cross(n, u));
    const int corners = 3 + dice.below(7);
    std::vector<Vec3> points;
    for (int i = 0; i < corners; ++i) {
      const double angle = 2 * fn::kPi * i / corners,
                   radius = size * (dice.below(4) ? 1 : dice.uniform(0.2, 1));
      Vec3 p = at + radius * fn::cos(angle) * u + radius * fn::sin(angle) * v;
      // Off the plane, now and then by much.
      if (dice.below(6) == 0) p = p + size * any_size(1e-12, 0.3) * cross(u, v);
      points.push_back(marked(p));
    }
    for (std::size_t i = 0; i < points.size(); ++i)
      marked(0.5 * (points[i] + points[(i + 1) % points.size()]));
    return b.polygon(points);
  }
  NodeId thin_box(double half) {
    const Vec3 lo = marked(place(half));
    Vec3 extent{any_size(1e-6, 5), any_size(1e-6, 5), any_size(1e-6, 5)};
    if (dice.below(2)) extent[dice.below(3)] = 0;
    if (dice.below(6) == 0) extent[dice.below(3)] = 0;
    marked(lo + extent);
    marked(lo + 0.5 * extent);
    return b.box(lo, lo + extent);
  }
  NodeId ball(double half) {
    const double radius = any_size(1e-6, dice.below(8) ? 2 : 100);
    const Vec3 at = place(half);
    for (int i = 0; i < 3; ++i) marked(at + radius * dice.direction());
    return b.sphere(radius, at);
  }
  NodeId stick(double half) {
    const Vec3 from = place(half), to = from + any_size(1e-4, 10) * dice.direction();
    const double radius = any_size(1e-6, 2);
    marked(from), marked(to);
    const double end = dice.below(3) ? radius * dice.uniform() : 0;
    switch (dice.below(3)) {
      case 0:
        return b.cylinder(radius, from, to);
      case 1:
        return b.cone(radius, from, end, to);
      default:
        return b.cone(end, from, radius, to);
    }
  }

  NodeId wild(double half) {
    switch (dice.below(8)) {
      case 0:
      case 1:
      case 2:
        return sliver(half);
      case 3:
        return flat_polygon(half);
      case 4:
        return thin_box(half);
      case 5:
        return ball(half);
      case 6:
        return stick(half);
      default: {
        const Vec3 at = marked(place(half));
        return b.disc(any_size(1e-5, 10), at, dice.direction());
      }
    }
  }

  /// About `objects` objects in the box +-half, more or less ordinary ones among them.
  void fill_wildly(int objects, double half) {
    for (int i = 0; i < objects; ++i) {
      if (dice.below(3) == 0) {
        b.show(any(2, half));
        continue;
      }
      const NodeId id = wild(half);
      b.show(decorated(id, false));
      if (dice.below(10) == 0) {  // and once more in the same place
        b.scene.nodes.push_back(b.scene.nodes[id]);
        b.show(static_cast<NodeId>(b.scene.nodes.size() - 1));
      }
    }
    if (dice.below(3) == 0) b.show(b.plane({0, 0, -half}, {0, 0, 1}));
  }

  /// What stresses culling most, one kind at a time: sizes from 1e-8 to 1e4 with planes among them;
  /// everything in one place; flat things whose boxes have no volume, many of them in the same plane.
  void fill_extremely(std::uint64_t kind, int objects, double half) {
    const Vec3 middle = snapped(half);
    for (int i = 0; i < objects; ++i) {
      if (kind % 3 == 0) {
        const double size = any_size(1e-8, 1e4);
        // The large ones far off, so that they do not hold all that is small.
        const Vec3 at = marked(in_reach(half) + (size > half ? 1.5 * size : 0) * dice.direction());
        b.show(decorated(simple(size, at), false));
        if (dice.below(20) == 0) b.show(decorated(b.plane(at, dice.direction()), false));
      } else if (kind % 3 == 1) {
        marked(middle + dice.direction());
        b.show(decorated(simple(1, middle), false));
      } else {
        Vec3 lo = in_reach(half), extent{any_size(1e-3, 3), any_size(1e-3, 3), any_size(1e-3, 3)};
        const int axis = dice.below(3);
        extent[axis] = 0;
        if (dice.below(2)) lo[axis] = middle[axis];
        if (dice.below(8) == 0) extent[(axis + 1) % 3] = 0;
        marked(lo + extent), marked(lo + .5 * extent);
        Vec3 up;
        up[axis] = 1;
        b.show(decorated(dice.below(4) ? b.box(lo, lo + extent) : b.disc(max_abs(extent), lo, up), false));
      }
    }
  }
  Vec3 in_reach(double half) { return dice.below(3) ? place(half) : dice.in_box(half); }
  NodeId simple(double size, const Vec3& at) {
    switch (dice.below(5)) {
      case 0:
        return b.box(at - size * Vec3{1, 1, 1}, at + size * Vec3{1, 1, 1});
      case 1:
        return b.disc(size, at, {0, 0, 1});
      case 2:
        return b.cylinder(size, at, at + size * Vec3{0, 0, 1});
      case 3:
        return b.triangle(at, at + size * Vec3{1, 0, 0}, at + size * Vec3{0, 1, 0});
      default:
        return b.sphere(size, at);
    }
  }

  double nudged(double x) {
    const int steps = dice.below(9) - 4;
    const double toward =
        steps < 0 ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
    for (int i = 0; i < std::abs(steps); ++i) x = std::nextafter(x, toward);
    return x;
  }
  /// Where to aim: at marks to the last bits, past them by little, or anywhere.
  Vec3 target(double half) {
    if (marks.empty() || dice.below(4) == 0) return dice.in_box(half);
    const Vec3 p = mark();
    switch (dice.below(4)) {
      case 0:
        return p;
      case 1:
        return {nudged(p.x), nudged(p.y), nudged(p.z)};
      default:
        return p + any_size(1e-12, 1) * dice.direction();
    }
  }
};

}  // namespace rayshade::test
