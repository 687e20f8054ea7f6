// SPDX-License-Identifier: MIT
// Packs of rays against single rays: the same bits, for every kind of leaf, on every instruction set.
#include <gtest/gtest.h>

#include <random>

#include "rayshade/geometry/intersector.h"
#include "rayshade/geometry/pack_tracer.h"
#include "rayshade/lang/parse.h"
#include "tests/unit/fas/targets.h"

namespace rayshade {
namespace {

constexpr const char* kLeaves[] = {
    "plane 0 0 -1 .2 .1 1", "sphere 1 .2 0 .1", "box -1 -.6 -.3 .9 .5 .7", "disc 1.3 .1 0 0 .3 -.2 1",
    "cylinder .4 -1 -.5 -.3 1 .4 .2", "cone .9 0 0 -1 .2 .3 .1 1", "cone -.5 0 0 -1 .7 .3 .1 1",
    "triangle -1 -1 0 1 -.8 .2 .1 1.2 -.3", "triangle -1 -1 0 0 0 1 1 -1 0 .1 0 1 0 1 0 0 .1 1",
    "poly -1 -1 0 1 -1 0 1 1 0 0 .2 0 -1 1 0", "torus .8 .3 0 0 0 .1 .2 1",
    "blob .4 1 1.2 -.5 0 0 .8 1 .6 .2 .3", "sphere 1 0 0 0 scale 1 2 .5 rotate 1 1 0 33 translate .2 .1 0",
    "triangle -1 -1 0 1 -1 0 0 1 0 rotate 1 2 3 50 scale -1 1 2", "box -1 -1 -1 1 1 1", "sphere 1 0 0 0",
    "disc 1 0 0 0 0 0 1", "poly -1 -1 0 1 -1 0 1 1 0 -1 1 0",
    // A star that crosses itself, and one of more corners than a loop is made for.
    "poly -1 -1 0 0 1.2 0 1 -1 0 -1 .4 0 1 .4 0",
    "poly 1 0 0 .4 .2 0 .7 .7 0 .2 .4 0 0 1 0 -.2 .4 0 -.7 .7 0 -.4 .2 0 -1 0 0 "
    "-.4 -.2 0 -.7 -.7 0 -.2 -.4 0 0 -1 0 .2 -.4 0 .7 -.7 0 .4 -.2 0"};

struct Compiled {
  Scene scene;
  MemoryProvider provider;
  std::unique_ptr<CompiledScene> compiled;
  explicit Compiled(const std::string& text) {
    provider.add("x.ray", text);
    ParseResult parsed = parse_scene(provider, "x.ray", {});
    EXPECT_TRUE(parsed.ok) << text;
    scene = std::move(parsed.scene);
    compiled = compile_scene(scene, provider, {});
  }
};

/// Rays at random, along axes, through the lattice points on which surfaces meet, and starting on surfaces.
std::vector<Ray> rays(unsigned seed, int count) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-2, 2);
  std::uniform_int_distribution<int> grid(-2, 2), die(0, 5);
  std::vector<Ray> out;
  for (int i = 0; i < count; ++i) {
    Ray ray;
    ray.origin = {u(random), u(random), u(random)};
    Vec3 target{u(random), u(random), u(random)};
    switch (die(random)) {
      case 0:
        ray.origin = {static_cast<double>(grid(random)), static_cast<double>(grid(random)), 5};
        target = ray.origin - Vec3{0, 0, 1};
        break;
      case 1:
        target = {static_cast<double>(grid(random)), static_cast<double>(grid(random)), 0};
        break;
      case 2:
        ray.origin = {0.5 * grid(random), 0.5 * grid(random), static_cast<double>(grid(random))};
        target = ray.origin + Vec3{static_cast<double>(grid(random)), -0.0, 1e-300};
        break;
      case 3:
        ray.origin = 1e7 * ray.origin;
        break;
      default:
        break;
    }
    ray.direction = target - ray.origin;
    if (max_abs(ray.direction) > 0) ray.direction = normalize(ray.direction);
    out.push_back(ray);
  }
  return out;
}

