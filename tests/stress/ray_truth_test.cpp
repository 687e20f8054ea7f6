// SPDX-License-Identifier: MIT
// The truth of single rays for every shape (ray_trial.h).
#include "tests/stress/ray_trial.h"
#include "tests/stress/truth_references.h"

namespace rayshade::stress {
namespace {

double any_scale(Dice& dice) { return std::pow(10.0, dice.below(3) ? 0 : dice.uniform(-6, 6)); }

void all_shapes(const std::string& name, int shapes) {
  Report report(name, shapes);
  const auto place = [](Dice& dice, double s) {
    return s * (dice.below(2) ? 1 : std::pow(10.0, dice.uniform(0, 6))) * dice.in_box(1);
  };
  report.run("sphere", {4, 2, 3, 200}, 1, [&](SceneBuilder& b, Dice& dice, Subject& subject) {
    const double s = any_scale(dice);
    const shape::Sphere sphere{s, place(dice, s)};
    subject = {sphere.center, s, 1, {}};
    return std::pair{b.sphere(sphere.radius, sphere.center), Sphere(sphere)};
  });
  report.run("box", {4, 2, 3, 200}, 1, [&](SceneBuilder& b, Dice& dice, Subject& subject) {
    const double s = any_scale(dice);
    const Vec3 lo = place(dice, s);
    const shape::Box box{lo, lo + s * Vec3{dice.uniform(.2, 1), dice.uniform(.2, 1), dice.uniform(.2, 1)}};
    subject = {.5 * (box.lo + box.hi),
               .6 * s,
               1,
               {box.lo, box.hi, {box.lo.x, box.hi.y, .5 * (box.lo.z + box.hi.z)}}};
    return std::pair{b.box(box.lo, box.hi), quad::Box(box)};
  });
  report.run("plane", {4, 4, 3, 200}, 1, [&](SceneBuilder& b, Dice& dice, Subject& subject) {
    const double s = any_scale(dice);
    const shape::Plane plane{place(dice, s), dice.direction()};
    subject = {plane.point, s, 1, {}};
    return std::pair{b.plane(plane.point, plane.normal), Plane(plane)};
  });
  report.run("disc", {4, 3, 3, 200}, 1, [&](SceneBuilder& b, Dice& dice, Subject& subject) {
    const double s = any_scale(dice);
    const shape::Disc disc{s, place(dice, s), dice.direction()};
    subject = {disc.center, s, 1, {}};
    return std::pair{b.disc(disc.radius, disc.center, disc.normal), Disc(disc)};
  });
  const auto triangle = [&](double thinnest) {
    return [=](SceneBuilder& b, Dice& dice, Subject& subject) {
      const double s = any_scale(dice);
      const Vec3 at = place(dice, s), along = s * dice.direction(), across = s * dice.direction();
      const double thin = std::pow(10.0, -dice.uniform(0, thinnest));
      const Vec3 p[3] = {at, at + along, at + dice.uniform(.1, .9) * along + thin * across};
      const Vec3 e1 = p[1] - p[0], e2 = p[2] - p[1];
      // What the roundings of the corners cost the plane.
      const double turned = length(e1) * length(e2) / length(cross(e1, e2));
      subject = {
          (p[0] + p[1] + p[2]) / 3, s, turned, {p[0], p[1], p[2], .5 * (p[0] + p[1]), .5 * (p[1] + p[2])}};
      return std::pair{b.triangle(p[0], p[1], p[2]), Triangle(p)};
    };
  };
  report.run("triangle", {4, 2, 3, 200}, 1, triangle(.5));
  report.run("needle triangle", {4, 2, 3, 200}, 1, triangle(5));
  report.run("polygon", {4, 3, 3, 200}, 1, [&](SceneBuilder& b, Dice& dice, Subject& subject) {
    const double s = any_scale(dice);
    const Vec3 at = place(dice, s);
    Vec3 e1, e2;
    coordinate_system(dice.direction(), e1, e2);
    std::vector<Vec3> points;
    const int count = 3 + dice.below(20);
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * fn::kPi * i / count, radius = s * dice.uniform(.3, 1);
      points.push_back(at + radius * (fn::cos(angle) * e1 + fn::sin(angle) * e2));
    }
    subject = {at, s, 1, points};
    return std::pair{b.polygon(points), Polygon(points)};
  });
  const auto axis = [](Dice& dice) {
    if (dice.below(3) == 0) return Vec3{0, 0, dice.below(2) ? 1.0 : -1.0};
    if (dice.below(3) == 0)
      return normalize(Vec3{0, 0, 1} + std::pow(10.0, -dice.uniform(2, 12)) * dice.direction());
    return dice.direction();
  };
  report.run("cylinder", {6, 2, 3, 200}, 1, [&](SceneBuilder& b, Dice& dice, Subject& subject) {
    const double s = any_scale(dice);
    const Vec3 bottom = place(dice, s), top = bottom + s * axis(dice);
    const shape::Cylinder cylinder{s * dice.uniform(.1, 1), bottom, top};
    subject = {.5 * (bottom + top), s, 1, {}};
    return std::pair{b.cylinder(cylinder.radius, bottom, top), Wall(cylinder)};
  });
  report.run("cone, some nearly a cylinder", {8, 2, 3, 200}, 1,
             [&](SceneBuilder& b, Dice& dice, Subject& subject) {
               const double s = any_scale(dice);
               const Vec3 bottom = place(dice, s), top = bottom + s * axis(dice);
               const double r = s * dice.uniform(.2, 1);
               const double other = dice.below(3) == 0   ? 0
                                    : dice.below(2) == 0 ? r * (1 - std::pow(10.0, -dice.uniform(1, 4)))
                                                         : r * dice.uniform(.1, 1);
               const shape::Cone cone{r, bottom, other, top};
               subject = {.5 * (bottom + top), s, 1, {}};
               return std::pair{b.cone(r, bottom, other, top), Wall(cone)};
             });
  report.run("torus, some thin", {8, 2, 3, 200}, 10, [&](SceneBuilder& b, Dice& dice, Subject& subject) {
    const double s = any_scale(dice);
    const shape::Torus torus{s, s * std::pow(10.0, -dice.uniform(.3, 3)), place(dice, s), axis(dice)};
    subject = {torus.center, s, 1, {}};
    Vec3 u, w;
    coordinate_system(torus.axis, u, w);
    for (int i = 0; i < 12; ++i) {
      const double angle = 2 * fn::kPi * dice.uniform();
      subject.marks.push_back(torus.center + (s + torus.tube * dice.uniform(-.9, .9)) *
                                                 (fn::cos(angle) * u + fn::sin(angle) * w));
    }
    return std::pair{b.torus(torus.swept, torus.tube, torus.center, torus.axis), Torus(torus)};
  });
  report.run(
      "blob, up to six balls", {16, 2, 3, 200}, 10, [&](SceneBuilder& b, Dice& dice, Subject& subject) {
        const double s = any_scale(dice);
        const Vec3 at = place(dice, s);
        shape::Blob blob;
        blob.threshold = dice.uniform(.05, .6);
        for (int i = 1 + dice.below(6); i > 0; --i)
          blob.balls.push_back({dice.uniform(.7, 3), s * dice.uniform(.3, .8), at + dice.in_box(.5 * s)});
        subject = {at, s, 1, {}};
        for (const shape::Metaball& ball : blob.balls) subject.marks.push_back(ball.center);
        return std::pair{b.blob(blob.threshold, blob.balls), Blob(blob)};
      });
  report.run("height field, 9 x 9", {4, 4, 3, 200}, 4, [&](SceneBuilder& b, Dice& dice, Subject& subject) {
    constexpr int kSize = 9;
    std::vector<float> altitudes;
    const double relief = std::pow(10.0, -dice.uniform(0, 3));
    for (int i = 0; i < kSize * kSize; ++i)
      altitudes.push_back(static_cast<float>(.5 + dice.uniform(-relief, relief)));
    b.files.add("field", test::height_field_bytes(kSize, altitudes));
    subject = {{.5, .5, .5}, .6, 1, {{0, 0, .5}, {1, 0, .5}, {0, 1, .5}, {1, 1, .5}}};
    return std::pair{b.height_field("field"), HeightField(kSize, altitudes)};
  });
}

TEST(RayTruthTest, ShapesThroughTransforms) { all_shapes("truth-short", 25); }

TEST(RayTruthTest, DISABLED_ShapesThroughTransformsLong) {
  all_shapes("truth", static_cast<int>(scaled_count(6000)));
}

}  // namespace
}  // namespace rayshade::stress
