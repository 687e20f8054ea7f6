// SPDX-License-Identifier: MIT
// The canonical text of scenes built by hand. That a parser reads it back to the same text is tested with the
// parser.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "rayshade/scene/scene.h"
#include "rayshade/scene/scene_text.h"

namespace rayshade {
namespace {

/// Builds scenes piece by piece.
struct Builder {
  Scene scene;

  std::uint32_t surface(double red) {
    Surface s;
    s.diffuse = {red, 0, 0};
    scene.surfaces.push_back(s);
    return static_cast<std::uint32_t>(scene.surfaces.size() - 1);
  }
  NodeId add(Node node) {
    scene.nodes.push_back(node);
    return static_cast<NodeId>(scene.nodes.size() - 1);
  }
  NodeId sphere(double radius, std::uint32_t surface = kNone) {
    scene.spheres.push_back({radius, {1, 2, 3}});
    return add(
        {NodeKind::kSphere, static_cast<std::uint32_t>(scene.spheres.size() - 1), surface, kNone, kNone, {}});
  }
  NodeId aggregate(NodeKind kind, std::vector<NodeId> members, std::uint32_t surface = kNone) {
    scene.aggregates.push_back({std::move(members), {4, 5, 6}});
    return add({kind, static_cast<std::uint32_t>(scene.aggregates.size() - 1), surface, kNone, kNone, {}});
  }
  NodeId instance(std::uint32_t named, std::uint32_t surface = kNone) {
    return add({NodeKind::kInstance, named, surface, kNone, kNone, {}});
  }
  std::uint32_t name(const std::string& text, NodeId node) {
    scene.named_objects.push_back({text, node});
    return static_cast<std::uint32_t>(scene.named_objects.size() - 1);
  }
  void transform(NodeId node, TransformList list) {
    scene.transforms.push_back(std::move(list));
    scene.nodes[node].transform = static_cast<std::uint32_t>(scene.transforms.size() - 1);
  }
};

std::string surface_line(int number, const std::string& red) {
  return "surface surface_" + std::to_string(number) + " ambient 0 0 0 diffuse " + red +
         " 0 0 specular 0 0 0 specpow 15 body 1 1 1 reflect 0 transp 0 index 1 extinct 1 translu 0 0 0 0 "
         "15\n";
}

TEST(CanonicalTextTest, AnEmptySceneIsEmpty) { EXPECT_EQ(canonical_text(Scene{}), ""); }

TEST(CanonicalTextTest, OnlySettingsThatAreSetAreWritten) {
  Scene scene;
  SceneSettings& s = scene.settings;
  s.eye = Vec3{0, -8, 0.1};
  s.horizontal_fov = 30;
  s.vertical_fov = 20.5;
  s.screen = {640, 480};
  s.crop = {0, 0.5, 0.25, 1};
  s.jitter = false;
  s.filter = FilterKind::kGauss;
  s.filter_width = 1e-7;
  s.toggle_transparent_shadows = true;
  s.output = "out.ppm";
  s.quiet = true;
  s.report_frequency = 5;
  s.report_file = "scale";
  s.ambient_light = Color{0.5, 1, 1};
  s.atmosphere_index = 1.5;
  s.effects.resize(2);
  s.effects[0].thickness = {1, 2, 3};
  s.effects[1].kind = EffectKind::kFogDeck;
  s.effects[1].octaves = 7;
  EXPECT_EQ(canonical_text(scene),
            "eyep 0 -8 0.1\n"
            "fov 30 20.5\n"
            "screen 640 480\n"
            "crop 0 0.5 0.25 1\n"
            "sample -1 nojitter\n"
            "filter gauss 1e-07\n"
            "shadowtransp\n"
            "outfile out.ppm\n"
            "report quiet 5 \"scale\"\n"
            "light 0.5 1 1 ambient\n"
            "atmosphere 1.5 fog 0 0 0 1 2 3 fogdeck 0 0 1 1 1 0 7 0 0 0 0 0 0\n");
}

TEST(CanonicalTextTest, LightsKeepTheirOrder) {
  Scene scene;
  Light spot;
  spot.kind = LightKind::kSpot;
  spot.target = {1, 0, 0};
  spot.exponent = 2;
  spot.no_shadow = true;
  Light area;
  area.kind = LightKind::kArea;
  area.u_end = {1, 0, 0};
  area.v_end = {0, 1, 0};
  area.u_samples = 3;
  area.v_samples = 2;
  Light extended;
  extended.kind = LightKind::kExtended;
  extended.radius = 0.5;
  scene.lights = {spot, area, extended, default_light()};
  EXPECT_EQ(canonical_text(scene),
            "light 1 1 1 spot 0 0 0 1 0 0 2 180 180 noshadow\n"
            "light 1 1 1 area 0 0 0 1 0 0 3 0 1 0 2\n"
            "light 1 1 1 extended 0.5 0 0 0\n"
            "light 1 1 1 directional 1 -1 1\n");
}

TEST(CanonicalTextTest, EqualSurfacesShareAName) {
  Builder b;
  b.scene.world = {b.sphere(1, b.surface(0.5)), b.sphere(2, b.surface(0.25)), b.sphere(3, b.surface(0.5)),
                   b.sphere(4)};
  EXPECT_EQ(canonical_text(b.scene), surface_line(1, "0.5") + surface_line(2, "0.25") +
                                         "sphere surface_1 1 1 2 3\n"
                                         "sphere surface_2 2 1 2 3\n"
                                         "sphere surface_1 3 1 2 3\n"
                                         "sphere 4 1 2 3\n");
}

TEST(CanonicalTextTest, EveryPrimitiveHasItsArguments) {
  Builder b;
  Scene& s = b.scene;
  const auto add = [&](NodeKind kind) { s.world.push_back(b.add({kind, 0, kNone, kNone, kNone, {}})); };
  s.planes.push_back({{1, 2, 3}, {4, 5, 6}});
  s.boxes.push_back({{1, 2, 3}, {4, 5, 6}});
  s.discs.push_back({9, {1, 2, 3}, {4, 5, 6}});
  s.cylinders.push_back({9, {1, 2, 3}, {4, 5, 6}});
  s.cones.push_back({9, {1, 2, 3}, 8, {4, 5, 6}});
  s.tori.push_back({9, 8, {1, 2, 3}, {4, 5, 6}});
  s.triangles.push_back({{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}});
  s.smooth_triangles.push_back({{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
  s.uv_triangles.push_back(
      {{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {.1, .2, .3}, {.4, .5, .6}});
  s.polygons.push_back({{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {-1, -2, -3}}});
  s.blobs.push_back({0.5, {{1, 2, {3, 4, 5}}, {6, 7, {8, 9, 10}}}});
  s.height_fields.push_back({{"dir/a b", {}}});
  for (const NodeKind kind :
       {NodeKind::kPlane, NodeKind::kBox, NodeKind::kDisc, NodeKind::kCylinder, NodeKind::kCone,
        NodeKind::kTorus, NodeKind::kTriangle, NodeKind::kSmoothTriangle, NodeKind::kUvTriangle,
        NodeKind::kPolygon, NodeKind::kBlob, NodeKind::kHeightField}) {
    add(kind);
  }
  EXPECT_EQ(canonical_text(s),
            "plane 1 2 3 4 5 6\n"
            "box 1 2 3 4 5 6\n"
            "disc 9 1 2 3 4 5 6\n"
            "cylinder 9 1 2 3 4 5 6\n"
            "cone 9 1 2 3 8 4 5 6\n"
            "torus 9 8 1 2 3 4 5 6\n"
            "triangle 1 2 3 4 5 6 7 8 9\n"
            "triangle 1 2 3 1 0 0 4 5 6 0 1 0 7 8 9 0 0 1\n"
            "triangleuv 1 2 3 1 0 0 0.1 0.4 4 5 6 0 1 0 0.2 0.5 7 8 9 0 0 1 0.3 0.6\n"
            "polygon 1 2 3 4 5 6 7 8 9 -1 -2 -3\n"
            "blob 0.5 1 2 3 4 5 6 7 8 9 10\n"
            "heightfield \"dir/a b\"\n");
}

TEST(CanonicalTextTest, TransformsAreMatricesAndExpressions) {
  Builder b;
  const NodeId node = b.sphere(1);
  TransformList list;
  list.append(scaling({2, 3, 0.1}));
  list.append(translation({0, 1, 0}));
  AnimatedStep turn;
  turn.kind = StepKind::kRotate;
  turn.arguments = {Expression(0), Expression(0), Expression(-1),
                    Expression::apply(Operation::kMultiply, {Expression::time(), Expression(90)})};
  list.append(turn);
  b.transform(node, list);
  b.scene.world = {node};
  EXPECT_EQ(canonical_text(b.scene),
            "sphere 1 1 2 3 transform 2 0 0 0 3 0 0 0 0.1 0 1 0 rotate 0 0 -1 (time * 90)\n");
}

TEST(CanonicalTextTest, EveryTextureHasItsArguments) {
  Builder b;
  const NodeId node = b.sphere(1);
  std::vector<Texture> textures;
  for (int kind = 0; kind <= static_cast<int>(TextureKind::kImage); ++kind) {
    Texture t;
    t.kind = static_cast<TextureKind>(kind);
    for (int i = 0; i < 7; ++i) t.arguments[i] = i + 1;
    t.octaves = 12;
    if (t.kind == TextureKind::kMarble || t.kind == TextureKind::kMount) t.file.name = "m.map";
    textures.push_back(t);
  }
  Texture& image = textures.back();
  image.file.name = "/a/../b.rle";
  image.image.component = ImageComponent::kTransp;
  image.image.smooth = true;
  image.image.has_surface = true;
  image.mapping.kind = MappingKind::kPlanar;
  image.mapping.explicit_axes = true;
  image.transform.append(scaling({2, 2, 2}));
  b.scene.texture_lists.push_back(textures);
  b.scene.nodes[node].textures = 0;
  b.scene.world = {node};
  EXPECT_EQ(canonical_text(b.scene),
            surface_line(1, "0") +
                "sphere 1 1 2 3 texture checker surface_1 texture blotch 1 surface_1 texture bump 1 "
                "texture marble m.map texture fbm 1 2 3 4 12 5 texture fbmbump 1 2 3 4 12 texture wood "
                "texture gloss 1 "
                "texture cloud 1 2 3 12 4 5 6 texture sky 1 2 3 12 4 5 texture stripe surface_1 1 2 map uv "
                "texture windy 1 2 3 4 12 5 6 7 texture mount m.map 1 2 "
                "texture image /a/../b.rle component transp tile 0 0 range 1 0 smooth textsurf surface_1 "
                "map planar 0 0 0 0 0 1 1 0 0 transform 2 0 0 0 2 0 0 0 2 0 0 0\n");
}

TEST(CanonicalTextTest, NamesAreMadeUniqueAndStayWhereTheyAre) {
  Builder b;
  b.name("a", b.sphere(1));
  b.name("a", b.sphere(2));
  b.name("a_2", b.sphere(3));
  b.name("not a name", b.instance(1));
  b.scene.world = {b.instance(0), b.instance(1), b.instance(2), b.instance(3)};
  EXPECT_EQ(canonical_text(b.scene),
            "name a sphere 1 1 2 3\n"
            "name a_2 sphere 2 1 2 3\n"
            "name a_2_2 sphere 3 1 2 3\n"
            "name object object a_2\n"
            "object a\n"
            "object a_2\n"
            "object a_2_2\n"
            "object object\n");
}

TEST(CanonicalTextTest, AggregatesNest) {
  Builder b;
  const NodeId csg = b.aggregate(NodeKind::kDifference, {b.sphere(1), b.sphere(2)});
  const NodeId grid = b.aggregate(NodeKind::kGrid, {csg, b.sphere(3)});
  TransformList list;
  list.append(translation({1, 0, 0}));
  b.transform(csg, list);
  b.scene.world = {grid};
  EXPECT_EQ(canonical_text(b.scene),
            "grid 4 5 6\n"
            "  difference\n"
            "    sphere 1 1 2 3\n"
            "    sphere 2 1 2 3\n"
            "  end transform 1 0 0 0 1 0 0 0 1 1 0 0\n"
            "  sphere 3 1 2 3\n"
            "end\n");
}

TEST(CanonicalTextTest, ApplysurfWhereNoBareMemberFollows) {
  // What parsing `sphere ... applysurf S list ... end list ... end sphere S ...` gives.
  Builder b;
  const std::uint32_t red = b.surface(1);
  b.scene.world = {b.sphere(1), b.aggregate(NodeKind::kList, {b.sphere(2)}, red),
                   b.aggregate(NodeKind::kUnion, {b.sphere(3), b.sphere(4)}, b.surface(1)), b.sphere(5, red),
                   b.aggregate(NodeKind::kList, {b.sphere(6)}, b.surface(0.5))};
  EXPECT_EQ(canonical_text(b.scene), surface_line(1, "1") + surface_line(2, "0.5") +
                                         "sphere 1 1 2 3\n"
                                         "applysurf surface_1\n"
                                         "list\n"
                                         "  sphere 2 1 2 3\n"
                                         "end\n"
                                         "union\n"
                                         "  sphere 3 1 2 3\n"
                                         "  sphere 4 1 2 3\n"
                                         "end\n"
                                         "sphere surface_1 5 1 2 3\n"
                                         "applysurf surface_2\n"
                                         "list\n"
                                         "  sphere 6 1 2 3\n"
                                         "end\n");
}

TEST(CanonicalTextTest, ABareMemberIsNeverReachedByAnApplysurf) {
  Builder b;
  const NodeId list = b.aggregate(NodeKind::kList, {b.sphere(1)}, b.surface(1));
  TransformList move;
  move.append(translation({1, 0, 0}));
  b.transform(list, move);
  b.scene.world = {list, b.sphere(2)};
  EXPECT_EQ(canonical_text(b.scene), surface_line(1, "1") +
                                         "name aggregate list\n"
                                         "  sphere 1 1 2 3\n"
                                         "end transform 1 0 0 0 1 0 0 0 1 1 0 0\n"
                                         "object surface_1 aggregate\n"
                                         "sphere 2 1 2 3\n");
}

TEST(CanonicalTextTest, NamedAggregatesWithASurfaceAreWrapped) {
  Builder b;
  const std::uint32_t red = b.surface(1);
  const NodeId inner = b.aggregate(NodeKind::kList, {b.sphere(1)}, red);
  const NodeId outer = b.aggregate(NodeKind::kList, {inner, b.sphere(2)}, b.surface(0.5));
  b.name("x", outer);
  b.scene.world = {b.aggregate(NodeKind::kList, {b.instance(0), b.sphere(3)}, red)};
  EXPECT_EQ(canonical_text(b.scene), surface_line(1, "1") + surface_line(2, "0.5") +
                                         "name aggregate list\n"
                                         "  sphere 1 1 2 3\n"
                                         "end\n"
                                         "name x_body list\n"
                                         "  object surface_1 aggregate\n"
                                         "  sphere 2 1 2 3\n"
                                         "end\n"
                                         "name x object surface_2 x_body\n"
                                         "applysurf surface_1\n"
                                         "list\n"
                                         "  object x\n"
                                         "  sphere 3 1 2 3\n"
                                         "end\n");
}

TEST(CanonicalTextTest, NumbersRoundTripAndAreAlwaysNumbers) {
  TextWriter out;
  for (const double v : {0.1, -0.5, 1e22, 1e-5, 1.0 / 3, 5e-324, 123456789.0, -0.0}) out.number(v);
  EXPECT_EQ(out.text(), "0.1 -0.5 1e+22 1e-05 0.3333333333333333 5e-324 123456789 -0");
  TextWriter odd;
  odd.number(std::numeric_limits<double>::infinity());
  odd.number(-std::numeric_limits<double>::infinity());
  odd.number(std::nan(""));
  EXPECT_EQ(odd.text(), "(1 / 0) (-1 / 0) (0 / 0)");
}

TEST(CanonicalTextTest, FileNamesAreQuotedWhereTheScannerNeedsIt) {
  const auto written = [](const std::string& name) {
    TextWriter out;
    out.file(name);
    return out.text();
  };
  for (const std::string name :
       {"x.rle", "./x", "../t/x.rle", "a/../b", "/usr/lib/y", "//h/y", "sphere.bmp", "./scale"}) {
    EXPECT_EQ(written(name), name);
  }
  for (const std::string name :
       {"scale", "x", "3d.rle", "./3d.rle", "a/1b", ".x", "~/x", "..", "a//b", "a b", "a+b", "", "/", "a/"}) {
    EXPECT_EQ(written(name), '"' + name + '"');
  }
}

TEST(CanonicalTextTest, DeepNestsDoNotOverflowTheStack) {
  Builder b;
  NodeId node = b.sphere(1);
  for (int i = 0; i < 100000; ++i) node = b.aggregate(NodeKind::kList, {node});
  b.scene.world = {node};
  const std::string text = canonical_text(b.scene);
  EXPECT_TRUE(text.ends_with("\nend\n"));
  EXPECT_EQ(b.scene.primitive_count(node), 1u);
}

TEST(SceneHashTest, TellsScenesApart) {
  Builder a, b, c;
  a.scene.world = {a.sphere(1)};
  b.scene.world = {b.sphere(1)};
  b.scene.nodes[0].location.line = 8;  // where something stands does not matter
  c.scene.world = {c.sphere(1.0000000000000002)};
  EXPECT_EQ(scene_hash(a.scene).size(), 32u);
  EXPECT_EQ(scene_hash(a.scene), scene_hash(b.scene));
  EXPECT_NE(scene_hash(a.scene), scene_hash(c.scene));
}

// The hash walks the scene in another form than the text; the two must tell the same scenes apart.
TEST(SceneHashTest, IsEqualExactlyWhereTheTextIs) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                   kInfinity = std::numeric_limits<double>::infinity();
  const auto payload = std::bit_cast<double>(std::bit_cast<std::uint64_t>(kNan) | 5);
  std::vector<Scene> scenes;
  for (const double value : {0.0, -0.0, 1.0, std::nextafter(1.0, 2.0), 10.0, 32.0, 0x1p-1074, kInfinity,
                             -kInfinity, kNan, -kNan, payload}) {
    Builder sphere, surface, transform, light;
    sphere.scene.world = {sphere.sphere(value)};
    surface.scene.world = {surface.sphere(1, surface.surface(value)), surface.sphere(1, surface.surface(1)),
                           surface.sphere(1, surface.surface(value))};
    transform.scene.world = {transform.sphere(1)};
    TransformList list;
    Affine map;
    map.rows[0].x = value;
    list.append(map);
    transform.transform(transform.scene.world[0], list);
    light.scene.lights.push_back(default_light());
    light.scene.lights[0].position.x = value;
    for (Builder* b : {&sphere, &surface, &transform, &light}) scenes.push_back(std::move(b->scene));
  }
  // Equal values of surfaces that stand apart, and what words alone tell apart.
  for (const char* name : {"a", "b", "a b", "a 1"}) {
    Builder b;
    b.scene.world = {b.sphere(1, b.surface(1)), b.sphere(1, b.surface(1)), b.sphere(1, b.surface(1))};
    b.scene.settings.output = name;
    scenes.push_back(std::move(b.scene));
  }
  int equal = 0;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const bool same = canonical_text(scenes[i]) == canonical_text(scenes[j]);
      EXPECT_EQ(scene_hash(scenes[i]) == scene_hash(scenes[j]), same)
          << canonical_text(scenes[i]) << canonical_text(scenes[j]);
      equal += same;
    }
  }
  EXPECT_GE(equal, 4 * 3);  // the NaNs of each kind
}

TEST(SceneTest, CountsInstancesFully) {
  Builder b;
  const NodeId pair = b.aggregate(NodeKind::kUnion, {b.sphere(1), b.sphere(2)});
  std::uint32_t name = b.name("x0", pair);
  const NodeId list = b.aggregate(NodeKind::kList, {b.instance(name), b.sphere(3), b.instance(name)});
  EXPECT_EQ(b.scene.primitive_count(pair), 2u);
  EXPECT_EQ(b.scene.primitive_count(list), 5u);
  // Doubling: 2^62 fits, then the count stays at 2^63.
  for (int i = 1; i < 62; ++i) {
    name = b.name("x", b.aggregate(NodeKind::kList, {b.instance(name), b.instance(name)}));
  }
  EXPECT_EQ(b.scene.primitive_count(b.scene.named_objects[name].node), std::uint64_t{1} << 62);
  for (int i = 0; i < 3; ++i) {
    name = b.name("x", b.aggregate(NodeKind::kList, {b.instance(name), b.instance(name)}));
    EXPECT_EQ(b.scene.primitive_count(b.scene.named_objects[name].node), std::uint64_t{1} << 63);
  }
}

TEST(SceneTest, DescribesPlaces) {
  Scene scene;
  EXPECT_EQ(scene.describe({12, 3, 0}), "stdin:12:3");
  scene.file_names = {"a.ray", "b.inc"};
  EXPECT_EQ(scene.describe({12, 3, 1}), "b.inc:12:3");
  EXPECT_EQ(scene.describe({12, 0, 0}), "a.ray:12");
  EXPECT_EQ(scene.describe({}), "a.ray");
}

TEST(SceneTest, DefaultLightComesFromTheRightFront) {
  const Light light = default_light();
  EXPECT_EQ(light.kind, LightKind::kDirectional);
  EXPECT_EQ(light.position, (Vec3{1, -1, 1}));
  EXPECT_EQ(light.intensity, (Color{1, 1, 1}));
  EXPECT_FALSE(light.no_shadow);
}

}  // namespace
}  // namespace rayshade
