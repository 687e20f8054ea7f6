// SPDX-License-Identifier: MIT
// How textures act on a hit: spaces, order, normals, motion, shadows (textures.md 1).
#include "rayshade/texture/apply.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <random>

#include "tests/unit/texture/textured_scene.h"

namespace rayshade {
namespace {

using test::TexturedScene;

void expect_near(const Vec3& a, const Vec3& b, double tolerance = 1e-12) {
  EXPECT_LT(length(a - b), tolerance)
      << "(" << a.x << ", " << a.y << ", " << a.z << ") and (" << b.x << ", " << b.y << ", " << b.z << ")";
}

/// Two surfaces to tell apart, and a plane z = 0 seen from above at (x, y).
const std::string kSurfaces = "surface a ambient 1 0 0\nsurface b ambient 0 1 0\nsurface c ambient 0 0 1\n";
Color ambient_at(TexturedScene& scene, double x, double y, double time = 0) {
  return scene.look({x, y, 5}, {x, y, 0}, time).surface.ambient;
}
const Color kA{1, 0, 0}, kB{0, 1, 0}, kC{0, 0, 1};

TEST(Apply, WithoutTexturesGivesTheSurfaceAndTheWorld) {
  TexturedScene scene(kSurfaces + "list sphere a 1 0 0 0 scale 1 2 3 end translate 4 5 6");
  const TexturedHit seen = scene.look({4, 5, 20}, {4, 5, 0});
  EXPECT_EQ(seen.surface, scene.scene().surfaces[0]);
  expect_near(seen.world.point, {4, 5, 9});
  expect_near(seen.world.normal, {0, 0, 1});
  EXPECT_TRUE(seen.world.entering);
}

TEST(Apply, ATextureWithoutEffectChangesNothing) {
  const std::string body =
      "list sphere a 1 0 0 0 scale 1 2 3 rotate 1 2 3 40 end translate 4 5 6 scale .5 1 2";
  TexturedScene plain(kSurfaces + body);
  TexturedScene textured(kSurfaces + body + " texture blotch 5 b");
  for (double x = 1.6; x < 2.4; x += 0.1) {
    const TexturedHit p = plain.look({x, 5, 40}, {x, 5.3, 12}), t = textured.look({x, 5, 40}, {x, 5.3, 12});
    EXPECT_EQ(p.surface, t.surface);
    expect_near(p.world.point, t.world.point);
    expect_near(p.world.normal, t.world.normal);
    expect_near(p.world.geometric_normal, t.world.geometric_normal);
    EXPECT_EQ(p.world.entering, t.world.entering);
    EXPECT_LT(length(p.world.point - t.world.point), p.world.error + t.world.error);
    EXPECT_LT(t.world.error, 1e-12);
  }
}

TEST(Apply, AnObjectsTransformDoesNotCarryItsOwnTextures) {
  // In [0, 1) of x and y the cell is even where z is just above 0.
  TexturedScene own(kSurfaces + "plane a 0 0 .5 0 0 1 translate 1 0 0 texture checker b");
  EXPECT_EQ(ambient_at(own, 0.5, 0.5), kA);
  EXPECT_EQ(ambient_at(own, 1.5, 0.5), kB);
  TexturedScene outer(kSurfaces + "list plane a 0 0 .5 0 0 1 texture checker b end translate 1 0 0");
  EXPECT_EQ(ambient_at(outer, 0.5, 0.5), kB);
  EXPECT_EQ(ambient_at(outer, 1.5, 0.5), kA);
  TexturedScene of_list(kSurfaces + "list plane a 0 0 .5 0 0 1 end translate 1 0 0 texture checker b");
  EXPECT_EQ(ambient_at(of_list, 0.5, 0.5), kA);
}

TEST(Apply, ATexturesTransformMovesIt) {
  TexturedScene scene(kSurfaces + "plane a 0 0 .5 0 0 1 texture checker b scale 2 1 1 translate 1 0 0");
  EXPECT_EQ(ambient_at(scene, 1.1, 0.5), kA);
  EXPECT_EQ(ambient_at(scene, 2.9, 0.5), kA);
  EXPECT_EQ(ambient_at(scene, 3.1, 0.5), kB);
  EXPECT_EQ(ambient_at(scene, 0.9, 0.5), kB);
}

TEST(Apply, InnerTexturesFirstThenInFileOrder) {
  TexturedScene same(kSurfaces + "plane a 0 0 .5 0 0 1 texture checker b texture checker c scale 2 2 2");
  EXPECT_EQ(ambient_at(same, 0.5, 0.5), kA);
  EXPECT_EQ(ambient_at(same, 1.5, 0.5), kB);
  EXPECT_EQ(ambient_at(same, 2.5, 0.5), kC);  // the later one wins where both apply
  TexturedScene levels(kSurfaces +
                       "name leaf plane a 0 0 .5 0 0 1 texture checker c texture wood\n"
                       "list object leaf texture checker b end");
  EXPECT_EQ(ambient_at(levels, 1.5, 0.5), kB);
  TexturedScene shared(kSurfaces +
                       "name leaf list plane a 0 0 .5 0 0 1 texture checker b sphere 1 0 0 -90 end\n"
                       "object leaf translate 1 0 0 texture checker c scale 4 4 4\n"
                       "object leaf translate 0 0 -50");
  EXPECT_EQ(ambient_at(shared, 1.5, 0.5), kA);
  EXPECT_EQ(ambient_at(shared, 0.5, 0.5), kB);
  EXPECT_EQ(ambient_at(shared, 4.5, 0.5), kC);
}

TEST(Apply, MovingTexturesComposeInTheWrittenOrder) {
  TexturedScene moving(kSurfaces +
                       "plane a 0 0 .5 0 0 1 texture wood scale 2 2 2 translate (1.5 + time) .2 .1 rotate "
                       "0 0 1 (10 * time)");
  TexturedScene still(kSurfaces +
                      "plane a 0 0 .5 0 0 1 texture wood scale 2 2 2 translate 2.25 .2 .1 rotate 0 0 1 7.5");
  for (double x = -2; x < 2; x += 0.37) {
    const Color m = ambient_at(moving, x, 0.4, 0.75), s = ambient_at(still, x, 0.4);
    EXPECT_NEAR(m.r, s.r, 1e-11);
    EXPECT_NE(ambient_at(moving, x, 0.4, 0.1).r, m.r);
  }
}

TEST(Apply, ADegenerateMomentIsAnError) {
  TexturedScene scene(kSurfaces + "plane a 0 0 .5 0 0 1 texture wood scale (time) 1 1");
  EXPECT_NO_THROW(ambient_at(scene, 0.5, 0.5, 1));
  const Ray ray = TexturedScene::ray({0, 0, 5}, {0, 0, 0}, 0);
  const auto hit = scene.hit(ray);
  ASSERT_TRUE(hit);
  TexturedHit out;
  EXPECT_THROW(evaluate_hit(scene.compiled(), scene.textures(), *hit, ray, {}, scene.scratch(), out),
               MotionError);
}

TEST(Apply, FbmBumpLeavesTheNormalUnlessAnEnclosingTransformFollows) {
  const std::string bumped = "plane 0 0 .3 0 0 1 texture fbmbump .1 .8 .5 2 4";
  TexturedScene bare(bumped), in_list("list " + bumped + " end"),
      moved("list " + bumped + " end translate 1 0 0");
  const Vec3 q{0.4, 0.7, 0.3};
  const Vec3 expected = Vec3{0, 0, 1} + Vec3{0.1, 0.1, 0.1} + 0.8 * vfbm(q, 0.5, 2, 4);
  const Vec3 above{0, 0, 5};
  expect_near(bare.look(q + above, q).world.normal, expected);
  expect_near(in_list.look(q + above, q).world.normal, expected);
  const Vec3 side{1, 0, 0};
  expect_near(moved.look(q + above + side, q + side).world.normal, normalize(expected));
}

TEST(Apply, BumpsPushInModelSpaceWhateverTheTexturesTransform) {
  TexturedScene scene("plane 0 0 .3 0 0 1 texture bump .7 rotate 1 0 0 90 scale 2 3 4");
  const Vec3 p{0.4, 0.7, 0.3};
  const Affine map = then(rotation_degrees({1, 0, 0}, 90), scaling({2, 3, 4}));
  expect_near(scene.look(p + Vec3{0, 0, 5}, p).world.normal,
              normalize(Vec3{0, 0, 1} + 0.7 * dnoise3(inverse(map)->point(p))));
}

TEST(Apply, NormalsPassEnclosingTransformsOutward) {
  TexturedScene scene("list plane 0 0 .6 0 0 1 texture bump .7 end scale 2 3 .5 rotate 0 0 1 30");
  const Affine map = then(scaling({2, 3, 0.5}), rotation_degrees({0, 0, 1}, 30));
  const Vec3 inner{0.2, -0.3, 0.6}, p = map.point(inner);
  const Vec3 bumped = normalize(Vec3{0, 0, 1} + 0.7 * dnoise3(inner));
  expect_near(scene.look(p + Vec3{0, 0, 5}, p).world.normal,
              normalize(inverse(map)->transposed_vector(bumped)));
  expect_near(scene.look(p + Vec3{0, 0, 5}, p).world.geometric_normal, {0, 0, 1});
}

TEST(Apply, TheGeometricNormalGoesOutwardToo) {
  const std::string triangle =
      "triangle -2 -2 0 -.8 -.5 .33 2 -2 0 .8 -.5 .33 0 2 0 0 .8 .6 rotate 1 0 0 60 rotate 0 1 0 20";
  TexturedScene plain(triangle), textured(triangle + " texture blotch 5 ambient 1 1 1");
  const TexturedHit p = plain.look({0.1, -4, 6}, {0.1, 0, 0}), t = textured.look({0.1, -4, 6}, {0.1, 0, 0});
  expect_near(t.world.geometric_normal, p.world.geometric_normal);
  expect_near(t.world.normal, p.world.normal);
  EXPECT_TRUE(t.world.smooth);
  EXPECT_GT(length(t.world.normal - t.world.geometric_normal), 0.01);
}

TEST(Apply, EnteringIsDecidedBeforeTexturing) {
  TexturedScene scene("sphere 1 0 0 0 texture bump 50");
  EXPECT_TRUE(scene.look({0, 0, 5}, {0.1, 0.2, 0}).world.entering);
  EXPECT_FALSE(scene.look({0, 0, 0}, {0.1, 0.2, 0.5}).world.entering);
}

class CountedDraws final : public GlossDraws {
 public:
  std::array<double, 2> operator()(unsigned nth) const override {
    asked.push_back(nth);
    return {0.25 + nth * 0.5, 0.125};
  }
  mutable std::vector<unsigned> asked;
};

TEST(Apply, GlossAsksForItsDrawsInOrder) {
  TexturedScene scene(
      "list plane 0 0 .3 0 0 1 texture gloss .9 texture wood texture gloss .8 end texture gloss .7");
  const CountedDraws draws;
  const Vec3 normal = scene.look({0.1, 0.2, 5}, {0.1, 0.2, 0}, 0, {5, 3, &draws}).world.normal;
  EXPECT_EQ(draws.asked, (std::vector<unsigned>{0, 1, 2}));
  Vec3 expected = gloss_normal({0, 0, 1}, 0.9, {0.25, 0.125}, 5, 3);
  expected = gloss_normal(expected, 0.8, {0.75, 0.125}, 5, 3);
  expected = gloss_normal(expected, 0.7, {1.25, 0.125}, 5, 3);
  expect_near(normal, expected);
  TexturedScene none("plane 0 0 .3 0 0 1 texture wood");
  const CountedDraws unused;
  none.look({0.1, 0.2, 5}, {0.1, 0.2, 0}, 0, {5, 3, &unused});
  EXPECT_TRUE(unused.asked.empty());
}

TEST(Apply, UvMappingMovesThePointByTheTexturesTransformAfterTheObjectsInverse) {
  // textures.md D4: x = T(A^-1(q)), (u, v) = T^-1(u0, v0, 0) with q = T^-1(p), for a polygon, whose u0, v0
  // are x, y.
  TexturedScene scene(
      "poly ambient 1 1 1 -5 -5 0 5 -5 0 5 5 0 -5 5 0 rotate 0 0 1 30 scale 2 3 1 translate .4 .7 .3\n"
      "texture image ramp.ppm scale .7 .9 1.3 rotate 0 0 1 25 translate .2 -.3 0",
      {{"ramp.ppm", "P3\n4 1\n255\n10 0 0 20 0 0 30 0 0 40 0 0\n"}});
  const Affine a =
      then(then(rotation_degrees({0, 0, 1}, 30), scaling({2, 3, 1})), translation({0.4, 0.7, 0.3}));
  const Affine t =
      then(then(scaling({0.7, 0.9, 1.3}), rotation_degrees({0, 0, 1}, 25)), translation({0.2, -0.3, 0}));
  int distinct = 0;
  for (double x = -1; x < 1; x += 0.17) {
    const Vec3 p{x, 0.35, 0.3};
    const Vec3 q = inverse(t)->point(p);
    const Vec3 at = t.point(inverse(a)->point(q));
    const double u = inverse(t)->point({at.x, at.y, 0}).x;
    const double column = std::floor((u - std::floor(u)) * 4);
    EXPECT_NEAR(scene.look(p + Vec3{0, 0, 5}, p).surface.ambient.r * 255, 10 * (column + 1), 1e-9) << x;
    const double sane = inverse(t)->point(inverse(a)->point(p)).x;
    distinct += std::floor((sane - std::floor(sane)) * 4) != column;
  }
  EXPECT_GT(distinct, 0);  // the other order would show elsewhere
}

/// Two levels of transforms, and a texture with one of its own.
const std::string kTwoLevels = " rotate 0 0 1 30 scale 2 3 1 end translate .4 .7 .3 rotate 1 2 3 20\n";
const Affine kInner = then(rotation_degrees({0, 0, 1}, 30), scaling({2, 3, 1}));
const Affine kOuter = then(translation({0.4, 0.7, 0.3}), rotation_degrees({1, 2, 3}, 20));

TEST(Apply, TheFrameIsComposedOverLevels) {
  TexturedScene scene(
      "list poly ambient 1 1 1 -5 -5 0 5 -5 0 5 5 0 -5 5 0" + kTwoLevels + "texture image ramp.ppm",
      {{"ramp.ppm", "P3\n4 1\n255\n10 0 0 20 0 0 30 0 0 40 0 0\n"}});
  const Affine frame = then(kInner, kOuter);
  for (double x = -1; x < 1; x += 0.17) {
    const Vec3 local{x, 0.35, 0};
    const Vec3 p = frame.point(local);
    const double column = std::floor((x - std::floor(x)) * 4);
    EXPECT_NEAR(scene.look(p + Vec3{0, 0, 5}, p).surface.ambient.r * 255, 10 * (column + 1), 1e-9) << x;
  }
}

TEST(Apply, TangentsGoOutwardAndThroughTheTexturesTransform) {
  TexturedScene scene("list poly -5 -5 0 5 -5 0 5 5 0 -5 5 0" + kTwoLevels +
                          "texture image grey.pgm component bump range .9 .1 scale .7 .9 1.3 rotate 1 0 0 25",
                      {{"grey.pgm", "P2\n2 2\n255\n10 250 130 60\n"}});
  const Affine frame = then(kInner, kOuter);
  const Affine t = then(scaling({0.7, 0.9, 1.3}), rotation_degrees({1, 0, 0}, 25));
  const Vec3 n =
      normalize(inverse(kOuter)->transposed_vector(normalize(inverse(kInner)->transposed_vector({0, 0, 1}))));
  const Vec3 du = frame.vector({1, 0, 0}), dv = frame.vector({0, 1, 0}), g = frame.vector({0, 0, 1});
  const auto tangent = [&](const Vec3& row) { return normalize(row.x * du + row.y * dv + row.z * g); };
  const double height[2][2] = {{130 / 255.0, 60 / 255.0}, {10 / 255.0, 250 / 255.0}};  // the lower row first
  for (double x = -1; x < 1; x += 0.13) {
    const Vec3 p = frame.point({x, 0.35, 0});
    // D4 again: T after the inverse of the frame, on the point already taken by the inverse of T.
    const Vec3 at = t.point(inverse(frame)->point(inverse(t)->point(p)));
    const Vec3 uv = inverse(t)->point({at.x, at.y, 0});
    const int ix = static_cast<int>((uv.x - std::floor(uv.x)) * 2),
              iy = static_cast<int>((uv.y - std::floor(uv.y)) * 2);
    const double here = height[iy][ix];
    const double fu = 0.1 + 0.8 * (height[iy][1 - ix] - here), fv = 0.1 + 0.8 * (height[1 - iy][ix] - here);
    const Vec3 expected =
        normalize(n + fu * cross(n, tangent(t.rows[1])) - fv * cross(n, tangent(t.rows[0])));
    expect_near(scene.look(p + 3 * n, p).world.normal, expected, 1e-9);
  }
}

TEST(Apply, MountTintsTheHighlightToo) {
  TexturedScene scene(
      "plane ambient 1 1 1 diffuse 1 1 1 specular 1 1 1 body 1 1 1 0 0 -1 0 0 1 texture mount m.map 0 0",
      {{"m.map", "51 102 153\n"}});
  const Surface s = scene.look({0.1, 0.2, 5}, {0.1, 0.2, 0}).surface;
  EXPECT_NEAR(s.ambient.r, 0.2, 1e-15);
  EXPECT_NEAR(s.diffuse.g, 0.4, 1e-15);
  EXPECT_NEAR(s.specular.b, 0.6, 1e-15);
  EXPECT_EQ(s.body, (Color{1, 1, 1}));
}

/// A 2 x 1 grey picture with alpha as Utah RLE: values 0 and 255, both with that alpha.
std::string grey_with_alpha(int alpha) {
  const char a = static_cast<char>(alpha);
  return std::string("\x52\xCC\0\0\0\0\2\0\1\0\6\1\x8\0\0\0", 16) + std::string{2, '\xff', 5, 1, a, a} +
         std::string{2, 0, 5, 1, 0, '\xff', 7, 0};
}

TEST(Apply, AnInvisiblePixelDoesNotBump) {
  const std::string text = "plane 0 0 .3 0 0 1 texture image g.rle component bump map planar";
  TexturedScene visible(text, {{"g.rle", grey_with_alpha(255)}}),
      invisible(text, {{"g.rle", grey_with_alpha(0)}});
  expect_near(visible.look({0.2, 0.2, 5}, {0.2, 0.2, 0}).world.normal, normalize({-1, 0, 1}));
  expect_near(invisible.look({0.2, 0.2, 5}, {0.2, 0.2, 0}).world.normal, {0, 0, 1});
}

TEST(Apply, AllTexturesTakeHugeAndTinyPoints) {
  const std::map<std::string, std::string> files = {{"m.map", "1 2 3\n"},
                                                    {"i.ppm", "P3\n1 1\n255\n10 20 30\n"}};
  TexturedScene scene(
      "plane 0 0 .5 0 0 1 texture checker ambient 1 1 1 texture blotch 0 ambient 1 1 1 texture bump 1 "
      "texture marble "
      "m.map texture fbm 0 1 .5 2 1000 -1 m.map texture fbmbump 0 1 .5 2 4 texture wood texture gloss "
      ".5 texture "
      "cloud 1 .5 2 4 .1 .3 .6 texture sky 1 .5 2 4 .6 .3 texture stripe ambient 1 1 1 .1 .2 map spherical "
      "texture "
      "windy 1 1 1 1 3 2 .5 .1 texture mount m.map 1 1 texture image i.ppm map cylindrical texture image "
      "i.ppm smooth",
      files);
  for (const double x : {0.0, 1e-300, 1e6, -1e9, 1e12, -3e13}) scene.look({x, x, 5}, {x, x, 0});
  const double nowhere = std::numeric_limits<double>::quiet_NaN();
  const Ray sane = TexturedScene::ray({0, 0, 5}, {0, 0, 0});
  const auto hit = scene.hit(sane);
  ASSERT_TRUE(hit);
  Ray broken = sane;
  broken.origin = {nowhere, 1e300, nowhere};
  TexturedHit out;
  evaluate_hit(scene.compiled(), scene.textures(), *hit, broken, {}, scene.scratch(), out);
  EXPECT_EQ(out.surface.index, 1);  // no texture of the scene changes it
}

TEST(Transmittance, IsThatOfTheFullyTexturedSurface) {
  const unsigned seed = std::random_device{}();
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  const char* const kTextures[] = {"checker transp .3 body .2 .3 .4 extinct .7",
                                   "blotch -.2 transp .3 body .5 .6 .7",
                                   "bump .7",
                                   "marble",
                                   "wood",
                                   "fbm .2 .9 .5 2 5 -.3",
                                   "fbmbump .1 .8 .5 2 4",
                                   "gloss .3",
                                   "cloud 1 .5 2 5 .1 .35 .65",
                                   "sky .8 .5 2 5 .65 .35",
                                   "stripe transp .9 body .1 .8 .9 .15 .7",
                                   "windy .6 .7 1.1 .5 3 2.2 .6 .3",
                                   "mount m.map .4 .7",
                                   "image i.ppm map planar",
                                   "image i.ppm component body map planar",
                                   "image g.pgm component transp map planar",
                                   "image g.pgm component bump",
                                   "image i.ppm textsurf transp .4 body .7 .6 .5 extinct .5 map spherical"};
  const std::map<std::string, std::string> files = {{"m.map", "255 2 3\n1 255 4\n"},
                                                    {"i.ppm", "P3\n2 1\n255\n110 20 30 40 250 60\n"},
                                                    {"g.pgm", "P2\n2 2\n255\n110 20 30 40\n"}};
  const auto pick = [&] { return kTextures[random() % std::size(kTextures)]; };
  std::uniform_real_distribution<double> number(-1, 1);
  const auto some = [&](double around) { return std::to_string(around + 0.3 * number(random)); };
  const auto move = [&] {
    return " scale " + some(1) + " " + some(1) + " " + some(1) + " rotate 1 2 3 " + some(40) + " translate " +
           some(0) + " " + some(0) + " " + some(0) + " ";
  };
  int changed = 0;
  for (int i = 0; i < 60; ++i) {
    std::string text = "list sphere transp .8 body .9 .8 .7 extinct .9 1 0 0 0" + move();
    for (int k = 0; k < 3; ++k) text += "\ntexture " + std::string(pick()) + move();
    text += "\nend" + move();
    for (int k = 0; k < 2; ++k) text += "\ntexture " + std::string(pick()) + (k ? move() : "");
    TexturedScene scene(text, files);
    for (int k = 0; k < 10; ++k) {
      const Vec3 from{3 * number(random), 3 * number(random), k % 2 ? 4 : 0.1 * number(random)};
      const Vec3 to{0.3 * number(random), 0.3 * number(random), k % 2 ? 0 : 0.5};
      if (!scene.hit(TexturedScene::ray(from, to))) continue;
      const TexturedHit full = scene.look(from, to);
      const Transmittance part = scene.transmittance(from, to);
      EXPECT_EQ(part.color, full.surface.body * full.surface.transparency) << text;
      EXPECT_EQ(part.extinction, full.surface.extinction) << text;
      EXPECT_EQ(part.entering, full.world.entering) << text;
      changed += part.extinction != 0.9 || part.color != Color{0.9 * 0.8, 0.8 * 0.8, 0.7 * 0.8};
    }
  }
  EXPECT_GT(changed, 100);
}

}  // namespace
}  // namespace rayshade
