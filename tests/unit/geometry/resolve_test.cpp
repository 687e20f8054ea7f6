// SPDX-License-Identifier: MIT
// From hits to points, normals and secondary rays: objects.md 1.11, shading.md 3, and the one tolerance (rule
// 8).
#include "rayshade/geometry/resolve.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/unit/geometry/scene_builder.h"

namespace rayshade {
namespace {

using test::Dice;
using test::SceneBuilder;

Hit hit_of(const CompiledScene& scene, const Ray& ray, TraceScratch& scratch) {
  const NearestAnswer answer = test::nearest(*make_hierarchy(scene), ray, scratch, 0);
  EXPECT_TRUE(answer.found);
  return answer.hit;
}

/// objects.md 1.3: outward normals by the inverse transpose, mirrors included.
TEST(Resolve, NormalsGoThroughEveryTransform) {
  SceneBuilder b;
  const auto twice = b.name(
      b.moved(b.list({b.moved(b.sphere(1, {0, 0, 0}), scaling({1, 1.3, -0.7})), b.sphere(1, {50, 0, 0})}),
              test::about({1, 2, 3}, 40)));
  b.show(b.moved(b.object(twice), then(scaling({2, -1, 0.5}), translation({1, 2, 3}))));
  b.show(b.moved(b.object(twice), translation({0, 0, 500})));
  const auto scene = b.compile();
  TraceScratch scratch;
  Dice dice(4);
  const Affine map = then(then(scaling({1, 1.3, -0.7}), test::about({1, 2, 3}, 40)),
                          then(scaling({2, -1, 0.5}), translation({1, 2, 3})));
  const Affine back = *inverse(map);
  for (int i = 0; i < 500; ++i) {
    const Vec3 origin = Vec3{1, 2, 3} + 20 * dice.direction();
    const Ray ray{origin, normalize(Vec3{1, 2, 3} + dice.in_box(0.3) - origin)};
    const Hit hit = hit_of(*scene, ray, scratch);
    ASSERT_EQ(hit.instances.count, 1u);
    const WorldHit world = resolve_world(*scene, hit, ray, scratch);
    EXPECT_LT(length(world.point - ray.at(hit.t())), 1e-12 * 40);
    const Vec3 local = back.point(world.point);
    EXPECT_NEAR(length(local), 1, 1e-13);
    EXPECT_LT(length(world.normal - normalize(back.transposed_vector(local))), 1e-12);
    EXPECT_EQ(world.normal, world.geometric_normal);
    EXPECT_TRUE(world.entering);
    EXPECT_GT(world.error, 0);
    EXPECT_LT(world.error, 1e-12);
    const LocalHit in_primitive = resolve_local(*scene, hit, ray, scratch);
    EXPECT_NEAR(length(in_primitive.ray.direction), 1, 1e-14);
    EXPECT_LT(length(in_primitive.ray.at(in_primitive.t) - in_primitive.point), 1e-11);
    EXPECT_NEAR(length(in_primitive.point), 1, 1e-14);
  }
}

TEST(Resolve, NormalsFaceTheRayAndTellTheWay) {
  SceneBuilder b;
  b.show(b.sphere(1, {0, 0, 0}));
  const auto scene = b.compile();
  TraceScratch scratch;
  const Ray from_outside{{0, 0, 5}, {0, 0, -1}}, from_within{{0, 0, 0}, {0, 0, -1}};
  WorldHit hit = resolve_world(*scene, hit_of(*scene, from_outside, scratch), from_outside, scratch);
  EXPECT_TRUE(hit.entering);
  EXPECT_EQ(hit.normal, (Vec3{0, 0, 1}));
  hit = resolve_world(*scene, hit_of(*scene, from_within, scratch), from_within, scratch);
  EXPECT_FALSE(hit.entering);
  EXPECT_EQ(hit.normal, (Vec3{0, 0, 1}));
}

/// objects.md 1.11 step 3: where shading and geometric normal disagree about the side, the facet decides.
TEST(Resolve, TheFacetDecidesOnSmoothTriangles) {
  SceneBuilder b;
  const Vec3 p[3] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  const Vec3 n[3] = {{0, 1, 0.2}, {0, 1, 0.2}, {0, 1, 0.2}};
  b.show(b.smooth_triangle(p, n));
  const auto scene = b.compile();
  TraceScratch scratch;
  const Vec3 shading = normalize(Vec3{0, 1, 0.2});
  // From above (g.d < 0) although the shading normal looks away; and from below, likewise.
  for (const double side : {1.0, -1.0}) {
    const Vec3 direction = normalize(Vec3{0, side, -0.4 * side});
    const Ray ray{-3 * direction, direction};
    const LocalHit hit = resolve_local(*scene, hit_of(*scene, ray, scratch), ray, scratch);
    EXPECT_TRUE(hit.smooth);
    EXPECT_GT(side * dot(direction, shading), 0);
    EXPECT_EQ(hit.entering, side > 0);
    EXPECT_LT(length(hit.normal - side * shading), 1e-15);
    EXPECT_EQ(hit.geometric_normal, (Vec3{0, 0, side}));
  }
}

/// The flag of CSG overrides the way, never the flipping.
TEST(Resolve, CsgOverridesTheWay) {
  SceneBuilder b;
  b.show(b.difference({b.box({-1, -1, -1}, {1, 1, 1}), b.sphere(0.5, {0, 0, 0})}));
  const auto scene = b.compile();
  TraceScratch scratch;
  const Ray ray{{0, 0, 0.75}, {0, 0, -1}};  // from within the wall into the hole
  const Hit hit = hit_of(*scene, ray, scratch);
  EXPECT_EQ(hit.t(), 0.25);
  const LocalHit local = resolve_local(*scene, hit, ray, scratch);
  EXPECT_FALSE(local.entering);
  EXPECT_EQ(local.normal, (Vec3{0, 0, 1}));
}

TEST(Resolve, PathWalkGoesOutward) {
  SceneBuilder b;
  const NodeId ball = b.textured(b.moved(b.sphere(1, {0, 0, 0}), translation({1, 0, 0})));
  const auto twice = b.name(b.moved(b.list({ball, b.sphere(1, {50, 0, 0})}), scaling({2, 2, 2})));
  Surface surface;
  b.show(b.surfaced(b.list({b.turning(b.textured(b.object(twice)), {0, 0, 1}, 90)}), surface));
  b.show(b.moved(b.object(twice), translation({0, 0, 500})));
  CompileOptions options;
  options.shutter = {0, 1};
  const auto scene = b.compile(options);
  TraceScratch scratch;
  Ray ray{{0, 2, 9}, {0, 0, -1}};
  ray.time = 1;
  const Hit hit = hit_of(*scene, ray, scratch);
  EXPECT_TRUE(has_textures(*scene, hit));
  PathWalk walk(*scene, hit, ray.time, scratch);
  PathLevel level;
  Vec3 p{0, 0, 1};
  ASSERT_TRUE(walk.next(level));  // the sphere
  EXPECT_TRUE(level.textures);
  EXPECT_EQ(level.surface, kNone);
  p = level.map->forward.point(p);
  ASSERT_TRUE(walk.next(level));  // the named list
  EXPECT_FALSE(level.textures);
  p = level.map->forward.point(p);
  EXPECT_EQ(p, (Vec3{2, 0, 2}));
  ASSERT_TRUE(walk.next(level));  // the object
  EXPECT_TRUE(level.textures);
  EXPECT_EQ(level.texture_list, 1u);
  p = level.map->forward.point(p);
  EXPECT_LT(length(p - Vec3{0, 2, 2}), 1e-15);
  ASSERT_TRUE(walk.next(level));  // the list around it
  EXPECT_FALSE(level.map);
  EXPECT_EQ(level.surface, 0u);
  EXPECT_FALSE(walk.next(level));
  EXPECT_FALSE(walk.next(level));
}

TEST(Resolve, ExtentsInTheWorld) {
  SceneBuilder b;
  const auto twice =
      b.name(b.list({b.moved(b.sphere(1, {0, 0, 0}), scaling({3, 1, 1})), b.sphere(1, {50, 0, 0})}));
  b.show(b.moved(b.object(twice), scaling({0.5, 0.5, 0.5})));
  b.show(b.moved(b.object(twice), translation({0, 0, 100})));
  b.show(b.plane({0, 0, -5}, {0, 0, 1}));
  const auto scene = b.compile();
  TraceScratch scratch;
  EXPECT_NEAR(world_extent(*scene, hit_of(*scene, {{0, 0, 9}, {0, 0, -1}}, scratch)), 3, 1e-12);
  EXPECT_NEAR(world_extent(*scene, hit_of(*scene, {{0, 0, 109}, {0, 0, -1}}, scratch)), 6, 1e-12);
  EXPECT_NEAR(world_extent(*scene, hit_of(*scene, {{900, 0, 9}, {0, 0, -1}}, scratch)), scene->scale, 1e-12);
  EXPECT_NEAR(scene->scale, 102.5, 2);
}

TEST(SecondaryStart, TheOriginalsToleranceAtUsualSizes) {
  WorldHit hit;
  hit.geometric_normal = hit.normal = {0, 0, 1};
  hit.error = 1e-15;
  EXPECT_EQ(secondary_start(hit, {0, 0, 1}, 3, false).lo, kEpsilon);
  EXPECT_EQ(secondary_start(hit, {0, 0, 1}, 3, true).lo, 4 * kEpsilon);
  EXPECT_EQ(secondary_start(hit, {0, 0, 1}, 0.01, true).lo, 4 * kEpsilon * 0.01);
  EXPECT_GT(secondary_start(hit, {0, 0, 1}, 3, false).origin.z, 0);
  EXPECT_LT(secondary_start(hit, {0, 0.6, -0.8}, 3, false).origin.z, 0);
  EXPECT_LT(length(secondary_start(hit, {0, 0.6, -0.8}, 3, false).origin), 1e-14);
  hit.point = {1e9, 0, 0};
  EXPECT_GT(secondary_start(hit, {0, 0, 1}, 1e-3, false).lo, 1e-7);
}

/// A shape of unit size, built at a size and a place, by its own numbers or under a transform.
struct Model {
  const char* name;
  bool convex;  ///< from outside
  bool closed;
  std::function<NodeId(SceneBuilder&, double, const Vec3&)> make;
};

const std::vector<Model>& models() {
  const auto at = [](double s, const Vec3& c, const Vec3& p) { return c + s * p; };
  static const std::vector<Model> all{
      {"sphere", true, true, [](SceneBuilder& b, double s, const Vec3& c) { return b.sphere(s, c); }},
      {"box", true, true,
       [=](SceneBuilder& b, double s, const Vec3& c) {
         return b.box(at(s, c, {-1, -0.5, -0.75}), at(s, c, {1, 1, 0.5}));
       }},
      {"cylinder", true, false,
       [=](SceneBuilder& b, double s, const Vec3& c) {
         return b.cylinder(0.5 * s, at(s, c, {-0.5, -0.25, -1}), at(s, c, {0.5, 0.25, 1}));
       }},
      {"cone", true, false,
       [=](SceneBuilder& b, double s, const Vec3& c) {
         return b.cone(s, at(s, c, {0, -0.25, -1}), 0.25 * s, at(s, c, {0.5, 0.25, 1}));
       }},
      {"torus", false, true,
       [](SceneBuilder& b, double s, const Vec3& c) {
         return b.torus(s, 0.4 * s, c, {0.1, 0.2, 1});
       }},
      {"triangle", true, false,
       [=](SceneBuilder& b, double s, const Vec3& c) {
         return b.triangle(at(s, c, {-1, -1, 0}), at(s, c, {1, -1, 0.3}), at(s, c, {0, 1, 0.1}));
       }},
      {"polygon", true, false,
       [=](SceneBuilder& b, double s, const Vec3& c) {
         return b.polygon(
             {at(s, c, {-1, -1, 0}), at(s, c, {1, -1, 0}), at(s, c, {1, 1, 0}), at(s, c, {0, 0.2, 0})});
       }},
      {"disc", true, false,
       [](SceneBuilder& b, double s, const Vec3& c) {
         return b.disc(s, c, {0.3, 0.2, 1});
       }},
      {"plane", true, false,
       [](SceneBuilder& b, double, const Vec3& c) {
         return b.plane(c, {0.3, 0.2, 1});
       }},
      {"blob", false, true,
       [=](SceneBuilder& b, double s, const Vec3& c) {
         return b.blob(0.4, {{1, s, at(s, c, {-0.4, 0, 0})}, {1.5, 0.8 * s, at(s, c, {0.5, 0.1, 0.2})}});
       }},
  };
  return all;
}

/// Rays that leave a point of the surface outward do not meet it again there, and rays that enter find the
/// far side: at any size, any number of sizes away from the origin, with any direction.
void check_starts(const Model& model, const CompiledScene& scene, double size, const Vec3& place,
                  double condition, Dice& dice) {
  TraceScratch scratch;
  const auto intersector = make_hierarchy(scene);
  int hits = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 origin = place + size * dice.uniform(2, 40) * dice.direction();
    const Ray ray{origin, normalize(place + size * dice.in_box(condition > 1 ? 0.1 : 1) - origin)};
    const NearestAnswer answer = test::nearest(*intersector, ray, scratch, 0);
    if (!answer.found) continue;
    ++hits;
    const WorldHit hit = resolve_world(scene, answer.hit, ray, scratch);
    const double extent = world_extent(scene, answer.hit);
    // A bound on errors that is no use would hide everything: it must be a few units in the last place
    // times the condition of the transforms.
    ASSERT_LT(hit.error, 1e-9 * size + 100 * condition * 1e-16 * max_abs(hit.point)) << model.name;
    for (const bool shadow : {false, true}) {
      Vec3 direction = dice.direction();
      if (i % 3 == 0) {  // nearly along the surface
        direction = normalize(direction - (1 - dice.uniform(0, 1e-3)) * dot(direction, hit.geometric_normal) *
                                              hit.geometric_normal);
      }
      if (dot(direction, hit.geometric_normal) < 0) direction = -direction;
      const double steepness = dot(direction, hit.geometric_normal);
      RayStart start = secondary_start(hit, direction, extent, shadow);
      NearestAnswer next = test::nearest(*intersector, {start.origin, direction}, scratch, start.lo);
      if (model.convex && hit.entering) {
        ASSERT_FALSE(next.found) << model.name << ": meets itself after " << next.hit.t() / size << " at "
                                 << steepness;
      } else if (!model.convex && next.found && steepness > 0.1) {
        ASSERT_GT(next.hit.t(), 0.01 * size) << model.name << ": meets itself at " << steepness;
      }
      if (!model.closed || steepness < 0.05) continue;
      start = secondary_start(hit, -direction, extent, shadow);
      next = test::nearest(*intersector, {start.origin, -direction}, scratch, start.lo);
      // The chord of a steep ray through a rounded edge may still be short, but then it is nearly the limit
      // itself.
      if (!next.found) {
        const NearestAnswer all = test::nearest(*intersector, {start.origin, -direction}, scratch, 0);
        ASSERT_TRUE(all.found) << model.name << ": leaks at " << steepness;
        ASSERT_LE(all.hit.t(), start.lo) << model.name;
        continue;
      }
      const Ray within{start.origin, -direction};
      ASSERT_FALSE(resolve_world(scene, next.hit, within, scratch).entering)
          << model.name << " at " << steepness;
    }
  }
  EXPECT_GT(hits, 5) << model.name;
}

TEST(SecondaryStart, NeitherAcneNorLeaksAtAnySizeAndPlace) {
  constexpr std::uint64_t kSeed = 99;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  Dice dice(kSeed);
  for (const Model& model : models()) {
    for (const double size : {1e-6, 1e-3, 1.0, 1e3, 1e6}) {
      for (const double sizes_away : {0.0, 1.0, 1e3, 1e6}) {
        const Vec3 place = size * sizes_away * Vec3{1, -0.6, 0.3};
        SCOPED_TRACE(testing::Message() << model.name << ", size " << size << ", place " << place.x);
        SceneBuilder plain;
        plain.show(model.make(plain, size, place));
        check_starts(model, *plain.compile(), size, place, 1, dice);
        if (testing::Test::HasFatalFailure()) return;
        SceneBuilder moved;
        const NodeId node = model.make(moved, 1, {0, 0, 0});
        moved.moved(
            node, then(test::about({1, 1, 0.3}, 70), then(scaling({size, size, size}), translation(place))));
        moved.show(node);
        check_starts(model, *moved.compile(), size, place, 1, dice);
        if (testing::Test::HasFatalFailure()) return;
        if (!model.convex) continue;
        SceneBuilder flattened;
        const NodeId flat = model.make(flattened, 1, {0, 0, 0});
        flattened.moved(flat, then(scaling({size, 0.01 * size, 0.3 * size}),
                                   then(test::about({1, 1, 0.3}, 70), translation(place))));
        flattened.show(flat);
        check_starts(model, *flattened.compile(), size, place, 100, dice);
        if (testing::Test::HasFatalFailure()) return;
      }
    }
  }
}

/// A height field under a scale: rays that leave it upward are free.
TEST(SecondaryStart, HeightFields) {
  Dice dice(8);
  std::vector<float> altitudes;
  for (int i = 0; i < 33 * 33; ++i) altitudes.push_back(static_cast<float>(0.002 * dice.uniform()));
  for (const double size : {1e-6, 1.0, 1e6}) {
    for (const double sizes_away : {0.0, 1e3, 1e6}) {
      SceneBuilder b;
      b.files.add("field", test::height_field_bytes(33, altitudes));
      const Vec3 place = size * sizes_away * Vec3{1, -0.6, 0.3};
      b.show(b.moved(b.height_field("field"), then(scaling({size, size, size}), translation(place))));
      const auto scene = b.compile();
      const auto intersector = make_hierarchy(*scene);
      TraceScratch scratch;
      for (int i = 0; i < 300; ++i) {
        const Vec3 target = place + size * Vec3{dice.uniform(0.05, 0.95), dice.uniform(0.05, 0.95), 0};
        const Vec3 origin = place + size * Vec3{dice.uniform(-3, 3), dice.uniform(-3, 3), 2};
        const Ray ray{origin, normalize(target - origin)};
        const NearestAnswer answer = test::nearest(*intersector, ray, scratch, 0);
        ASSERT_TRUE(answer.found) << size << ' ' << sizes_away;
        const WorldHit hit = resolve_world(*scene, answer.hit, ray, scratch);
        ASSERT_GT(hit.normal.z, 0);
        const Vec3 up = normalize(Vec3{dice.uniform(-1, 1), dice.uniform(-1, 1), dice.uniform(0.5, 1)});
        const RayStart start = secondary_start(hit, up, world_extent(*scene, answer.hit), true);
        EXPECT_FALSE(test::nearest(*intersector, {start.origin, up}, scratch, start.lo).found)
            << size << sizes_away;
        const RayStart below = secondary_start(hit, -up, world_extent(*scene, answer.hit), true);
        EXPECT_FALSE(test::nearest(*intersector, {below.origin, -up}, scratch, below.lo).found)
            << size << sizes_away;
      }
    }
  }
}

}  // namespace
}  // namespace rayshade
