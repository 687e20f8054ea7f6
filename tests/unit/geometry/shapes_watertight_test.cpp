// SPDX-License-Identifier: MIT
// No ray leaks between triangles that share an edge: a closed mesh, whose triangles name their vertices in
// any order and turn either way, is shot at its edges and vertices. Only the triangles around the target are
// asked, so that a stray hit elsewhere cannot hide a leak.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <vector>

#include "rayshade/geometry/shapes/triangle.h"

namespace rayshade {
namespace {

constexpr std::uint64_t kSeed = 7;

struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> faces;
};

/// An icosahedron, every face split in four `levels` times, on the unit sphere.
Mesh icosphere(int levels) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  Mesh mesh;
  mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (Vec3& v : mesh.vertices) v = normalize(v);
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [at, added] = middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh.vertices.size()));
      if (added) mesh.vertices.push_back(normalize(mesh.vertices[a] + mesh.vertices[b]));
      return at->second;
    };
    std::vector<std::array<int, 3>> faces;
    for (const auto& [a, b, c] : mesh.faces) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      faces.insert(faces.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.faces = std::move(faces);
  }
  return mesh;
}

struct Counts {
  int rays = 0, leaks = 0, doubled = 0;
};

/// `place` maps the unit sphere to where the mesh shall be.
template <class Place>
Counts shoot(const Mesh& unit_mesh, int rays, const Place& place) {
  std::mt19937_64 engine(kSeed);
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto inside_point = [&] {
    for (;;) {
      const Vec3 p{2 * uniform(engine) - 1, 2 * uniform(engine) - 1, 2 * uniform(engine) - 1};
      if (length_squared(p) < 0.8) return p;
    }
  };
  std::vector<Vec3> vertices;
  // Moved along the sphere by up to a third of an edge, so that no edge is seen as a silhouette from well
  // inside.
  for (const Vec3& v : unit_mesh.vertices) vertices.push_back(place(normalize(v + 0.01 * inside_point())));
  std::vector<Triangle> triangles;
  std::vector<std::vector<int>> around(vertices.size());
  for (const auto& face : unit_mesh.faces) {
    std::array<int, 3> f = face;
    std::shuffle(f.begin(), f.end(), engine);
    for (const int v : f) around[v].push_back(static_cast<int>(triangles.size()));
    triangles.emplace_back(shape::Triangle{{vertices[f[0]], vertices[f[1]], vertices[f[2]]}});
  }

  Counts counts;
  for (int i = 0; i < rays; ++i) {
    const auto& face = unit_mesh.faces[engine() % unit_mesh.faces.size()];
    const int a = face[i % 3], b = face[(i + 1) % 3];
    const double part = i % 4 == 0 ? 0 : i % 4 == 1 ? 0.5 : uniform(engine);
    const Vec3 origin = place(i % 8 < 4 ? inside_point() : Vec3{0, 0, 0});
    const Vec3 target = vertices[a] + part * (vertices[b] - vertices[a]);
    const Ray ray{origin, target - origin};
    int hits = 0;
    ShapeHit hit;
    for (const int v : {a, b}) {
      for (const int t : around[v]) {
        if (v == b && std::find(around[a].begin(), around[a].end(), t) != around[a].end()) continue;
        hits += triangles[t].intersect(ray, 0, 2, hit);
      }
    }
    ++counts.rays;
    counts.leaks += hits == 0;
    counts.doubled += hits > 1;
  }
  return counts;
}

TEST(ShapesWatertight, ClosedMeshDoesNotLeak) {
  const Mesh mesh = icosphere(5);
  ASSERT_EQ(mesh.faces.size(), 20480u);
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  const struct {
    const char* name;
    Vec3 center;
    double radius;
  } places[] = {{"unit", {0, 0, 0}, 1},
                {"small, far from zero", {1234.5, -987.6, 5000.1}, 1e-2},
                {"tiny", {0, 0, 0}, 1e-6},
                {"large", {1e6, 0, 3e6}, 1e7},
                {"a few thousand grains across", {1, 1, 1}, 1e-12}};
  for (const auto& at : places) {
    const Counts counts = shoot(mesh, 100000, [&](const Vec3& p) { return at.center + at.radius * p; });
    std::printf("  %-28s %d rays, %d leaks, %d hit more than one triangle\n", at.name, counts.rays,
                counts.leaks, counts.doubled);
    EXPECT_EQ(counts.leaks, 0) << at.name;
  }
}

