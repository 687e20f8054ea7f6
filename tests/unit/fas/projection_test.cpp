// SPDX-License-Identifier: MIT
// Areas are conservative: every point of a primitive, moved by as much as rays and exact tests may be off,
// lies in the primitive's area, in each face that sees it. Points are projected in extended precision, from
// the definition of the planes and not by the library's code.
#include "fas/projection.h"

#include <gtest/gtest.h>

#include "fas/tree.h"
#include "tests/unit/fas/random_geometry.h"

namespace fas {
namespace {

using test::Dice;
using test::Quad;

/// A view and a primitive in some relation to it.
struct Setting {
  View view;
  Geometry geometry;
};

/// Directions that touch borders of faces are common.
Point border_direction(Dice& dice) {
  Point d = dice.direction();
  if (dice.below(2)) return d;
  const double one = dice.below(2) ? 1 : -1;
  for (std::size_t i = 0; i < 3; ++i) {
    if (dice.below(2))
      d[i] = (dice.below(2) ? one : -one) * (dice.below(2) ? 1 : 1 + 1e-9 * dice.uniform(-1, 1));
    if (dice.below(5) == 0) d[i] = 0;
  }
  return d;
}

Setting random_setting(Dice& dice) {
  Setting out;
  const double unit = dice.below(3) ? 1 : dice.size(-6, 6);
  Point apex{};
  if (dice.below(3)) apex = dice.in_box(unit * dice.size(-3, 6));
  // How far away, from within to very far, and how large.
  const double distance = unit * dice.size(-6, 6);
  const double size = dice.below(2) ? distance * dice.size(-6, 1) : unit * dice.size(-6, 6);
  Point at = test::along(apex, border_direction(dice), distance);
  if (dice.below(20) == 0) at = apex;
  out.geometry = test::random_geometry(dice, at, size);
  Geometry& g = out.geometry;
  if (g.form == Geometry::Form::kSpheres) {
    const Point d = dice.direction();
    switch (dice.below(8)) {
      case 0:  // through the apex
        g.center[0] = test::along(apex, d, g.radius[0]);
        break;
      case 1:  // seen along the axis
        g.center[0] = test::along(apex, d, distance);
        g.center[1] = test::along(apex, d, distance + size * (1 + dice.size(-9, 0)));
        break;
      case 2:  // almost tangent to the apex
        g.center[0] = test::along(apex, d, g.radius[0] * (1 + dice.size(-12, 0)));
        break;
      default:
        break;
    }
    test::set_box(g);
  } else if (g.form == Geometry::Form::kPolygon && dice.below(6) == 0) {  // seen edge-on
    const auto last = g.points.size() - 1;
    for (std::size_t i = 0; i < 3; ++i) g.points[last][i] = apex[i] + 1.7 * (g.points[0][i] - apex[i]);
    test::set_box(g);
  }
  Bounds all = g.box;
  if (dice.below(4) == 0) test::add(all, dice.in_box(distance * dice.size(0, 3)));
  const double condition = dice.below(4) ? 1 : dice.size(0, 4);
  if (dice.below(4) == 0) {
    Point d = dice.direction();
    if (dice.below(3) == 0) d = dice.below(2) ? Point{0, 0, -1} : Point{0, 1, 0};
    out.view = make_view(View::Kind::kParallel, d, all, condition);
  } else {
    out.view = make_view(View::Kind::kPoint, apex, all, condition);
  }
  return out;
}

using Quads = std::array<Quad, 3>;

/// (u, v, z) from the definition: for a point view u and v are along the axes that follow the face's in
/// cyclic order.
bool projected(const View& view, const Plane& plane, int face, const Quads& p, Quads& out) {
  if (view.kind == View::Kind::kParallel) {
    // The frame is the library's choice: asked for unit vectors, it names it. Two of its axes must be across
    // the rays, and it must be orthonormal.
    out = {};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Point unit{};
      unit[axis] = 1;
      const Point column = plane.local(unit);
      for (std::size_t i = 0; i < 3; ++i) out[i] += column[i] * p[axis];
    }
    return true;
  }
  const auto axis = static_cast<std::size_t>(face / 2);
  const Quad sign = face % 2 ? -1 : 1;
  const Quad z = sign * (p[axis] - view.apex[axis]);
  if (!(z > 0)) return false;
  const std::size_t next = (axis + 1) % 3, after = (axis + 2) % 3;
  out = {(p[next] - view.apex[next]) / z, (p[after] - view.apex[after]) / z, z};
  return out[0] >= -1 && out[0] <= 1 && out[1] >= -1 && out[1] <= 1;
}

testing::AssertionResult holds(const Footprint& f, const Quads& p) {
  const auto [u, v, z] = p;
  if (!(u >= f.u0 && u <= f.u1))
    return testing::AssertionFailure() << "u " << u << " not in " << f.u0 << ", " << f.u1;
  if (!(v >= f.v0 && v <= f.v1))
    return testing::AssertionFailure() << "v " << v << " not in " << f.v0 << ", " << f.v1;
  if (!(z >= f.z0 && z <= f.z1))
    return testing::AssertionFailure() << "z " << z << " not in " << f.z0 << ", " << f.z1;
  for (int k = 0; k < f.cuts; ++k) {
    const Quad value = f.cut[k][0] * u + f.cut[k][1] * v + f.cut[k][2];
    if (!(value >= 0)) return testing::AssertionFailure() << "cut " << k << " gives " << value;
  }
  return testing::AssertionSuccess();
}

TEST(Projection, AreasHoldEveryPointThatMayBeHit) {
  constexpr int kSettings = 60'000, kPoints = 40;
  std::uint64_t seen = 0, cuts = 0, one_face = 0;
  for (int number = 0; number < kSettings; ++number) {
    Dice dice(static_cast<std::uint64_t>(number) + 1);
    const Setting s = random_setting(dice);
    std::vector<Plane> planes;
    Footprint prints[6], boxes[6];
    bool there[6], box_there[6];
    for (int face = 0; face < s.view.faces(); ++face) {
      planes.emplace_back(s.view, face);
      there[face] = planes.back().project(s.geometry, prints[face]);
      box_there[face] = planes.back().project(s.geometry.box, boxes[face]);
      if (there[face]) cuts += static_cast<std::uint64_t>(prints[face].cuts), ++one_face;
    }
    for (int i = 0; i < kPoints; ++i) {
      Quads p = test::random_point(dice, s.geometry, s.view.apex);
      // Moved by half the slack, often straight along an axis.
      Point d = dice.direction();
      if (dice.below(2)) {
        d = {};
        d[static_cast<std::size_t>(dice.below(3))] = dice.below(2) ? 1 : -1;
      }
      for (std::size_t k = 0; k < 3; ++k) p[k] += 0.499L * s.view.slack * d[k];
      for (int face = 0; face < s.view.faces(); ++face) {
        Quads flat;
        if (!projected(s.view, planes[static_cast<std::size_t>(face)], face, p, flat)) continue;
        ++seen;
        ASSERT_TRUE(there[face]) << "seed " << number + 1 << ", face " << face;
        ASSERT_TRUE(holds(prints[face], flat)) << "seed " << number + 1 << ", face " << face << ", form "
                                               << int(s.geometry.form) << ", point " << i;
        ASSERT_TRUE(box_there[face]) << "seed " << number + 1 << ", face " << face;
        ASSERT_TRUE(holds(boxes[face], flat)) << "box, seed " << number + 1 << ", face " << face;
      }
    }
  }
  EXPECT_GT(seen, 1'000'000u);
  EXPECT_GT(cuts, one_face / 2) << "or else cuts are hardly tested";
}

/// Conservative is not enough: an area that is far from the slack's size is not much larger than what it
/// holds.
TEST(Projection, AreasAreTight) {
  Dice dice(5);
  for (int number = 0; number < 2'000; ++number) {
    const Point at = test::along({}, dice.direction(), 10);
    const Geometry g = test::random_geometry(dice, at, dice.size(-2, 0));
    if (g.form == Geometry::Form::kBox) continue;
    const View view = make_view(View::Kind::kPoint, {}, g.box, 1);
    for (int face = 0; face < 6; ++face) {
      const Plane plane(view, face);
      Footprint f;
      if (!plane.project(g, f) || f.u0 < -0.9 || f.u1 > 0.9 || f.v0 < -0.9 || f.v1 > 0.9) continue;
      Quad u0 = 9, u1 = -9;
      for (int i = 0; i < 3'000; ++i) {
        Quads flat;
        if (!projected(view, plane, face, test::random_point(dice, g, {}), flat)) continue;
        u0 = std::min(u0, flat[0]), u1 = std::max(u1, flat[0]);
      }
      const double width = f.u1 - f.u0;
      EXPECT_LT(width, 1.05 * static_cast<double>(u1 - u0) + 1e-9) << "seed " << number << ", face " << face;
    }
  }
}

/// The frame of parallel rays is orthonormal and looks against them.
TEST(Projection, FramesOfParallelRays) {
  Dice dice(6);
  for (int number = 0; number < 10'000; ++number) {
    Point d = dice.direction();
    if (number < 6) d = {}, d[static_cast<std::size_t>(number / 2)] = number % 2 ? -1 : 1;
    View view;
    view.kind = View::Kind::kParallel;
    view.direction = d;
    const Plane plane(view, 0);
    const Point x = plane.local({1, 0, 0}), y = plane.local({0, 1, 0}), z = plane.local({0, 0, 1});
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k)
        ASSERT_NEAR(x[i] * x[k] + y[i] * y[k] + z[i] * z[k], i == k, 1e-15) << number;
    }
    const Point along = plane.local(d);
    ASSERT_NEAR(along[0], 0, 1e-15);
    ASSERT_NEAR(along[1], 0, 1e-15);
    ASSERT_NEAR(along[2], -1, 1e-15);
  }
}

