// SPDX-License-Identifier: MIT
// No ray leaves a closed mesh from inside: through the whole path of a query, hierarchy and packets of rays
// included, aimed at shared edges and vertices, of meshes in odd transforms.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <map>
#include <thread>

#include "tests/stress/markdown.h"
#include "tests/unit/geometry/scene_builder.h"

namespace rayshade::stress {
namespace {

using test::Dice;
using test::SceneBuilder;

constexpr std::size_t kSpan = 4096;

struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> faces;
};

/// An octahedron, every face split in four `levels` times, on the unit sphere: 8 * 4^levels triangles. Its
/// vertices are moved along the sphere by a part of an edge, so that no two triangles are alike.
Mesh ball(int levels, Dice& dice) {
  Mesh mesh;
  mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, added] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
      if (added) mesh.vertices.push_back(normalize(mesh.vertices[a] + mesh.vertices[b]));
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> faces;
    for (const auto& [a, b, c] : mesh.faces) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      faces.insert(faces.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.faces = std::move(faces);
  }
  const double edge = 1.5 / (1 << levels);
  for (Vec3& v : mesh.vertices) v = normalize(v + .15 * edge * dice.direction());
  return mesh;
}

struct Place {
  const char* name;
  bool slow;     ///< see places()
  double scale;  ///< of the numbers of the mesh
  Vec3 center;   ///< in these units
  Affine map;    ///< after that
};

/// Between the two sides of a ball that is flattened and oblique a ray passes thousands of boxes of
/// triangles, where there are millions: it takes as long as two hundred elsewhere.
std::vector<Place> places() {
  return {
      {"unit ball", false, 1, {}, {}},
      {"radius 1e-6", false, 1e-6, {}, {}},
      {"radius 1e6, 1000 radii away", false, 1e6, {700, -500, 500}, {}},
      {"radius 1, 1e6 radii away", false, 1, {7e5, -5e5, 5e5}, {}},
      {"scaled by 3, .01, 50, turned", true, 1, {}, then(scaling({3, .01, 50}), test::about({1, 2, 3}, 77))},
      {"scaled by 30, 1, -1e-2, sheared, far",
       true,
       1,
       {},
       then(then(scaling({30, 1, -1e-2}), test::about({2, -1, 3}, 13)),
            then(scaling({.5, 2, 1}), translation({1e3, 2e3, -300})))}};
}

/// Rays toward a point of an edge of a random triangle, from near the middle of the ball or from anywhere in
/// it.
std::uint64_t shoot(const Mesh& mesh, const Place& place, std::uint64_t rays, Dice& dice) {
  SceneBuilder b;
  std::vector<Vec3> at;
  for (const Vec3& v : mesh.vertices) at.push_back(place.scale * (v + place.center));
  std::vector<NodeId> triangles;
  for (const auto& f : mesh.faces) {
    const auto first = static_cast<std::size_t>(dice.below(3));  // any corner first, either way round
    const std::size_t step = dice.below(2) ? 1 : 2;
    triangles.push_back(b.triangle(at[f[first]], at[f[(first + step) % 3]], at[f[(first + 2 * step) % 3]]));
  }
  b.show(b.moved(b.list(std::move(triangles)), place.map));
  const auto scene = b.compile();
  const auto world = make_hierarchy(*scene);
  TraceScratch scratch;
  std::vector<NearestQuery> queries(kSpan);
  std::vector<NearestAnswer> answers(kSpan);
  std::vector<OcclusionQuery> shadows(kSpan);
  std::vector<OcclusionAnswer> occluded(kSpan);
  std::uint64_t leaks = 0;
  for (std::uint64_t done = 0; done < rays; done += kSpan) {
    Vec3 origin;
    for (std::size_t i = 0; i < kSpan; ++i) {
      if (i % 256 == 0)
        origin = place.map.point(place.scale * (place.center + dice.uniform(0, .9) * dice.direction()));
      const auto& f = mesh.faces[static_cast<std::size_t>(dice.below(static_cast<int>(mesh.faces.size())))];
      const auto corner = static_cast<std::size_t>(dice.below(3));
      const double part = dice.below(3) == 0 ? 0 : dice.uniform();
      const Vec3 from = at[f[corner]], to = at[f[(corner + 1) % 3]];
      const Vec3 target = place.map.point(from + part * (to - from));
      queries[i] = {};
      queries[i].ray.origin = origin;
      queries[i].ray.direction = normalize(target - origin);
      queries[i].lo = 0;
      queries[i].hi = kFar;
      queries[i].mask = kAnyOpacity;
      answers[i] = {};
      shadows[i] = {};
      shadows[i].ray = queries[i].ray;
      shadows[i].hi = kFar;
      occluded[i] = {};
    }
    world->nearest(queries, answers, scratch);
    world->occluded(shadows, occluded, scratch);
    for (std::size_t i = 0; i < kSpan; ++i) leaks += !answers[i].found || !occluded[i].occluded;
  }
  return leaks;
}

/// At least so many rays for each place, which are worked off side by side.
void run(const std::string& name, int levels, std::uint64_t at_least, std::uint64_t where_slow) {
  constexpr std::uint64_t kSeed = 99;
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  Dice dice(kSeed);
  const Mesh mesh = ball(levels, dice);
  const std::vector<Place> all = places();
  std::vector<std::uint64_t> rays, leaks(all.size());
  for (const Place& place : all) {
    const std::uint64_t count = place.slow ? where_slow : at_least;
    rays.push_back((count + kSpan - 1) / kSpan * kSpan);
  }
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < all.size(); i = next++) {
      Dice own(kSeed + 1 + i);
      leaks[i] = shoot(mesh, all[i], rays[i], own);
      std::printf("%s: %llu rays, %llu leaks\n", all[i].name, static_cast<unsigned long long>(rays[i]),
                  static_cast<unsigned long long>(leaks[i]));
      std::fflush(stdout);
    }
  };
  std::thread other(work);
  work();
  other.join();
  Table table(name, {"mesh", "triangles", "rays", "leaks"});
  for (std::size_t i = 0; i < all.size(); ++i) {
    table.add({all[i].name, format("%zu", mesh.faces.size()),
               format("%llu", static_cast<unsigned long long>(rays[i])),
               format("%llu", static_cast<unsigned long long>(leaks[i]))});
    EXPECT_EQ(leaks[i], 0u) << all[i].name;
  }
}

TEST(LeaksTest, ClosedMeshesHold) { run("leaks-short", 6, 1 << 15, 1 << 15); }

// More than a hundred million rays in all, through two million triangles.
TEST(LeaksTest, DISABLED_ClosedMeshesHoldLong) { run("leaks", 9, scaled_count(25.2e6), scaled_count(1e5)); }

}  // namespace
}  // namespace rayshade::stress