TEST(ShapesWatertight, EdgesAndVerticesBelongToAllTheirTriangles) {
  // Exact numbers: the rays really pass through edges and vertices.
  const Vec3 a{-1, 0, 0}, b{1, 0, 0}, c{0, 1, 0.5}, d{0, -1, 0.25};
  const Triangle upper(shape::Triangle{{a, b, c}}), lower(shape::Triangle{{a, b, d}}),
      turned(shape::Triangle{{d, b, a}});
  ShapeHit hit;
  for (const double x : {-1.0, -0.5, 0.0, 0.25, 1.0}) {
    for (const Vec3 direction : {Vec3{0, 0, -1}, Vec3{0.5, 0, -2}, Vec3{-0.0, -0.0, -3}}) {
      const Ray ray{Vec3{x, 0, 0} - 2 * direction, direction};
      for (const Triangle* triangle : {&upper, &lower, &turned}) {
        ASSERT_TRUE(triangle->intersect(ray, 0, 10, hit)) << x;
        EXPECT_DOUBLE_EQ(hit.t, 2);
        EXPECT_GE(hit.a, 0);
        EXPECT_GE(hit.b, 0);
        EXPECT_LE(hit.a + hit.b, 1);
      }
    }
  }
  EXPECT_FALSE(upper.intersect({{1.0000000000000002, 0, 2}, {0, 0, -1}}, 0, 10, hit));
  EXPECT_FALSE(upper.intersect({{0, -5e-324, 2}, {0, 0, -1}}, 0, 10, hit));
}

TEST(ShapesWatertight, EdgeFunctionHasTheExactSign) {
  // Integers of 53 bits, whose products have 106.
  using Integer = boost::multiprecision::int128_t;
  std::mt19937_64 engine(kSeed);
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  const auto integer = [&] { return static_cast<long long>(engine() >> 11) - (1LL << 52); };
  int zeros = 0, positive = 0, negative = 0;
  for (int i = 0; i < 100000; ++i) {
    const long long ax = integer(), ay = integer();
    // b almost parallel to a: a multiple of a over a power of two, rounded, and a little more.
    const long long factor = static_cast<long long>(engine() % 1000) - 500;
    const auto shrunk = [&](long long v) { return static_cast<long long>((Integer(v) * factor) / 1024); };
    const long long bx = shrunk(ax) + static_cast<long long>(engine() % 3) - 1, by = shrunk(ay);
    const Integer exact = Integer(ax) * by - Integer(ay) * bx;
    const int power = static_cast<int>(engine() % 400) - 200;
    const double value = edge_function_exactly(std::ldexp(static_cast<double>(ax), power),
                                               std::ldexp(static_cast<double>(ay), power),
                                               static_cast<double>(bx), static_cast<double>(by));
    ASSERT_EQ(value > 0, exact > 0) << ax << ' ' << ay << ' ' << bx << ' ' << by;
    ASSERT_EQ(value < 0, exact < 0) << ax << ' ' << ay << ' ' << bx << ' ' << by;
    ++(exact > 0 ? positive : exact < 0 ? negative : zeros);
  }
  EXPECT_GT(positive, 10000);
  EXPECT_GT(negative, 10000);
  EXPECT_EQ(edge_function_exactly(3e-200, 6e-200, 1e-200, 2e-200), 0);
  EXPECT_GT(edge_function_exactly(1e-200, 1e-200, 1e-200, std::nextafter(1e-200, 1)), 0);
  EXPECT_LT(edge_function_exactly(1e200, 1e200, std::nextafter(1e200, 1e300), 1e200), 0);
}

}  // namespace
}  // namespace rayshade