void compare(const Compiled& scene, const std::vector<Ray>& all, std::size_t& hits) {
  const auto packs = make_hierarchy(*scene.compiled), oracle = make_brute_force(*scene.compiled);
  std::vector<NearestQuery> nearest(all.size());
  std::vector<OcclusionQuery> shadow(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    nearest[i].ray = shadow[i].ray = all[i];
    nearest[i].lo = shadow[i].lo = i % 3 == 0 ? 0 : 1e-5;
    nearest[i].hi = shadow[i].hi = i % 4 == 0 ? 2 : kFar;
  }
  std::vector<NearestAnswer> a(all.size()), b(all.size());
  std::vector<OcclusionAnswer> c(all.size()), d(all.size());
  TraceScratch scratch;
  packs->nearest(nearest, a, scratch);
  oracle->nearest(nearest, b, scratch);
  packs->occluded(shadow, c, scratch);
  oracle->occluded(shadow, d, scratch);
  for (std::size_t i = 0; i < all.size(); ++i) {
    ASSERT_EQ(a[i].found, b[i].found) << "ray " << i;
    ASSERT_EQ(c[i].occluded, d[i].occluded) << "ray " << i;
    if (!b[i].found) continue;
    ++hits;
    const Hit &x = a[i].hit, &y = b[i].hit;
    // Coincident leaves may stand in another order; rank and order of a leaf do not change.
    ASSERT_EQ(x.rank, y.rank) << "ray " << i;
    ASSERT_EQ(x.shape.t, y.shape.t) << "ray " << i;
    ASSERT_EQ(x.shape.a, y.shape.a) << "ray " << i;
    ASSERT_EQ(x.shape.b, y.shape.b) << "ray " << i;
    ASSERT_EQ(x.shape.part, y.shape.part) << "ray " << i;
    ASSERT_EQ(x.leaf, y.leaf) << "ray " << i;
    ASSERT_EQ(x.flag, y.flag) << "ray " << i;
    ASSERT_EQ(x.instances.count, y.instances.count) << "ray " << i;
  }
}

using RayPackTest = fas::test::TargetTest;

TEST_P(RayPackTest, EveryLeafAnswersAsForSingleRays) {
  unsigned seed = 100;
  for (const char* leaf : kLeaves) {
    SCOPED_TRACE(leaf);
    const Compiled scene(leaf);
    ASSERT_TRUE(traces_in_packs(*scene.compiled));
    std::size_t hits = 0;
    compare(scene, rays(seed++, 20'000), hits);
    EXPECT_GT(hits, 400u);
  }
}

TEST_P(RayPackTest, CoincidentAndMixedLeavesAnswerAsForSingleRays) {
  std::string text;
  for (const char* leaf : kLeaves) text += std::string(leaf) + "\n";
  text += "difference\nbox -1 -1 -1 1 1 1\nsphere 1.2 0 0 0\nend\n";
  const Compiled scene(text);
  std::size_t hits = 0;
  compare(scene, rays(7, 50'000), hits);
  EXPECT_GT(hits, 1000u);
}

/// CSG at random, on a lattice so that faces coincide, with open operands and lists, in odd transforms.
class CsgText {
 public:
  explicit CsgText(unsigned seed) : random_(seed) {}

  std::string solid(int depth) {
    std::string text;
    if (depth == 0 || (depth < 3 && die(5) == 0)) {
      text = primitive();
    } else {
      static constexpr const char* kOperations[] = {"union", "intersect", "difference"};
      text = kOperations[die(3)];
      const int operands = die(4) == 0 ? 3 : 2;
      for (int i = 0; i < operands; ++i) text += "\n" + solid(depth - 1);
      text += "\nend";
    }
    if (die(4) == 0) text += " rotate 1 " + number() + " .3 40 scale 1 .7 1.4 translate 0 " + number() + " 0";
    return text;
  }

 private:
  int die(int sides) { return std::uniform_int_distribution<int>(0, sides - 1)(random_); }
  std::string number() { return std::to_string(0.5 * (die(5) - 2)); }
  std::string size() { return std::to_string(0.5 * (1 + die(3))); }

  std::string primitive() {
    const std::string x = number(), y = number(), r = size(), h = size();
    switch (die(8)) {
      case 0:
        return "sphere " + r + " " + x + " " + y + " 0";
      case 1:
        return "list\ndisc " + r + " 0 0 -" + h + " 0 0 -1\ncylinder " + r + " 0 0 -" + h + " 0 0 " + h +
               "\ndisc " + r + " 0 0 " + h + " 0 0 1\nend";
      case 2:
        return "cylinder " + r + " 0 0 -" + h + " 0 0 " + h;
      case 3:
        return "cone " + r + " 0 0 0 0 " + x + " " + y + " 1.5";
      case 4:
        return "plane 0 0 " + x + " 0 " + y + " 1";
      case 5:
        return "triangle -1 -1 " + x + " 1 -1 " + y + " 0 1.5 0";
      default:
        return "box -" + r + " -1 -" + h + " " + h + " 1 " + r;
    }
  }

  std::mt19937 random_;
};

TEST_P(RayPackTest, CsgAnswersAsForSingleRays) {
  std::size_t hits = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    CsgText csg(seed);
    std::string text;
    for (unsigned i = 0; i <= seed % 3; ++i) text += csg.solid(1 + static_cast<int>(seed % 4)) + "\n";
    SCOPED_TRACE(text);
    const Compiled scene(text);
    ASSERT_TRUE(traces_in_packs(*scene.compiled));
    for (const Csg& object : scene.compiled->csgs) ASSERT_TRUE(object.in_packs);
    compare(scene, rays(seed, 1500), hits);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(hits, 10'000u);
}

INSTANTIATE_TEST_SUITE_P(Targets, RayPackTest, testing::ValuesIn(fas::test::targets()),
                         fas::test::target_name);

}  // namespace
}  // namespace rayshade
