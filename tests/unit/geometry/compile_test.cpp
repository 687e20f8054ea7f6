// SPDX-License-Identifier: MIT
// Flattening: what is inlined and what is shared, surfaces and opacity through instances, deep and
// exponential structures, memory, motion.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rayshade/geometry/resolve.h"
#include "tests/unit/geometry/scene_builder.h"

namespace rayshade {
namespace {

using test::SceneBuilder;
using testing::HasSubstr;

const Ray kDown{{0.1, 0.2, 50}, {0, 0, -1}};

NearestAnswer trace(const CompiledScene& scene, const Ray& ray, double lo = kEpsilon) {
  TraceScratch scratch;
  const NearestAnswer answer = test::nearest(*make_hierarchy(scene), ray, scratch, lo);
  const NearestAnswer oracle = test::nearest(*make_brute_force(scene), ray, scratch, lo);
  EXPECT_EQ(answer.found, oracle.found);
  EXPECT_TRUE(!answer.found || answer.hit.t() == oracle.hit.t());
  return answer;
}

TEST(Compile, ListsAndObjectsUsedOnceVanish) {
  SceneBuilder b;
  const auto once =
      b.name(b.moved(b.list({b.sphere(1, {0, 0, 0}), b.sphere(1, {3, 0, 0})}), translation({0, 0, 1})));
  b.show(b.moved(b.grid({b.moved(b.object(once), scaling({2, 2, 2}))}), translation({5, 0, 0})));
  b.name(b.height_field("never read"));
  const auto scene = b.compile();
  EXPECT_EQ(scene->groups.size(), 1u);
  EXPECT_EQ(scene->leaves.size(), 2u);
  EXPECT_EQ(scene->instances.size(), 0u);
  EXPECT_EQ(scene->counts.primitives, 2u);
  EXPECT_EQ(scene->counts.unused_objects, 1u);
  // Both leaves share one placement: translate, scale, translate, innermost first.
  EXPECT_EQ(scene->leaves[0].placement, scene->leaves[1].placement);
  const Affine& map = scene->placements[scene->leaves[0].placement].map.forward;
  EXPECT_EQ(map.point({0, 0, 0}), (Vec3{5, 0, 2}));
  EXPECT_EQ(map.point({1, 1, 1}), (Vec3{7, 2, 4}));
  EXPECT_NEAR(scene->leaf_extent(0), 4, 1e-12);
}

TEST(Compile, ObjectsUsedAgainAreSharedUnlessTheyAreOnePrimitive) {
  SceneBuilder b;
  const auto ball = b.name(b.sphere(1, {0, 0, 0}));
  const auto pair = b.name(b.list({b.sphere(1, {0, 0, 0}), b.sphere(1, {0, 3, 0})}));
  for (int i = 0; i < 5; ++i) {
    b.show(b.moved(b.object(ball), translation({10.0 * i, 0, 0})));
    b.show(b.moved(b.object(pair), translation({10.0 * i, 40, 0})));
  }
  const auto scene = b.compile();
  EXPECT_EQ(scene->counts.shared_groups, 1u);
  EXPECT_EQ(scene->groups.size(), 2u);
  EXPECT_EQ(scene->leaves.size(), 12u);
  EXPECT_EQ(scene->spheres.size(), 3u);
  EXPECT_EQ(scene->counts.primitives, 15u);
  EXPECT_EQ(scene->groups[0].order_span, 15u);
  const NearestAnswer answer = trace(*scene, {{20, 43, 9}, {0, 0, -1}});
  ASSERT_TRUE(answer.found);
  EXPECT_EQ(answer.hit.t(), 8);
  EXPECT_EQ(answer.hit.instances.count, 1u);
}

/// As long as their boxes remain boxes, or as they are CSG, which is one leaf with one box.
TEST(Compile, SmallObjectsUsedAgainAreCopied) {
  SceneBuilder b;
  const auto pair = b.name(b.list({b.sphere(1, {0, 0, 0}), b.sphere(1, {0, 3, 0})}));
  const auto hollow = b.name(b.difference({b.box({-1, -1, -1}, {1, 1, 1}), b.sphere(.9, {0, 0, .5})}));
  const auto large = b.name(b.list({b.object(pair), b.object(hollow), b.sphere(9, {0, 0, -20})}));
  b.show(b.object(pair));
  b.show(b.moved(b.object(pair), then(scaling({1, -2, 3}), translation({10, 0, 0}))));
  b.show(b.moved(b.object(pair), then(test::about({0, 0, 1}, 90), translation({20, 0, 0}))));
  b.show(b.moved(b.object(pair), then(test::about({0, 0, 1}, 30), translation({30, 0, 0}))));
  b.show(b.moved(b.object(hollow), then(test::about({0, 0, 1}, 30), translation({40, 0, 0}))));
  b.show(b.moved(b.object(large), translation({50, 0, 0})));
  b.show(b.moved(b.object(large), translation({70, 0, 0})));
  const auto copied = b.compile(CompileOptions{}), few = b.compile(test::at_most_copies(9)),
             shared = b.compile();
  EXPECT_EQ(copied->counts.shared_groups, 1u);  // at 30 degrees
  EXPECT_EQ(copied->instances.size(), 1u);
  EXPECT_EQ(few->counts.shared_groups, 2u);  // five of two primitives, and two of five
  EXPECT_EQ(shared->counts.shared_groups, 3u);
  EXPECT_EQ(copied->groups[0].order_span, 17u);
  EXPECT_EQ(shared->groups[0].order_span, 17u);
  test::Dice dice(5);
  TraceScratch scratch, other;
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 origin = Vec3{40, 0, 0} + 80 * dice.direction();
    const Vec3 target{dice.uniform(-2, 80), dice.uniform(-3, 4), dice.uniform(-3, 3)};
    const Ray ray{origin, normalize(target - origin)};
    const NearestAnswer truth = trace(*shared, ray);
    for (const CompiledScene* scene : {copied.get(), few.get()}) {
      const NearestAnswer answer = trace(*scene, ray);
      ASSERT_EQ(answer.found, truth.found);
      if (!truth.found) continue;
      ++hits;
      EXPECT_NEAR(answer.hit.t(), truth.hit.t(), 1e-11);
      const WorldHit p = resolve_world(*scene, answer.hit, ray, scratch),
                     q = resolve_world(*shared, truth.hit, ray, other);
      EXPECT_LT(length(p.normal - q.normal), 1e-9);
      EXPECT_EQ(p.entering, q.entering);
    }
  }
  EXPECT_GT(hits, 500);
}

/// However many small objects there are, their copies stay few.
TEST(Compile, CopiesOfAllObjectsAreLimited) {
  SceneBuilder b;
  for (int object = 0; object < 20; ++object) {
    std::vector<NodeId> members;
    for (int i = 0; i < 500; ++i) members.push_back(b.sphere(.1, {1.0 * i, 1.0 * object, 0}));
    const auto name = b.name(b.list(members));
    for (int use = 0; use < 8; ++use) b.show(b.moved(b.object(name), translation({0, 0, 1.0 * use})));
  }
  const auto scene = b.compile(CompileOptions{});
  EXPECT_EQ(scene->counts.shared_groups, 4u);
  EXPECT_EQ(scene->groups[0].count, 16u * 8 * 500 + 4u * 8);
}

/// The same scene written with shared objects and written out gives the same hits, normals and surfaces.
TEST(Compile, SharedAndWrittenOutAreTheSame) {
  const auto make = [](SceneBuilder& b, int copies) {
    std::vector<std::uint32_t> names;
    for (int copy = 0; copy < copies; ++copy) {
      names.push_back(b.name(
          b.moved(b.list({b.sphere(1, {0, 0, 0}), b.torus(1.5, 0.25, {0, 0, 0}, {0, 0, 1}),
                          b.disc(2, {0, 0, -1}, {0, 0, 1}),
                          b.difference({b.box({-1, -1, 0}, {0, 0, 1.25}), b.sphere(0.5, {-0.5, -0.5, 1})})}),
                  scaling({1, 1.5, 0.75}))));
    }
    for (int i = 0; i < 6; ++i) {
      b.show(b.moved(b.object(names[static_cast<std::size_t>(i % copies)]),
                     then(test::about({1, 2, 3}, 50.0 * i), translation({3.0 * i, 0, 0}))));
    }
  };
  SceneBuilder shared, written;
  make(shared, 1);
  make(written, 6);
  const auto a = shared.compile(), b = written.compile();
  EXPECT_EQ(a->counts.shared_groups, 1u);
  EXPECT_EQ(b->counts.shared_groups, 0u);
  TraceScratch scratch_a, scratch_b;
  test::Dice dice(3);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 origin = 30 * dice.direction();
    const Ray ray{origin,
                  normalize(Vec3{dice.uniform(-2, 18), dice.uniform(-2, 2), dice.uniform(-2, 2)} - origin)};
    const NearestAnswer x = trace(*a, ray), y = trace(*b, ray);
    ASSERT_EQ(x.found, y.found);
    if (!x.found) continue;
    ++hits;
    EXPECT_NEAR(x.hit.t(), y.hit.t(), 1e-9);
    const WorldHit p = resolve_world(*a, x.hit, ray, scratch_a), q = resolve_world(*b, y.hit, ray, scratch_b);
    EXPECT_LT(length(p.point - q.point), 1e-9);
    EXPECT_LT(length(p.normal - q.normal), 1e-6);
    EXPECT_EQ(p.entering, q.entering);
  }
  EXPECT_GT(hits, 500);
}

