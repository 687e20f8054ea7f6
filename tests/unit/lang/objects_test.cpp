// SPDX-License-Identifier: MIT
// Primitives, aggregates, names and surfaces (language.md 3.6, 3.7, 5, 9; objects.md 4, 6, 7).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "parse_text.h"

namespace rayshade {
namespace {

using test::all_messages;
using test::count;
using test::parse_text;
using testing::HasSubstr;

TEST(Primitives, HoldWhatWasWritten) {
  const ParseResult result = parse_text(
      "plane 1 2 3 4 5 6 sphere 1 2 3 4 box 4 1 9 1 5 6 disc 1 2 3 4 5 6 7 cylinder 1 2 3 4 5 6 7 cone 1 2 3 "
      "4 5 6 7 8 "
      "torus 2 1 3 4 5 6 7 8 triangle 0 0 0 1 0 0 0 1 0 triangle 0 0 0 0 0 1 1 0 0 0 0 2 0 1 0 0 0 3 "
      "triangleuv 0 0 0 0 0 1 .1 .2 1 0 0 0 0 1 .3 .4 0 1 0 0 0 1 .5 .6 poly 0 0 0 1 0 0 1 1 0 0 1 0 "
      "polygon 0 0 0 1 0 0 1 1 0 blob .5 1 2 3 4 5 6 7 8 9 10 heightfield data/field");
  ASSERT_TRUE(result.ok) << all_messages(result);
  EXPECT_TRUE(result.diagnostics.empty()) << all_messages(result);
  const Scene& s = result.scene;
  EXPECT_EQ(s.world.size(), 14u);
  EXPECT_EQ(s.planes[0].normal, (Vec3{4, 5, 6}));
  EXPECT_EQ(s.spheres[0].radius, 1);
  EXPECT_EQ(s.spheres[0].center, (Vec3{2, 3, 4}));
  EXPECT_EQ(s.boxes[0].lo, (Vec3{1, 1, 6}));
  EXPECT_EQ(s.boxes[0].hi, (Vec3{4, 5, 9}));
  EXPECT_EQ(s.discs[0].normal, (Vec3{5, 6, 7}));
  EXPECT_EQ(s.cylinders[0].top, (Vec3{5, 6, 7}));
  EXPECT_EQ(s.cones[0].top_radius, 5);
  EXPECT_EQ(s.cones[0].top, (Vec3{6, 7, 8}));
  EXPECT_EQ(s.tori[0].swept, 2);
  EXPECT_EQ(s.tori[0].axis, (Vec3{6, 7, 8}));
  EXPECT_EQ(s.triangles[0].p[2], (Vec3{0, 1, 0}));
  EXPECT_EQ(s.smooth_triangles[0].n[1], (Vec3{0, 0, 2}));
  EXPECT_EQ(s.uv_triangles[0].u[1], .3);
  EXPECT_EQ(s.uv_triangles[0].v[2], .6);
  EXPECT_EQ(s.polygons[0].points[1], (Vec3{1, 0, 0}));
  EXPECT_EQ(s.polygons.size(), 2u);
  EXPECT_EQ(s.blobs[0].threshold, .5);
  ASSERT_EQ(s.blobs[0].balls.size(), 2u);
  EXPECT_EQ(s.blobs[0].balls[1].strength, 6);
  EXPECT_EQ(s.blobs[0].balls[1].center, (Vec3{8, 9, 10}));
  EXPECT_EQ(s.height_fields[0].file.name, "data/field");
}

TEST(Primitives, ThatAreDegenerateAreDroppedWithAMessage) {
  const std::pair<const char*, Severity> table[] = {
      {"sphere 0 0 0 0", Severity::kWarning},
      {"sphere -1 0 0 0", Severity::kWarning},
      {"disc 0 0 0 0 0 0 1", Severity::kWarning},
      {"disc 1 0 0 0 0 0 0", Severity::kWarning},
      {"plane 0 0 0 0 0 0", Severity::kWarning},
      {"torus 0 1 0 0 0 0 0 1", Severity::kWarning},
      {"torus 1 0 0 0 0 0 0 1", Severity::kWarning},
      {"torus 1 1 0 0 0 0 0 0", Severity::kWarning},
      {"cylinder 0 0 0 0 0 0 1", Severity::kWarning},
      {"cylinder 1 0 0 1 0 0 1", Severity::kWarning},
      {"cone 1 0 0 1 2 0 0 1", Severity::kWarning},
      {"cone 0 0 0 0 0 0 0 1", Severity::kWarning},
      {"box 0 0 0 1 1 0", Severity::kWarning},
      {"box 0 0 0 0 1 1", Severity::kWarning},
      {"triangle 0 0 0 1 1 1 2 2 2", Severity::kAdvice},
      {"triangle .1 .2 .3 .2 .4 .6 .3 .6 .9", Severity::kAdvice},
      {"triangle 0 0 0 0 0 1 0 0 0 0 0 1 0 0 0 0 0 1", Severity::kAdvice},
      {"triangle 0 0 0 0 0 1 1 0 0 0 0 0 0 1 0 0 0 1", Severity::kWarning},
      {"poly 0 0 0 1 0 0", Severity::kWarning},
      {"poly", Severity::kWarning},
      {"poly 0 0 0 1 1 1 3 3 3 4 4 4", Severity::kWarning},
      {"poly 0 0 0 1 1 0 1 0 0 0 1 0", Severity::kWarning},
      {"blob 1", Severity::kWarning},
      {"blob 1 0 1 0 0 0", Severity::kWarning},
      {"blob 1 1 1 0 0 0 1 -1 0 0 0", Severity::kWarning},
      {"sphere 1e200 0 0 0 scale 2 2 2 texture wood", Severity::kNote}};
  for (const auto& [text, severity] : table) {
    const ParseResult result =
        parse_text(std::string(text) + " texture wood translate 1 1 1\nsphere 1 0 0 0");
    EXPECT_TRUE(result.ok) << text << all_messages(result);
    if (severity == Severity::kNote) continue;  // kept: nothing says it is degenerate
    EXPECT_EQ(result.scene.world.size(), 1u) << text;
    ASSERT_EQ(result.diagnostics.size(), 1u) << text;
    EXPECT_EQ(result.diagnostics[0].severity, severity) << text;
    EXPECT_EQ(result.diagnostics[0].location.line, 1u) << text;
    EXPECT_EQ(result.diagnostics[0].location.column, 1u) << text;
  }
}

TEST(Primitives, OfAnyScaleAreKept) {
  for (const std::string e : {"e-9", "e-60", "e60"}) {
    const ParseResult result =
        parse_text("sphere 1" + e + " 0 0 0 box 0 0 0 1" + e + " 1" + e + " 1" + e + " triangle 0 0 0 1" + e +
                   " 0 0 0 1" + e + " 0 poly 0 0 0 1" + e + " 0 0 0 1" + e + " 0 cylinder 1" + e +
                   " 0 0 0 0 0 1" + e + " disc 1" + e + " 0 0 0 0 0 1" + e + " cone 1" + e + " 0 0 0 2" + e +
                   " 0 0 1" + e + " torus 2" + e + " 1" + e + " 0 0 0 0 0 1" + e);
    EXPECT_TRUE(result.diagnostics.empty()) << all_messages(result);
    EXPECT_EQ(result.scene.world.size(), 8u);
    EXPECT_EQ(result.scene.cones.size(), 1u);
  }
}

TEST(Primitives, ConesWithEqualRadiiAreCylinders) {
  EXPECT_EQ(parse_text("cone 2 0 0 0 2 0 0 1").scene.cylinders.size(), 1u);
  EXPECT_EQ(parse_text("cone 2 0 0 0 2.000009 0 0 1").scene.cylinders[0].radius, 2);
  EXPECT_EQ(parse_text("cone 2 0 0 0 2.00002 0 0 1").scene.cones.size(), 1u);
  EXPECT_EQ(parse_text("cone 1e-7 0 0 0 2e-7 0 0 1").scene.cones.size(), 1u);
  EXPECT_EQ(parse_text("cone -1 0 0 0 1 0 0 1").scene.cones.size(), 1u);
}

TEST(Primitives, WithInconsistentNormalsAreKeptWithAdvice) {
  const std::string text = "triangle 0 0 0 0 0 -1 1 0 0 0 0 1 0 1 0 0 0 1";
  EXPECT_EQ(count(parse_text(text), Severity::kAdvice), 1);
  EXPECT_EQ(parse_text(text).scene.smooth_triangles.size(), 1u);
  ParseOptions flip;
  flip.flip_normals = true;
  EXPECT_TRUE(parse_text(text, flip).diagnostics.empty());
}

TEST(Primitives, WithBrokenListsAreErrors) {
  for (const char* text :
       {"poly 0 0 0 1 0 0 0 1 0 5", "blob 1 1 1 0 0", "triangle 0 0 0 1 0 0", "sphere 1 0 0",
        "triangle 0 0 0 1 0 0 0 1 0 0 0 1", "sphere 1 0 0 0 0", "heightfield", "triangleuv 0 0 0",
        "sphere red blue 1 0 0 0", "sphere 1 0 0 0 texture wood translate 1 1"}) {
    EXPECT_FALSE(parse_text(text).ok) << text;
  }
}

/// The kinds of the top-level nodes.
std::vector<NodeKind> kinds(const Scene& scene) {
  std::vector<NodeKind> out;
  for (const NodeId id : scene.world) out.push_back(scene.nodes[id].kind);
  return out;
}

TEST(Aggregates, HoldTheirMembersInOrder) {
  const ParseResult result = parse_text(
      "list sphere 1 0 0 0 list box 0 0 0 1 1 1 end plane 0 0 0 0 0 1 end grid 2 3 4 sphere 2 0 0 0 end "
      "difference sphere 3 0 0 0 sphere 4 0 0 0 end union sphere 1 0 0 0 sphere 1 0 0 0 sphere 1 0 0 0 end "
      "intersect box 0 0 0 1 1 1 name x sphere 1 0 0 0 surface y applysurf y sphere 1 0 0 0 end");
  ASSERT_TRUE(result.ok) << all_messages(result);
  EXPECT_TRUE(result.diagnostics.empty()) << all_messages(result);
  const Scene& s = result.scene;
  EXPECT_EQ(kinds(s), (std::vector{NodeKind::kList, NodeKind::kGrid, NodeKind::kDifference, NodeKind::kUnion,
                                   NodeKind::kIntersect}));
  const Aggregate& list = s.aggregates[s.nodes[s.world[0]].payload];
  ASSERT_EQ(list.members.size(), 3u);
  EXPECT_EQ(s.nodes[list.members[0]].kind, NodeKind::kSphere);
  EXPECT_EQ(s.nodes[list.members[2]].kind, NodeKind::kPlane);
  const Aggregate& grid = s.aggregates[s.nodes[s.world[1]].payload];
  EXPECT_THAT(grid.grid, testing::ElementsAre(2, 3, 4));
  const Aggregate& difference = s.aggregates[s.nodes[s.world[2]].payload];
  EXPECT_EQ(s.spheres[s.nodes[difference.members[0]].payload].radius, 3);
  EXPECT_EQ(s.aggregates[s.nodes[s.world[3]].payload].members.size(), 3u);
  EXPECT_EQ(s.aggregates[s.nodes[s.world[4]].payload].members.size(), 2u);
}

TEST(Aggregates, OfOddCountsAreMended) {
  const ParseResult empty = parse_text("list end list sphere 0 0 0 0 end union end sphere 1 0 0 0");
  EXPECT_TRUE(empty.ok);
  EXPECT_EQ(empty.scene.world.size(), 1u);
  EXPECT_EQ(count(empty, Severity::kWarning), 4);

  const ParseResult one = parse_text("difference sphere 1 0 0 0 end translate 1 0 0");
  EXPECT_TRUE(one.ok);
  EXPECT_EQ(count(one, Severity::kWarning), 1);
  EXPECT_EQ(kinds(one.scene), std::vector{NodeKind::kList});
  EXPECT_NE(one.scene.nodes[one.scene.world[0]].transform, kNone);

  const ParseResult grid = parse_text("grid 0 -3 2.5 sphere 1 0 0 0 end");
  EXPECT_TRUE(grid.ok);
  EXPECT_EQ(count(grid, Severity::kWarning), 1);
  EXPECT_THAT(grid.scene.aggregates[0].grid, testing::ElementsAre(1, 1, 2));
}

TEST(Aggregates, AdviseOnceAboutOpenOperands) {
  const ParseResult result = parse_text(
      "union sphere 1 0 0 0 cylinder 1 0 0 0 0 0 1 end union disc 1 0 0 0 0 0 1 sphere 1 0 0 0 end\n"
      "union list plane 0 0 0 0 0 1 end sphere 1 0 0 0 end");
  EXPECT_EQ(count(result, Severity::kAdvice), 1);
  EXPECT_TRUE(parse_text("union list plane 0 0 0 0 0 1 end torus 2 1 0 0 0 0 0 1 end").diagnostics.empty());
}

TEST(Aggregates, HoldNothingButObjectsSurfacesAndNames) {
  for (const char* text :
       {"light 1 point 0 0 0", "define a 1", "print 1", "eyep 0 0 0", "screen 1 1", "atmosphere"}) {
    EXPECT_FALSE(parse_text(std::string("list sphere 1 0 0 0 ") + text + " end").ok) << text;
  }
}

TEST(Aggregates, ThatAreNotClosedNameTheirBeginning) {
  EXPECT_THAT(test::brief(parse_text("sphere 1 0 0 0\n list\nsphere 1 0 0 0\n")),
              testing::ElementsAre("3:15 error end of file, but this 'list' has no 'end' yet",
                                   "2:2 note the 'list' begins here"));
  EXPECT_THAT(all_messages(parse_text("sphere 1 0 0 0 end")), HasSubstr("closes nothing"));
}

TEST(Aggregates, NestTenThousandLevels) {
  const auto nested = [](int n) {
    std::string text;
    for (int i = 0; i < n; ++i) text += "list ";
    text += "sphere 1 0 0 0 ";
    for (int i = 0; i < n; ++i) text += "end ";
    return text;
  };
  EXPECT_TRUE(parse_text(nested(9000)).ok);
  EXPECT_THAT(all_messages(parse_text(nested(100000))),
              HasSubstr("1:50001: error: objects are nested more than"));
  std::string chain = "name a0 sphere 1 0 0 0\n";
  for (int i = 0; i < 12000; ++i)
    chain += "name a" + std::to_string(i + 1) + " object a" + std::to_string(i) + "\n";
  EXPECT_THAT(all_messages(parse_text(chain)), HasSubstr("nested more than"));
}

TEST(NamedObjects, AreFoundNewestFirst) {
  const ParseResult result =
      parse_text("name a sphere 1 0 0 0 object a list name a sphere 2 0 0 0 object a end object a");
  ASSERT_TRUE(result.ok) << all_messages(result);
  EXPECT_TRUE(result.diagnostics.empty());
  const Scene& s = result.scene;
  ASSERT_EQ(s.named_objects.size(), 2u);
  EXPECT_EQ(s.nodes[s.world[0]].payload, 0u);
  EXPECT_EQ(s.nodes[s.world[2]].payload, 1u);
  EXPECT_EQ(s.nodes[s.aggregates[0].members[0]].payload, 1u);
}

TEST(NamedObjects, MustBeDefinedBefore) {
  EXPECT_THAT(all_messages(parse_text("name chair sphere 1 0 0 0 object chiar")),
              HasSubstr("did you mean 'chair'?"));
  EXPECT_FALSE(parse_text("object a name a sphere 1 0 0 0").ok);
  EXPECT_FALSE(parse_text("name a list object a end").ok);
  // A degenerate object leaves its name undefined.
  EXPECT_FALSE(parse_text("name a sphere 0 0 0 0 object a").ok);
}

TEST(NamedObjects, AreToldWhenVerbose) {
  const ParseResult result =
      parse_text("name a sphere 1 0 0 0 report verbose name b list object a object a end");
  EXPECT_THAT(result.notes, testing::ElementsAre("list \"b\":\n\t2 primitives\n"));
  ParseOptions verbose;
  verbose.verbose = true;
  EXPECT_THAT(parse_text("name a sphere 1 0 0 0", verbose).notes,
              testing::ElementsAre("sphere \"a\":\n\t1 primitive \n"));
}

TEST(Surfaces, StartFromTheirDefaults) {
  const ParseResult result = parse_text("surface a sphere a 1 0 0 0 sphere diffuse 1 0 0 1 0 0 0");
  ASSERT_TRUE(result.ok);
  const Scene& s = result.scene;
  EXPECT_EQ(s.surfaces[s.nodes[s.world[0]].surface], Surface());
  Surface red;
  red.diffuse = {1, 0, 0};
  EXPECT_EQ(s.surfaces[s.nodes[s.world[1]].surface], red);
  EXPECT_EQ(red.specular_exponent, 15);
  EXPECT_EQ(red.body, (Color{1, 1, 1}));
}

TEST(Surfaces, HaveAllComponents) {
  const ParseResult result = parse_text(
      "sphere ambient 1 2 3 diffuse 4 5 6 specular 7 8 9 body 1 2 3 specpow 4 reflect 5 transp 6 index 7 "
      "extinct 8 "
      "translu .5 1 2 3 4 noshadow ambient 9 9 9 1 0 0 0");
  ASSERT_TRUE(result.ok) << all_messages(result);
  const Surface& s = result.scene.surfaces[0];
  EXPECT_EQ(s.ambient, (Color{9, 9, 9}));
  EXPECT_EQ(s.diffuse, (Color{4, 5, 6}));
  EXPECT_EQ(s.specular, (Color{7, 8, 9}));
  EXPECT_EQ(s.body, (Color{1, 2, 3}));
  EXPECT_EQ(s.specular_exponent, 4);
  EXPECT_EQ(s.reflectance, 5);
  EXPECT_EQ(s.transparency, 6);
  EXPECT_EQ(s.index, 7);
  EXPECT_EQ(s.extinction, 8);
  EXPECT_EQ(s.translucency, .5);
  EXPECT_EQ(s.translucent, (Color{1, 2, 3}));
  EXPECT_EQ(s.transmitted_exponent, 4);
  EXPECT_TRUE(s.no_shadow);
  EXPECT_TRUE(parse_text("surface a reflective 1 transparent 1 translucency 1 1 1 1 1").ok);
}

TEST(Surfaces, AreCopiedNotShared) {
  const ParseResult result = parse_text(
      "surface a diffuse 1 0 0 surface b a reflect .5 sphere a specpow 3 1 0 0 0 sphere a 1 0 0 0 sphere b 1 "
      "0 0 0\n"
      "surface a diffuse 0 1 0 sphere a 1 0 0 0");
  EXPECT_TRUE(result.ok);
  EXPECT_EQ(count(result, Severity::kWarning), 1);
  const Scene& s = result.scene;
  const auto surface = [&](std::size_t i) { return s.surfaces[s.nodes[s.world[i]].surface]; };
  EXPECT_EQ(surface(0).specular_exponent, 3);
  EXPECT_EQ(surface(1).specular_exponent, 15);
  EXPECT_EQ(surface(1).reflectance, 0);
  EXPECT_EQ(surface(2).reflectance, .5);
  EXPECT_EQ(surface(2).diffuse, (Color{1, 0, 0}));
  EXPECT_EQ(surface(3).diffuse, (Color{0, 1, 0}));
}

TEST(Surfaces, NeedAnIndexToBeTransparent) {
  EXPECT_FALSE(parse_text("surface a transp .5 index 0").ok);
  EXPECT_FALSE(parse_text("sphere transp .5 index -1 1 0 0 0").ok);
  EXPECT_TRUE(parse_text("surface a index 0 transp .000001").ok);
  EXPECT_THAT(all_messages(parse_text("surface red sphere rde 1 0 0 0")), HasSubstr("did you mean 'red'?"));
}

/// What a node is bound to: "red", "green", "default", or "none".
std::string bound(const Scene& scene, NodeId id) {
  const std::uint32_t index = scene.nodes[id].surface;
  if (index == kNone) return "none";
  const Surface& s = scene.surfaces[index];
  if (s == default_surface()) return "default";
  return s.diffuse == Color{1, 0, 0} ? "red" : s.diffuse == Color{0, 1, 0} ? "green" : "other";
}
NodeId member(const Scene& scene, NodeId aggregate, std::size_t i) {
  return scene.aggregates[scene.nodes[aggregate].payload].members[i];
}

TEST(SurfaceBinding, FollowsTheScopes) {
  const std::string head = "surface red diffuse 1 0 0 surface green diffuse 0 1 0 ";
  const auto parse = [&](const std::string& text) {
    ParseResult result = parse_text(head + text);
    EXPECT_TRUE(result.ok) << text << all_messages(result);
    return std::move(result.scene);
  };
  Scene s = parse("sphere 1 0 0 0 applysurf red sphere 1 0 0 0 sphere green 1 0 0 0 heightfield f");
  EXPECT_EQ(bound(s, s.world[0]), "none");
  EXPECT_EQ(bound(s, s.world[1]), "red");
  EXPECT_EQ(bound(s, s.world[2]), "green");
  EXPECT_EQ(bound(s, s.world[3]), "red");

  s = parse("applysurf red list sphere 1 0 0 0 applysurf green sphere 1 0 0 0 end sphere 1 0 0 0");
  EXPECT_EQ(bound(s, s.world[0]), "red");
  EXPECT_EQ(bound(s, member(s, s.world[0], 0)), "none");
  EXPECT_EQ(bound(s, member(s, s.world[0], 1)), "green");
  EXPECT_EQ(bound(s, s.world[1]), "red");

  s = parse("list sphere 1 0 0 0 end applysurf red");
  EXPECT_EQ(bound(s, s.world[0]), "none");

  s = parse(
      "applysurf red list applysurf cursurf sphere 1 0 0 0 end sphere cursurf 1 0 0 0 sphere cursurf reflect "
      "1 1 0 0 0");
  EXPECT_EQ(bound(s, member(s, s.world[0], 0)), "default");
  EXPECT_EQ(bound(s, s.world[1]), "red");
  EXPECT_EQ(s.surfaces[s.nodes[s.world[2]].surface].reflectance, 1);
  EXPECT_EQ(bound(s, s.world[2]), "red");

  s = parse("applysurf green name x list sphere 1 0 0 0 end object red x object x");
  EXPECT_EQ(bound(s, s.named_objects[0].node), "green");
  EXPECT_EQ(bound(s, s.world[0]), "red");
  EXPECT_EQ(bound(s, s.world[1]), "green");

  s = parse("name x sphere 1 0 0 0 applysurf red object x");
  EXPECT_EQ(bound(s, s.named_objects[0].node), "none");
  EXPECT_EQ(bound(s, s.world[0]), "red");
}

TEST(SurfaceBinding, TellsNamesOfSurfacesFromFilesAndObjects) {
  const ParseResult result = parse_text(
      "surface red diffuse 1 0 0 name x sphere 1 0 0 0 heightfield red file heightfield file object red x "
      "object x "
      "heightfield red diffuse 0 1 0 file heightfield diffuse 0 1 0 file object diffuse 1 1 1 x");
  EXPECT_TRUE(result.ok) << all_messages(result);
  EXPECT_EQ(result.scene.height_fields.size(), 4u);
}

}  // namespace
}  // namespace rayshade