/// A direction is in the face through which it leaves the cube, and where its points are.
TEST(Projection, DirectionsHaveThePlaceOfTheirPoints) {
  Dice dice(7);
  const View view = make_view(View::Kind::kPoint, {}, {{-1, -1, -1}, {1, 1, 1}}, 1);
  for (int number = 0; number < 200'000; ++number) {
    const Point d = border_direction(dice);
    if (d == Point{}) continue;
    const int face = face_of(d.data());
    ASSERT_GE(face, 0);
    ASSERT_LT(face, 6);
    const Plane plane(view, face);
    double u = 0, v = 0;
    plane.of_direction(d.data(), u, v);
    Quads flat;
    ASSERT_TRUE(projected(view, plane, face, {d[0], d[1], d[2]}, flat)) << number;
    ASSERT_NEAR(u, static_cast<double>(flat[0]), 4e-16);
    ASSERT_NEAR(v, static_cast<double>(flat[1]), 4e-16);
  }
}

/// With more bits, for slim triangles far away.
double orientation(const Quads& first, const Quads& second, const Quads& third) {
  __extension__ typedef __float128 Wide;
  const Wide a[3] = {first[0], first[1], first[2]}, b[3] = {second[0], second[1], second[2]},
             c[3] = {third[0], third[1], third[2]};
  const Wide value = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
                     a[2] * (b[0] * c[1] - b[1] * c[0]);
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}