TEST(Compile, SurfacesComeFromTheInnermostNode) {
  SceneBuilder b;
  const auto colored = [](double r) {
    Surface s;
    s.diffuse = {r, 0, 0};
    return s;
  };
  const auto seen = [&](double x) {
    const auto scene = b.compile();
    const NearestAnswer answer = trace(*scene, {{x, 0, 9}, {0, 0, -1}});
    return answer.found ? surface_of(*scene, answer.hit).diffuse.r : -1;
  };
  const auto pair = b.name(b.list({b.surfaced(b.sphere(1, {0, 0, 0}), colored(1)), b.sphere(1, {5, 0, 0})}));
  b.show(b.surfaced(b.object(pair), colored(2)));
  b.show(b.moved(b.object(pair), translation({20, 0, 0})));
  b.show(b.surfaced(b.list({b.list({b.moved(b.object(pair), translation({40, 0, 0}))})}), colored(3)));
  EXPECT_EQ(seen(0), 1);
  EXPECT_EQ(seen(5), 2);
  EXPECT_EQ(seen(20), 1);
  EXPECT_EQ(seen(25), default_surface().diffuse.r);
  EXPECT_EQ(seen(40), 1);
  EXPECT_EQ(seen(45), 3);
}

TEST(Compile, OpacityFollowsTheSurfaceAroundAnInstance) {
  SceneBuilder b;
  const auto pair = b.name(b.list({b.sphere(1, {0, 0, 0}), b.sphere(1, {5, 0, 0})}));
  const auto fixed =
      b.name(b.list({b.transparent(b.sphere(1, {0, 9, 0}), 0), b.transparent(b.sphere(1, {5, 9, 0}))}));
  b.show(b.transparent(b.object(pair)));
  b.show(b.moved(b.object(pair), translation({20, 0, 0})));
  b.show(b.transparent(b.object(fixed)));
  b.show(b.moved(b.object(fixed), translation({20, 0, 0})));
  const auto scene = b.compile();
  EXPECT_TRUE(scene->has_transparent);
  EXPECT_EQ(scene->counts.shared_groups, 3u) << "two variants of the one, one of the other";
  const auto blocks = [&](double x, double y, Opacity mask) {
    TraceScratch scratch;
    const bool brute =
        test::occluded(*make_brute_force(*scene), {{x, y, 9}, {0, 0, -1}}, scratch, 0, 50, mask);
    EXPECT_EQ(test::occluded(*make_hierarchy(*scene), {{x, y, 9}, {0, 0, -1}}, scratch, 0, 50, mask), brute);
    return brute;
  };
  EXPECT_FALSE(blocks(0, 0, kOpaque));
  EXPECT_TRUE(blocks(0, 0, kTransparent));
  EXPECT_TRUE(blocks(0, 0, kAnyOpacity));
  EXPECT_TRUE(blocks(20, 0, kOpaque));
  EXPECT_TRUE(blocks(0, 9, kOpaque));
  EXPECT_FALSE(blocks(5, 9, kOpaque));
  EXPECT_TRUE(blocks(20, 9, kOpaque));
  EXPECT_FALSE(blocks(25, 9, kOpaque));
}

