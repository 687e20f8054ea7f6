// SPDX-License-Identifier: MIT
// Which of coincident surfaces is visible (objects.md 2 and 6.2), in every kind of container.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "rayshade/geometry/rank.h"
#include "rayshade/geometry/resolve.h"
#include "tests/unit/geometry/scene_builder.h"

namespace rayshade {
namespace {

using test::SceneBuilder;

using Make = std::function<NodeId(SceneBuilder&)>;
struct Shape {
  std::string name;
  Make make;
};

/// Each is met by the ray (0.1, 0.2, 5) + t (0, 0, -1) at a point that its copy shares exactly.
const std::vector<Shape>& strict_shapes() {
  static const std::vector<Shape> shapes{
      {"sphere",
       [](SceneBuilder& b) {
         return b.sphere(1, {0, 0, 0});
       }},
      {"box",
       [](SceneBuilder& b) {
         return b.box({-1, -1, -1}, {1, 1, 0});
       }},
      {"torus",
       [](SceneBuilder& b) {
         return b.torus(0.25, 0.25, {0, 0, 0}, {1, 0, 0});
       }},
      {"cylinder",
       [](SceneBuilder& b) {
         return b.cylinder(1, {-1, 0, 0}, {1, 0, 0});
       }},
      {"cone",
       [](SceneBuilder& b) {
         return b.cone(1, {-1, 0, 0}, 0.5, {1, 0, 0});
       }},
      {"blob",
       [](SceneBuilder& b) {
         return b.blob(0.3, {{1, 1, {0, 0, 0}}});
       }},
  };
  return shapes;
}

/// All in the plane z = 0.
const std::vector<Shape>& closed_shapes() {
  static const std::vector<Shape> shapes{
      {"disc",
       [](SceneBuilder& b) {
         return b.disc(1, {0, 0, 0}, {0, 0, 1});
       }},
      {"polygon",
       [](SceneBuilder& b) {
         return b.polygon({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}});
       }},
      {"triangle",
       [](SceneBuilder& b) {
         return b.triangle({-3, -3, 0}, {3, -3, 0}, {0, 3, 0});
       }},
  };
  return shapes;
}

const Make kPlane = [](SceneBuilder& b) { return b.plane({0, 0, 0}, {0, 0, 1}); };

/// Ways to put a pair into the world; `far` gives something out of the ray's way.
struct Container {
  std::string name;
  std::function<void(SceneBuilder&, NodeId, NodeId)> put;
};

const std::vector<Container>& containers() {
  static const std::vector<Container> all{
      {"the world", [](SceneBuilder& b, NodeId x, NodeId y) { b.show(x), b.show(y); }},
      {"a list",
       [](SceneBuilder& b, NodeId x, NodeId y) {
         b.show(b.list({x, y}));
       }},
      {"a grid",
       [](SceneBuilder& b, NodeId x, NodeId y) {
         b.show(b.grid({x, y}));
       }},
      {"nested lists",
       [](SceneBuilder& b, NodeId x, NodeId y) {
         b.show(b.list({b.list({b.grid({x}), b.list({y})})}));
       }},
      {"an object used once",
       [](SceneBuilder& b, NodeId x, NodeId y) {
         b.show(b.object(b.name(b.list({x, y}))));
       }},
      {"an object used twice",
       [](SceneBuilder& b, NodeId x, NodeId y) {
         const auto pair = b.name(b.list({x, y}));
         b.show(b.object(pair));
         b.show(b.moved(b.object(pair), translation({100, 0, 0})));
       }},
      {"two objects, each used twice",
       [](SceneBuilder& b, NodeId x, NodeId y) {
         const auto first = b.name(b.list({x, b.sphere(0.1, {0, 50, 0})}));
         const auto second = b.name(b.list({y, b.sphere(0.1, {0, 50, 1})}));
         b.show(b.moved(b.object(first), translation({100, 0, 0})));
         b.show(b.object(first));
         b.show(b.object(second));
         b.show(b.moved(b.object(second), translation({100, 0, 0})));
       }},
      {"two list members of an object used twice", [](SceneBuilder& b, NodeId x, NodeId y) {
         const auto pair = b.name(b.list({b.list({x}), b.grid({y})}));
         b.show(b.list({b.object(pair), b.moved(b.object(pair), translation({100, 0, 0}))}));
       }}};
  return all;
}

/// 1 or 2: the visible one; checks that all intersectors agree, with and without company.
int visible(const Container& container, const Make& first, const Make& second) {
  int winner = 0;
  for (const int company : {0, 12}) {
    SceneBuilder b;
    const auto surface = [](double red) {
      Surface s;
      s.diffuse = {red, 0, 0};
      return s;
    };
    for (int i = 0; i < company; i += 2) b.show(b.sphere(0.1, {10.0 + i, 0, 0}));
    const NodeId x = b.surfaced(first(b), surface(1)), y = b.surfaced(second(b), surface(2));
    container.put(b, x, y);
    for (int i = 0; i < company; i += 2) b.show(b.sphere(0.1, {0, 10.0 + i, 0}));
    const auto scene = b.compile();
    const Ray ray{{0.1, 0.2, 5}, {0, 0, -1}};
    TraceScratch scratch;
    for (const auto& intersector : {make_brute_force(*scene), make_hierarchy(*scene)}) {
      const NearestAnswer answer = test::nearest(*intersector, ray, scratch);
      EXPECT_TRUE(answer.found);
      if (!answer.found) return 0;
      const int seen = static_cast<int>(surface_of(*scene, answer.hit).diffuse.r);
      EXPECT_TRUE(winner == 0 || seen == winner) << "in " << container.name;
      winner = seen;
    }
  }
  return winner;
}

TEST(Ranks, CoincidentSolidsShowTheLaterOne) {
  for (const Container& container : containers()) {
    for (const Shape& shape : strict_shapes()) {
      EXPECT_EQ(visible(container, shape.make, shape.make), 2) << shape.name << " in " << container.name;
    }
  }
}

TEST(Ranks, CoincidentFlatShapesShowTheEarlierOne) {
  for (const Container& container : containers()) {
    for (const Shape& a : closed_shapes()) {
      for (const Shape& b : closed_shapes()) {
        EXPECT_EQ(visible(container, a.make, b.make), 1)
            << a.name << ", " << b.name << " in " << container.name;
      }
    }
  }
}

TEST(Ranks, CoincidentPlanesShowTheEarlierOne) {
  const Make as_list = [](SceneBuilder& b) { return b.list({kPlane(b)}); };
  const Make as_instance = [](SceneBuilder& b) { return b.object(b.name(kPlane(b))); };
  for (const Container& container : containers()) {
    EXPECT_EQ(visible(container, kPlane, kPlane), 1) << container.name;
    EXPECT_EQ(visible(container, as_list, kPlane), 1) << container.name;
    EXPECT_EQ(visible(container, kPlane, as_instance), 1) << container.name;
  }
}

TEST(Ranks, FlatShapesWinOverEverythingElse) {
  const Make box = strict_shapes()[1].make;
  for (const Container& container : containers()) {
    for (const Shape& flat : closed_shapes()) {
      EXPECT_EQ(visible(container, flat.make, kPlane), 1) << flat.name << " in " << container.name;
      EXPECT_EQ(visible(container, kPlane, flat.make), 2) << flat.name << " in " << container.name;
      EXPECT_EQ(visible(container, flat.make, box), 1) << flat.name << " in " << container.name;
      EXPECT_EQ(visible(container, box, flat.make), 2) << flat.name << " in " << container.name;
    }
  }
}

TEST(Ranks, PlanesWinOverBoundedSolids) {
  const Make box = strict_shapes()[1].make;
  for (const Container& container : containers()) {
    if (container.name == "two objects, each used twice")
      continue;  // there, both members are unbounded lists
    EXPECT_EQ(visible(container, kPlane, box), 1) << container.name;
    EXPECT_EQ(visible(container, box, kPlane), 2) << container.name;
  }
}

/// The upper test of CSG is closed, so it takes equal hits from solids, and the first of two is tested last.
TEST(Ranks, CsgIsClosed) {
  const Make csg = [](SceneBuilder& b) {
    return b.unite({b.box({-1, -1, -1}, {1, 1, 0}), b.sphere(0.1, {5, 5, 5})});
  };
  const Make box = strict_shapes()[1].make;
  for (const Container& container : containers()) {
    EXPECT_EQ(visible(container, csg, box), 1) << container.name;
    EXPECT_EQ(visible(container, box, csg), 2) << container.name;
    EXPECT_EQ(visible(container, csg, csg), 1) << container.name;
  }
}

/// A list with a plane in it counts as unbounded (objects.md 6.8, FIX): its bounded members, too, are tested
/// with the unbounded ones of the list around.
TEST(Ranks, MixedListsAreTestedWithTheUnboundedOnes) {
  const Make box = strict_shapes()[1].make;
  const Make mixed = [&](SceneBuilder& b) {
    const NodeId inside = box(b);
    return b.list({inside, b.plane({0, 0, -5}, {0, 0, 1})});
  };
  const Container& world = containers()[0];
  EXPECT_EQ(visible(world, mixed, box), 1);
  EXPECT_EQ(visible(world, box, mixed), 2);
  EXPECT_EQ(visible(world, mixed, mixed), 1);
}

/// objects.md 2, upper test: at exactly the far limit flat shapes and CSG count, others do not.
TEST(Ranks, FarLimit) {
  const auto seen = [](const Make& make) {
    SceneBuilder b;
    b.show(make(b));
    const auto scene = b.compile();
    TraceScratch scratch;
    const Ray ray{{0.125, 0.25, 5}, {0, 0, -1}};
    const auto hierarchy = make_hierarchy(*scene);
    const double t = test::nearest(*hierarchy, ray, scratch).hit.t();
    const bool hit = test::nearest(*hierarchy, ray, scratch, kEpsilon, t).found;
    EXPECT_EQ(test::occluded(*hierarchy, ray, scratch, kEpsilon, t), hit);
    EXPECT_TRUE(test::nearest(*hierarchy, ray, scratch, kEpsilon, std::nextafter(t, 10)).found);
    EXPECT_FALSE(test::nearest(*hierarchy, ray, scratch, kEpsilon, std::nextafter(t, 0)).found);
    return hit;
  };
  for (const Shape& shape : strict_shapes()) EXPECT_FALSE(seen(shape.make)) << shape.name;
  EXPECT_FALSE(seen(kPlane));
  for (const Shape& shape : closed_shapes()) EXPECT_TRUE(seen(shape.make)) << shape.name;
  EXPECT_TRUE(seen([](SceneBuilder& b) {
    return b.unite({b.sphere(1, {0, 0, 0}), b.sphere(0.1, {5, 5, 5})});
  }));
  // Through an instance, too.
  EXPECT_FALSE(seen([](SceneBuilder& b) {
    const auto twice = b.name(b.list({b.sphere(1, {0, 0, 0}), b.sphere(1, {30, 0, 0})}));
    b.show(b.moved(b.object(twice), translation({0, 60, 0})));
    return b.object(twice);
  }));
}

TEST(Ranks, OrderAsNumbers) {
  EXPECT_LT(rank_of(LeafKind::kDisc, 7), rank_of(LeafKind::kDisc, 6));
  EXPECT_LT(rank_of(LeafKind::kSphere, 6), rank_of(LeafKind::kSphere, 7));
  EXPECT_LT(rank_of(LeafKind::kCsg, 0), rank_of(LeafKind::kPlane, 0));
  EXPECT_LT(rank_of(LeafKind::kTriangle, kOrderLimit - 1), kFirstStrictRank);
  EXPECT_GE(rank_of(LeafKind::kHeightField, 0), kFirstStrictRank);
}

}  // namespace
}  // namespace rayshade
