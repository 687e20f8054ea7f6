// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "rayshade/math/functions.h"
#include "rayshade/shading/atmosphere.h"
#include "rayshade/shading/light_aims.h"
#include "tests/unit/fas/random_geometry.h"
#include "tests/unit/fas/targets.h"

namespace rayshade {
namespace {

Light spot(double exponent, double inner, double outer) {
  Light light;
  light.kind = LightKind::kSpot;
  light.target = {1, 0, 0};
  light.exponent = exponent;
  light.inner = inner;
  light.outer = outer;
  return light;
}

ShadingLight prepared(const Light& light) {
  Scene scene;
  scene.lights.push_back(light);
  return prepare_lights(scene, RenderSettings{}).at(0);
}

double cos_degrees(double degrees) { return fn::cos(degrees * fn::kPi / 180); }

TEST(SpotTest, RampRunsFromTheOuterToTheInnerAngle) {
  const ShadingLight light = prepared(spot(0, 10, 30));
  EXPECT_EQ(spot_factor(light, cos_degrees(31)), 0);
  EXPECT_EQ(spot_factor(light, cos_degrees(9)), 1);
  const double x = cos_degrees(20);
  const double w = (x - cos_degrees(30)) / (cos_degrees(10) - cos_degrees(30));
  EXPECT_DOUBLE_EQ(spot_factor(light, x), w * w * (3 - 2 * w));
}

TEST(SpotTest, WithoutConeOnlyTheExponentCounts) {
  for (const auto& [inner, outer] :
       {std::pair{180.0, 180.0}, std::pair{100.0, 120.0}, std::pair{90.0, 95.0}}) {
    const ShadingLight light = prepared(spot(2, inner, outer));
    EXPECT_DOUBLE_EQ(spot_factor(light, 0.5), 0.25);
    EXPECT_EQ(spot_factor(light, 0), 0);
    EXPECT_EQ(spot_factor(light, -0.5), 0);
  }
}

TEST(SpotTest, EqualAnglesMakeAHardEdge) {
  const ShadingLight light = prepared(spot(0, 20, 20));
  EXPECT_EQ(spot_factor(light, light.cos_inner), 0);
  EXPECT_EQ(spot_factor(light, std::nextafter(light.cos_inner, 2.0)), 1);
  EXPECT_EQ(spot_factor(light, cos_degrees(20.001)), 0);
}

TEST(PrepareLightsTest, EvaluationOrderIsTheReverseOfDefinition) {
  Scene scene;
  Light light;
  for (int i = 0; i < 3; ++i) {
    light.position = {static_cast<double>(i), 0, 0};
    scene.lights.push_back(light);
  }
  const auto lights = prepare_lights(scene, RenderSettings{});
  ASSERT_EQ(lights.size(), 3u);
  EXPECT_EQ(lights[0].position.x, 2);
  EXPECT_EQ(lights[2].position.x, 0);
}

TEST(PrepareLightsTest, AreaLightsBecomeCellsOfEqualShare) {
  Light area;
  area.kind = LightKind::kArea;
  area.intensity = {6, 6, 6};
  area.position = {1, 1, 1};
  area.u_end = {4, 1, 1};
  area.v_end = {1, 3, 1};
  area.u_samples = 3;
  area.v_samples = 2;
  Scene scene;
  scene.lights.push_back(area);
  const auto lights = prepare_lights(scene, RenderSettings{});
  ASSERT_EQ(lights.size(), 6u);
  // Last defined first: the cell of the largest u and v.
  EXPECT_EQ(lights[0].position, (Vec3{3, 2, 1}));
  EXPECT_EQ(lights[5].position, (Vec3{1, 1, 1}));
  EXPECT_DOUBLE_EQ(lights[0].intensity.r, 1);
  LightAims middle;
  middle.count = 1;
  middle.set_hit(0, {1.5, 1.5, 0}, {0, 0, 1}, {0, 0, 1});
  middle.set_place(0, area_place(lights[5], 0.5, 0.5));
  aim_at(lights[5], middle);
  EXPECT_EQ(middle.direction_of(0), (Vec3{0, 0, 1}));
  EXPECT_DOUBLE_EQ(middle.distance[0], 1);
}

TEST(PrepareLightsTest, ASceneWithoutLightsHasTheDefaultOne) {
  const auto lights = prepare_lights(Scene{}, RenderSettings{});
  ASSERT_EQ(lights.size(), 1u);
  LightAims aims;
  aims.count = 1;
  aims.set_hit(0, {5, 6, 7}, {0, 0, 1}, {0, 0, 1});
  aim_at(lights[0], aims);
  EXPECT_NEAR(aims.direction[0][0], 1 / std::sqrt(3.0), 1e-15);
  EXPECT_NEAR(aims.direction[1][0], -1 / std::sqrt(3.0), 1e-15);
  EXPECT_EQ(aims.distance[0], kFar);
}

class LightAimsTest : public fas::test::TargetTest {};

/// Every lane, on every processor, as the formulas give it for one hit.
TEST_P(LightAimsTest, AreThoseOfSingleHits) {
  fas::test::Dice dice(41);
  const auto any = [&](double size) {
    const fas::Point p = dice.in_box(size);
    return Vec3{p[0], p[1], p[2]};
  };
  for (int round = 0; round < 200; ++round) {
    ShadingLight light;
    constexpr LightKind kKinds[] = {LightKind::kPoint, LightKind::kDirectional, LightKind::kSpot,
                                    LightKind::kArea, LightKind::kExtended};
    light.kind = kKinds[round % 5];
    light.position = any(dice.size(-6, 6));
    if (light.kind == LightKind::kDirectional) light.position = normalize(light.position);
    LightAims aims;
    aims.count = static_cast<std::size_t>(1 + dice.below(LightAims::kMost));
    std::vector<Vec3> points, normals, mirrors, places;
    for (std::size_t i = 0; i < aims.count; ++i) {
      points.push_back(dice.below(20) ? any(dice.size(-6, 6)) : light.position);
      normals.push_back(normalize(any(1)));
      mirrors.push_back(any(1));
      places.push_back(light.kind == LightKind::kArea ? light.position + any(1) : light.position);
      aims.set_hit(i, points[i], normals[i], mirrors[i]);
      if (light.kind == LightKind::kArea) aims.set_place(i, places[i]);
    }
    aim_at(light, aims);
    for (std::size_t i = 0; i < aims.count; ++i) {
      const bool directional = light.kind == LightKind::kDirectional;
      const double distance = directional ? kFar : length(places[i] - points[i]);
      ASSERT_EQ(aims.distance[i], distance);
      if (distance == 0) continue;
      const Vec3 direction = directional ? light.position : (places[i] - points[i]) / distance;
      ASSERT_EQ(aims.direction_of(i), direction);
      ASSERT_EQ(aims.cosine[i], dot(direction, normals[i]));
      ASSERT_EQ(aims.highlight[i], dot(mirrors[i], direction));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, LightAimsTest, testing::ValuesIn(fas::test::targets()),
                         fas::test::target_name);

TEST(ExtendedTest, SamplesStratifyASquareFacingThePoint) {
  Light extended;
  extended.kind = LightKind::kExtended;
  extended.position = {0, 0, 10};
  extended.radius = 2;
  const ShadingLight light = prepared(extended);
  for (int s = 0; s < 9; ++s) {
    const Vec3 low = extended_target(light, {}, s, 3, 0, 0), high = extended_target(light, {}, s, 3, 1, 1);
    EXPECT_NEAR(low.z, 10, 1e-12);
    EXPECT_NEAR(length(high - low), std::sqrt(2.0) * 4 / 3, 1e-12);
    for (const Vec3& p : {low, high}) {
      EXPECT_LE(std::fabs(p.x), 2 + 1e-12);
      EXPECT_LE(std::fabs(p.y), 2 + 1e-12);
    }
  }
}

TEST(AttenuationTest, HalvesPerThickness) {
  EXPECT_NEAR(attenuation(3, 3), 0.5, 1e-8);
  EXPECT_NEAR(attenuation(6, 3), 0.25, 1e-8);
  EXPECT_EQ(attenuation(3, 0), 0);
  EXPECT_EQ(attenuation(kFar, 3), 0);
  EXPECT_EQ(attenuation(std::numeric_limits<double>::infinity(), 3), 0);
  EXPECT_EQ(attenuation(std::nan(""), 3), 0);
}

TEST(AtmosphereTest, TheEffectListedLastIsAppliedFirst) {
  AtmosphereEffect red, green;
  red.color = {1, 0, 0};
  green.color = {0, 1, 0};
  const Ray ray{{0, 0, 0}, {1, 0, 0}};
  // Thickness 0: both are opaque, and the first listed lies on top.
  EXPECT_EQ(apply_atmosphere({red, green}, {}, ray, 1, ray.at(1)), (Color{1, 0, 0}));
}

TEST(AtmosphereTest, MistOfAConstantHeightIsFogOfThatDensity) {
  AtmosphereEffect mist;
  mist.kind = EffectKind::kMist;
  mist.color = {1, 1, 1};
  mist.thickness = {2, 2, 2};
  mist.zero = 0;
  mist.scale = 1;
  const Ray ray{{0, 0, 1}, {1, 0, 0}};
  const double expected = 1 - attenuation(3 * fn::exp(-1), 2);
  EXPECT_NEAR(apply_atmosphere({mist}, {}, ray, 3, ray.at(3)).r, expected, 1e-12);
  // And nearly so for a ray that rises a little.
  const Ray rising{{0, 0, 1}, {1, 0, 1e-4}};
  EXPECT_NEAR(apply_atmosphere({mist}, {}, rising, 3, rising.at(3)).r, expected, 1e-4);
}

}  // namespace
}  // namespace rayshade