TEST(Compile, MixedCsgIsNeverCertainlyOpaque) {
  SceneBuilder b;
  b.show(b.unite({b.transparent(b.sphere(1, {0, 0, 0})), b.sphere(1, {5, 0, 0})}));
  const auto scene = b.compile();
  TraceScratch scratch;
  EXPECT_EQ(scene->leaves[scene->groups[0].first].opacity, kAnyOpacity);
  EXPECT_FALSE(test::occluded(*make_hierarchy(*scene), {{5, 0, 9}, {0, 0, -1}}, scratch, 0, 50, kOpaque));
  EXPECT_TRUE(test::occluded(*make_hierarchy(*scene), {{5, 0, 9}, {0, 0, -1}}, scratch, 0, 50, kAnyOpacity));
}

/// objects.md 6.8: a plane among bounded members is not clipped to their box.
TEST(Compile, MixedAggregatesAreUnbounded) {
  for (const int kind : {0, 1, 2, 3, 4}) {
    SceneBuilder b;
    const NodeId plane = b.plane({0, 0, 0}, {0, 0, 1}), ball = b.sphere(1, {0, 0, 0});
    if (kind == 0) b.show(b.list({plane, ball}));
    if (kind == 1) b.show(b.grid({ball, plane}));
    if (kind == 2) b.show(b.unite({plane, ball}));
    if (kind >= 3) {
      const auto mixed = b.name(b.list({plane, b.list({ball})}));
      b.show(b.moved(b.object(mixed), translation({0, 0, 0})));
      b.show(kind == 3 ? b.moved(b.object(mixed), translation({0, 0, -9}))
                       : b.difference({b.object(mixed), b.sphere(0.1, {0, 0, 5})}));
    }
    for (int i = 0; i < 10; ++i) b.show(b.sphere(0.5, {0, 0, -20.0 - i}));
    const auto scene = b.compile();
    const NearestAnswer answer = trace(*scene, {{1000, 1000, 3}, {0, 0, -1}});
    ASSERT_TRUE(answer.found) << kind;
    EXPECT_EQ(answer.hit.t(), 3);
  }
}

