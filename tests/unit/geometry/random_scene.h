// SPDX-License-Identifier: MIT
// Random scenes with everything in them, for comparing intersectors.
#pragma once

#include "tests/unit/geometry/scene_builder.h"

namespace rayshade::test {

struct RandomScene {
  SceneBuilder b;
  Dice dice;
  std::vector<std::uint32_t> names;
  bool motion = false;

  explicit RandomScene(std::uint64_t seed) : dice(seed) {
    std::vector<float> altitudes;
    for (int i = 0; i < 36; ++i)
      altitudes.push_back(i == 8 ? -2000.0f : static_cast<float>(dice.uniform(0, 0.5)));
    b.files.add("field", height_field_bytes(6, altitudes));
  }

  Vec3 snapped(double half) {
    // Many coordinates in common make coincident faces and ties.
    Vec3 p = dice.in_box(half);
    if (dice.below(2)) p = {std::floor(p.x * 2) / 2, std::floor(p.y * 2) / 2, std::floor(p.z * 2) / 2};
    return p;
  }

  NodeId primitive(double half) {
    const Vec3 c = snapped(half);
    const double r = dice.uniform(0.1, 0.8);
    const Vec3 d = dice.direction();
    switch (dice.below(13)) {
      case 0:
      case 1:
        return b.sphere(r, c);
      case 2:
      case 3:
        return b.box(c, c + Vec3{r, 0.5, r});
      case 4:
        return b.disc(r, c, dice.below(2) ? Vec3{0, 0, 1} : d);
      case 5:
        return b.cylinder(r, c, c + d);
      case 6:
        return b.cone(r, c, r / 3, c + d);
      case 7:
        return b.torus(r, r * dice.uniform(0.1, 1.2), c, d);
      case 8:
        return b.triangle(c, c + dice.direction(), c + dice.direction());
      case 9: {
        const Vec3 p[3] = {c, c + Vec3{1, 0, 0}, c + Vec3{0, 1, dice.uniform(-1, 1)}};
        const Vec3 n[3] = {{0, 0, 1}, {0.3, 0, 1}, {0, 0.3, 1}};
        return b.smooth_triangle(p, n);
      }
      case 10:
        return b.polygon({c, c + Vec3{1, 0, 0}, c + Vec3{1, 1, 0}, c + Vec3{0.3, 0.4, 0}});
      case 11:
        return b.blob(0.4, {{1, r, c}, {1, r, c + 0.5 * d}});
      default:
        return b.moved(b.height_field("field"), translation(c));
    }
  }

  Affine transform() {
    Affine map;
    if (dice.below(2))
      map = then(map, scaling({dice.uniform(0.3, 2), dice.uniform(0.3, 2), dice.uniform(-2, -0.3)}));
    if (dice.below(2)) map = then(map, about(dice.direction(), dice.uniform(0, 360)));
    return then(map, translation(dice.in_box(1)));
  }

  NodeId decorated(NodeId id, bool aggregate) {
    const bool has_transform = b.scene.nodes[id].transform != kNone;
    if (dice.below(aggregate ? 3 : 4) == 0 && !has_transform) b.moved(id, transform());
    if (motion && dice.below(8) == 0) b.moving(id, dice.in_box(0.5), dice.in_box(1));
    if (motion && dice.below(12) == 0) b.turning(id, dice.direction(), dice.uniform(-300, 300));
    if (dice.below(5) == 0) b.transparent(id, dice.below(2) ? 0.0 : 0.7);
    return id;
  }

  NodeId any(int depth, double half) {
    const int kind = depth <= 0 ? 0 : dice.below(10);
    if (kind < 4) return decorated(primitive(half), false);
    if (kind == 4 && !names.empty()) {
      return decorated(b.object(names[static_cast<std::size_t>(dice.below(static_cast<int>(names.size())))]),
                       true);
    }
    std::vector<NodeId> members;
    const bool csg = kind >= 7;
    const int count = csg ? (dice.below(6) == 0 ? 3 : 2) : 1 + dice.below(7);
    for (int i = 0; i < count; ++i) members.push_back(any(depth - 1, half * 0.8));
    if (!csg && dice.below(4) == 0) {  // a coincident copy
      const NodeId copy = members[0];
      b.scene.nodes.push_back(b.scene.nodes[copy]);
      members.push_back(static_cast<NodeId>(b.scene.nodes.size() - 1));
    }
    if (!csg && dice.below(12) == 0) members.push_back(b.plane(snapped(half), {0, 0, 1}));
    static constexpr NodeKind kCsg[] = {NodeKind::kUnion, NodeKind::kIntersect, NodeKind::kDifference};
    const NodeId id = b.aggregate(csg             ? kCsg[dice.below(3)]
                                  : dice.below(2) ? NodeKind::kList
                                                  : NodeKind::kGrid,
                                  members);
    return decorated(id, true);
  }

  /// A scene of about `objects` objects in the box +-half.
  void fill(int objects, double half) {
    for (int i = 0; i < objects; ++i) {
      if (dice.below(5) == 0) names.push_back(b.name(any(3, half * 0.4)));
      b.show(any(3, half));
    }
    if (dice.below(2)) b.show(b.plane({0, 0, -half}, {0, 0, 1}));
  }

  Ray ray(double half) {
    Ray r;
    r.origin = dice.in_box(dice.below(4) ? half : 20 * half);
    r.direction = dice.below(8) ? normalize(dice.in_box(half) - r.origin) : Vec3{0, 0, -1};
    if (dice.below(12) == 0) {
      r.origin = snapped(half);
      r.direction = dice.below(2) ? Vec3{1, 0, 0} : normalize(Vec3{1, 0, 1});
    }
    r.time = dice.uniform(0, 1);
    return r;
  }
};

}  // namespace rayshade::test