/// A ray that is inside an opaque triangle by the margin hits it, also when it passes the apex by what it
/// may.
TEST(Projection, RaysWellInsideACoverHit) {
  std::uint64_t covers = 0, rays = 0;
  for (int number = 0; number < 60'000; ++number) {
    Dice dice(900'000 + static_cast<std::uint64_t>(number));
    Setting s = random_setting(dice);
    s.geometry.opaque = true;
    if (s.geometry.form != Geometry::Form::kPolygon || s.view.kind != View::Kind::kPoint) continue;
    for (int face = 0; face < 6; ++face) {
      const Plane plane(s.view, face);
      Footprint f;
      if (!plane.project(s.geometry, f) || !f.covers) continue;
      ++covers;
      ASSERT_EQ(f.cuts, 3);
      for (int i = 0; i < 100; ++i) {
        double weight[3] = {dice.uniform(), dice.uniform(), dice.uniform()};
        const double total = weight[0] + weight[1] + weight[2];
        // A point of the area, often close to an edge.
        if (dice.below(2)) weight[dice.below(3)] = total * dice.size(-12, -1);
        Quads target{};
        const double sum = weight[0] + weight[1] + weight[2];
        for (std::size_t k = 0; k < 3; ++k)
          for (std::size_t c = 0; c < 3; ++c)
            target[k] += static_cast<Quad>(weight[c]) / sum * s.geometry.points[c][k];
        Quads flat;
        if (!projected(s.view, plane, face, target, flat)) continue;
        bool inside = true;
        for (int k = 0; k < 3; ++k)
          inside = inside && f.cut[k][0] * flat[0] + f.cut[k][1] * flat[1] + f.cut[k][2] >= f.inside[k];
        if (!inside) continue;
        ++rays;
        // From a displaced apex to a displaced target: the same side of all three edges.
        Quads o, d;
        const Point move_o = dice.direction(), move_t = dice.direction();
        for (std::size_t k = 0; k < 3; ++k) {
          o[k] = s.view.apex[k] + 0.249L * s.view.slack * move_o[k];
          d[k] = target[k] + 0.249L * s.view.slack * move_t[k] - o[k];
        }
        int positive = 0, negative = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          Quads a, b;
          for (std::size_t c = 0; c < 3; ++c) {
            a[c] = s.geometry.points[k][c] - o[c];
            b[c] = s.geometry.points[(k + 1) % 3][c] - o[c];
          }
          const double side = orientation(a, b, d);
          positive += side > 0;
          negative += side < 0;
        }
        ASSERT_TRUE(positive == 3 || negative == 3) << "seed " << 900'000 + number << ", face " << face;
      }
    }
  }
  EXPECT_GT(covers, 1'000u);
  EXPECT_GT(rays, 20'000u);
}

}  // namespace
}  // namespace fas