TEST(Compile, EmptyAndSingleAggregates) {
  SceneBuilder b;
  b.show(b.list({}));
  b.show(b.unite({}));
  b.show(b.difference({b.sphere(1, {0, 0, 0})}));
  b.show(b.difference({b.sphere(1, {9, 0, 0}), b.list({})}));
  b.show(b.difference({b.list({}), b.sphere(1, {18, 0, 0})}));
  const auto nothing = b.name(b.list({b.list({})}));
  b.show(b.object(nothing));
  b.show(b.object(nothing));
  const auto scene = b.compile();
  const NearestAnswer alone = trace(*scene, {{0, 0, 9}, {0, 0, -1}});
  ASSERT_TRUE(alone.found);
  EXPECT_EQ(alone.hit.flag, EnterFlag::kUnset);
  EXPECT_TRUE(trace(*scene, {{9, 0, 9}, {0, 0, -1}}).found);
  EXPECT_FALSE(trace(*scene, {{18, 0, 9}, {0, 0, -1}}).found);
  SceneBuilder none;
  const auto empty = none.compile();
  EXPECT_FALSE(trace(*empty, kDown).found);
  EXPECT_EQ(empty->scale, 1);
  EXPECT_EQ(empty->counts.primitives, 0u);
}

TEST(Compile, TenThousandLevelsOfLists) {
  SceneBuilder b;
  NodeId node = b.sphere(1, {0, 0, 0});
  for (int level = 0; level < 10'000; ++level) {
    node = b.list({node});
    if (level % 100 == 0) b.moved(node, translation({0, 0, 0.125}));
    if (level == 5000) b.transparent(node);
    if (level % 1000 == 999) node = b.object(b.name(node));
  }
  b.show(node);
  const auto scene = b.compile();
  const NearestAnswer answer = trace(*scene, kDown);
  ASSERT_TRUE(answer.found);
  EXPECT_NEAR(answer.hit.t(), 50 - 12.5 - std::sqrt(0.95), 1e-9);
  EXPECT_EQ(surface_of(*scene, answer.hit).transparency, 1);
  TraceScratch scratch;
  PathWalk walk(*scene, answer.hit, 0, scratch);
  PathLevel level;
  int levels = 0, maps = 0;
  while (walk.next(level)) {
    ++levels;
    maps += level.map != nullptr;
  }
  EXPECT_EQ(maps, 100);
  EXPECT_EQ(levels, 101);  // the sphere itself, and those with a transform, one of which has the surface
}

TEST(Compile, DeepCsgIsRefusedNotACrash) {
  SceneBuilder b;
  NodeId node = b.sphere(1, {0, 0, 0});
  for (std::uint32_t level = 0; level < 10'000; ++level) {
    node = b.at(b.difference({node, b.sphere(0.001, {0, 0, 5.0 + level})}), 10'000 - level);
  }
  b.show(node);
  try {
    b.compile();
    FAIL() << "compiled";
  } catch (const CompileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("nested too deeply"));
    EXPECT_GT(error.location.line, 0u);
    EXPECT_LT(error.location.line, 1000u);
  }
}

TEST(Compile, HundredsOfCsgLevelsWork) {
  SceneBuilder b;
  NodeId node = b.sphere(1, {0, 0, 0});
  for (int level = 0; level < 390; ++level) node = b.unite({node, b.sphere(1, {0, 0, -0.01 * level})});
  b.show(node);
  const auto scene = b.compile();
  EXPECT_NEAR(trace(*scene, {{0, 0, 9}, {0, 0, -1}}).hit.t(), 8, 1e-12);
}

/// A list of two of a list of two of ...: shared, never written out.
TEST(Compile, DoublingTakesNoTimeAndMemory) {
  const auto doubled = [](int levels) {
    auto b = std::make_unique<SceneBuilder>();
    NodeId node = b->list({b->sphere(0.25, {0, 0, 0}), b->sphere(0.25, {0, 0, 1})});
    for (int level = 0; level < levels; ++level) {
      const auto name = b->name(node);
      node = b->list(
          {b->object(name), b->at(b->moved(b->object(name), translation({std::ldexp(1, level), 0, 0})),
                                  static_cast<std::uint32_t>(level + 1))});
    }
    b->show(node);
    return b;
  };
  const auto b = doubled(31);
  const auto scene = b->compile();
  EXPECT_EQ(scene->counts.primitives, std::uint64_t{1} << 32);
  EXPECT_EQ(scene->groups[0].order_span, std::uint64_t{1} << 32);
  EXPECT_LT(scene->counts.bytes, 100'000u);
  EXPECT_LT(b->compile(CompileOptions{})->counts.bytes, 2'000'000u);
  TraceScratch scratch;
  const NearestAnswer answer = test::nearest(*make_hierarchy(*scene), {{1234567, 0, 9}, {0, 0, -1}}, scratch);
  ASSERT_TRUE(answer.found);
  EXPECT_EQ(answer.hit.t(), 9 - 1.25);
  EXPECT_EQ(answer.hit.instances.count, 31u);
  EXPECT_EQ(resolve_world(*scene, answer.hit, {{1234567, 0, 9}, {0, 0, -1}}, scratch).point,
            (Vec3{1234567, 0, 1.25}));

  try {
    doubled(40)->compile();
    FAIL() << "compiled";
  } catch (const CompileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("32 deep"));
    EXPECT_EQ(error.location.line, 33u);
  }
}

TEST(Compile, MemoryOfFlatTriangles) {
  SceneBuilder b;
  Surface surface;
  b.scene.surfaces.push_back(surface);
  constexpr int kSide = 300;
  std::vector<NodeId> mesh;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const auto at = [](int i, int j) { return Vec3{0.1 * i, 0.1 * j, 0.01 * ((i * 7 + j * 5) % 11)}; };
      mesh.push_back(b.triangle(at(x, y), at(x + 1, y), at(x, y + 1)));
      b.scene.nodes[mesh.back()].surface = 0;
    }
  }
  b.show(b.moved(b.list(mesh), scaling({2, 2, 2})));
  const auto scene = b.compile();
  EXPECT_EQ(scene->path_nodes.size(), 2u);
  EXPECT_EQ(scene->placements.size(), 1u);
  EXPECT_LE(static_cast<double>(scene->counts.bytes) / (kSide * kSide), 150);
  ASSERT_TRUE(scene->groups[0].hierarchy);
  EXPECT_TRUE(trace(*scene, {{2.05, 2.05, 9}, {0, 0, -1}}).found);
}

TEST(Compile, HeightFieldsAreReadOnceAndBlamedWhereTheyAreNamed) {
  struct CountingProvider : Provider {
    int reads = 0;
    Bytes read(const std::string& name) override {
      ++reads;
      if (name == "missing") throw ProviderError("No such file or directory");
      if (name == "short") return std::make_shared<const std::string>("\4\0\0\0", 4);
      return std::make_shared<const std::string>(test::height_field_bytes(2, {0, 0, 0, 0}));
    }
  };
  CountingProvider provider;
  SceneBuilder b;
  b.show(b.height_field("field"));
  b.show(b.moved(b.height_field("field"), translation({5, 0, 0})));
  const auto scene = compile_scene(b.scene, provider, {});
  EXPECT_EQ(provider.reads, 1);
  EXPECT_TRUE(trace(*scene, {{5.5, 0.5, 9}, {0, 0, -1}}).found);
  for (const char* name : {"missing", "short"}) {
    SceneBuilder bad;
    bad.show(bad.height_field(name, {7, 3, 0}));
    try {
      compile_scene(bad.scene, provider, {});
      FAIL() << name;
    } catch (const CompileError& error) {
      EXPECT_THAT(error.what(), HasSubstr(name));
      EXPECT_EQ(error.location, (Location{7, 3, 0}));
    }
  }
}

TEST(Compile, FlippedNormals) {
  SceneBuilder b;
  b.show(b.triangle({-1, -1, 0}, {1, -1, 0}, {0, 1, 0}));
  b.show(b.polygon({{9, -1, 0}, {11, -1, 0}, {10, 1, 0}}));
  TraceScratch scratch;
  for (const bool flip : {false, true}) {
    CompileOptions options;
    options.flip_normals = flip;
    const auto scene = b.compile(options);
    for (const double x : {0.0, 10.0}) {
      const Ray ray{{x, 0, 5}, {0, 0, -1}};
      EXPECT_EQ(resolve_local(*scene, trace(*scene, ray).hit, ray, scratch).entering, !flip);
    }
  }
}

TEST(Compile, SingularTransformsAreAnError) {
  SceneBuilder b;
  b.show(b.at(b.moved(b.sphere(1, {0, 0, 0}), scaling({1, 0, 1})), 12));
  try {
    b.compile();
    FAIL() << "compiled";
  } catch (const CompileError& error) {
    EXPECT_EQ(error.location.line, 12u);
  }
}

/// Every point that a moving leaf passes during the shutter is within its bounds.
TEST(Compile, MotionBoundsHoldThePath) {
  SceneBuilder b;
  const NodeId ball = b.turning(b.moved(b.sphere(0.5, {2, 0, 0}), scaling({1, 2, 1})), {0, 0, 1}, 400);
  b.show(b.moving(b.list({ball}), {0, 0, 0}, {0, 3, 1}));
  CompileOptions options;
  options.shutter = {0.25, 0.75};
  const auto scene = b.compile(options);
  EXPECT_TRUE(scene->has_motion);
  EXPECT_TRUE(scene->leaves[0].animated);
  const Bounds3 box = scene->leaf_bounds(0, scene->shutter, 0);
  TraceScratch scratch;
  for (int i = 0; i <= 100; ++i) {
    const double time = 0.25 + 0.005 * i;
    const Affine& map = scratch.motion.placement(*scene, scene->leaves[0].placement, time).forward;
    for (const Vec3& p :
         {Vec3{2.5, 0, 0}, Vec3{1.5, 0, 0}, Vec3{2, 0.5, 0}, Vec3{2, -0.5, 0}, Vec3{2, 0, 0.5}}) {
      EXPECT_TRUE(box.contains(map.point(p)));
    }
  }
  EXPECT_LT(box.largest_extent(), 12);
  EXPECT_LT(scene->groups[0].bounds.largest_extent(), 12);
}

TEST(Compile, FramesMove) {
  SceneBuilder b;
  b.show(b.moving(b.sphere(1, {0, 0, 0}), {0, 0, 0}, {10, 0, 0}));
  for (int i = 0; i < 20; ++i) b.show(b.sphere(0.5, {0, 30.0 + i, 0}));
  CompileOptions options;
  options.shutter = {0, 0};
  const auto scene = b.compile(options);
  const auto at = [&](double x, double time) {
    Ray ray{{x, 0, 9}, {0, 0, -1}};
    ray.time = time;
    return trace(*scene, ray).found;
  };
  EXPECT_TRUE(at(0, 0));
  EXPECT_FALSE(at(30, 0));
  scene->prepare_frame({3, 3.5}, 1, true);
  EXPECT_TRUE(at(30, 3));
  EXPECT_TRUE(at(35, 3.5));
  EXPECT_FALSE(at(30, 3.5));
  EXPECT_EQ(scene->leaves.size(), 21u);
  // Without motion nothing is done again.
  SceneBuilder still;
  for (int i = 0; i < 20; ++i) still.show(still.sphere(0.5, {0, 30.0 + i, 0}));
  const auto rest = still.compile(options);
  const fas::Hierarchy* before = rest->groups[0].hierarchy.get();
  rest->prepare_frame({3, 3.5}, 1, true);
  EXPECT_EQ(rest->groups[0].hierarchy.get(), before);
}

TEST(Compile, MotionThatDegeneratesIsReportedWithItsTime) {
  SceneBuilder b;
  AnimatedStep step;
  step.kind = StepKind::kScale;
  step.arguments = {Expression(1),
                    Expression::apply(Operation::kSubtract, {Expression(1), Expression::time(), {}, {}}),
                    Expression(1)};
  b.show(b.moved(b.sphere(1, {0, 0, 0}), step));
  const auto scene = b.compile();
  TraceScratch scratch;
  Ray ray{{0, 0, 9}, {0, 0, -1}};
  ray.time = 1;
  EXPECT_THROW(test::nearest(*make_brute_force(*scene), ray, scratch), MotionError);
  ray.time = 0.5;
  EXPECT_TRUE(test::nearest(*make_brute_force(*scene), ray, scratch).found);
}

TEST(Compile, TexturedPaths) {
  SceneBuilder b;
  const auto pair = b.name(b.list({b.textured(b.sphere(1, {0, 0, 0})), b.sphere(1, {5, 0, 0})}));
  b.show(b.object(pair));
  b.show(b.textured(b.moved(b.object(pair), translation({20, 0, 0}))));
  const auto scene = b.compile();
  EXPECT_TRUE(scene->has_textures);
  const auto textured = [&](double x) {
    return has_textures(*scene, trace(*scene, {{x, 0, 9}, {0, 0, -1}}).hit);
  };
  EXPECT_TRUE(textured(0));
  EXPECT_FALSE(textured(5));
  EXPECT_TRUE(textured(20));
  EXPECT_TRUE(textured(25));
}

}  // namespace
}  // namespace rayshade
