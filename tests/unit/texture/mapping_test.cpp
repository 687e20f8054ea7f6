// SPDX-License-Identifier: MIT
// The mappings against values found by other formulas (atan2 and asin instead of acos), and their degenerate
// cases.
#include "rayshade/texture/mapping.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayshade {
namespace {

Mapping tilted(MappingKind kind) { return {kind, true, {0.1, 0.2, -0.3}, {0.2, 2, 0.3}, {0.4, 0.1, 0.8}}; }

struct MappingValue {
  Vec3 point;
  double u, spherical_v, cylindrical_v;
};
const MappingValue kValues[] = {
    {{1, 0.5, -0.7}, 0.25247314767752715, 0.6021519095326817, 0.32476476866138115},
    {{-0.4, -1.3, 0.6}, 0.8776891462339261, 0.2225333553216427, -1.392551962593498},
    {{0.2, 0.9, -0.31}, 0.3850598219322112, 0.9466286668924883, 0.6972601169593591},
    {{-0.8, 0.4, -0.9}, 0.5822593751148234, 0.5056959423526627, 0.019682713252204914},
};

TEST(SphericalMapping, IsLongitudeAndLatitude) {
  const CompiledMapping mapping(tilted(MappingKind::kSpherical));
  for (const MappingValue& value : kValues) {
    const TextureCoordinates c = mapping.at(value.point);
    EXPECT_NEAR(c.u, value.u, 1e-12);
    EXPECT_NEAR(c.v, value.spherical_v, 1e-12);
  }
}

TEST(SphericalMapping, DefaultAxesAreXAndZ) {
  const CompiledMapping mapping(Mapping{MappingKind::kSpherical, false, {}, {0, 0, 1}, {1, 0, 0}});
  EXPECT_NEAR(mapping.at({0, 2, 0}).u, 0.25, 1e-15);
  EXPECT_NEAR(mapping.at({-2, 0, 0}).u, 0.5, 1e-15);
  EXPECT_NEAR(mapping.at({0, -2, 0}).u, 0.75, 1e-15);
  EXPECT_EQ(mapping.at({2, 0, 0}).u, 1);  // exactly on the seam
  EXPECT_NEAR(mapping.at({1, 0, 1}).v, 0.75, 1e-15);
  EXPECT_NEAR(mapping.at({1, 0, -1}).v, 0.25, 1e-15);
}

TEST(SphericalMapping, PolesAndCentre) {
  const CompiledMapping mapping(Mapping{MappingKind::kSpherical, false, {}, {0, 0, 1}, {1, 0, 0}});
  const TextureCoordinates top = mapping.at({0, 0, 3});
  EXPECT_EQ(top.u, 0);
  EXPECT_NEAR(top.v, 1, 1e-15);
  EXPECT_EQ(top.du, Vec3{});
  EXPECT_EQ(top.dv, Vec3{});
  EXPECT_EQ(mapping.at({0, 0, -3}).v, 0);
  EXPECT_EQ(mapping.at({}).u, 0);
  EXPECT_EQ(mapping.at({}).v, 0);
}

TEST(SphericalMapping, TangentsFollowTheCoordinates) {
  const CompiledMapping mapping(tilted(MappingKind::kSpherical));
  for (const MappingValue& value : kValues) {
    const TextureCoordinates c = mapping.at(value.point);
    const double h = 1e-6;
    EXPECT_NEAR(mapping.at(value.point + h * c.du).v, c.v, 1e-9);
    EXPECT_GT(mapping.at(value.point + h * c.du).u, c.u);
    EXPECT_NEAR(mapping.at(value.point + h * c.dv).u, c.u, 1e-9);
    EXPECT_GT(mapping.at(value.point + h * c.dv).v, c.v);
    EXPECT_NEAR(length(c.du), 1, 1e-15);
    EXPECT_NEAR(length(c.dv), 1, 1e-15);
  }
}

TEST(CylindricalMapping, IsLongitudeAndHeight) {
  const CompiledMapping mapping(tilted(MappingKind::kCylindrical));
  const Vec3 up = normalize({0.2, 2, 0.3});
  for (const MappingValue& value : kValues) {
    const TextureCoordinates c = mapping.at(value.point);
    EXPECT_NEAR(c.u, value.u, 1e-12);
    EXPECT_NEAR(c.v, value.cylindrical_v, 1e-14);
    EXPECT_LT(length(c.dv - up), 1e-15);
    // From the point itself, not from the point relative to the origin (textures.md D9).
    EXPECT_LT(length(c.du - normalize(cross(up, value.point))), 1e-15);
  }
}

TEST(CylindricalMapping, AxisHasNoAngleAndNoTangents) {
  const CompiledMapping mapping(Mapping{MappingKind::kCylindrical, false, {}, {0, 0, 1}, {1, 0, 0}});
  const TextureCoordinates c = mapping.at({0, 0, 2.5});
  EXPECT_EQ(c.u, 0);
  EXPECT_EQ(c.v, 2.5);
  EXPECT_EQ(c.du, Vec3{});
  EXPECT_EQ(c.dv, Vec3{});
}

TEST(PlanarMapping, SolvesForTheAxesAndIgnoresTheOrigin) {
  const Vec3 v_axis{0.3, 1.4, 0}, u_axis{0.9, -0.2, 0.1};
  const CompiledMapping mapping(Mapping{MappingKind::kPlanar, true, {0.37, 0.2, 0.1}, v_axis, u_axis});
  const Vec3 x = 0.7 * u_axis - 1.3 * v_axis + 2.1 * cross(u_axis, v_axis);
  const TextureCoordinates c = mapping.at(x);
  EXPECT_NEAR(c.u, 0.7, 1e-14);
  EXPECT_NEAR(c.v, -1.3, 1e-14);
  EXPECT_LT(length(c.du - normalize(u_axis)), 1e-15);
  EXPECT_LT(length(c.dv - normalize(v_axis)), 1e-15);
  const CompiledMapping plain(Mapping{MappingKind::kPlanar, false, {}, {}, {}});
  EXPECT_EQ(plain.at({3, 4, 5}).u, 3);
  EXPECT_EQ(plain.at({3, 4, 5}).v, 4);
}

TEST(Mappings, DegenerateAxesAreRefused) {
  const auto make = [](MappingKind kind, const Vec3& up, const Vec3& u_axis) {
    return CompiledMapping(Mapping{kind, true, {}, up, u_axis});
  };
  for (const MappingKind kind : {MappingKind::kSpherical, MappingKind::kCylindrical, MappingKind::kPlanar}) {
    EXPECT_THROW(make(kind, {0, 0, 0}, {1, 0, 0}), DegenerateMapping);
    EXPECT_THROW(make(kind, {0, 0, 1}, {0, 0, 0}), DegenerateMapping);
    EXPECT_THROW(make(kind, {1, 2, 3}, {-2, -4, -6}), DegenerateMapping);
    EXPECT_THROW(make(kind, {std::nan(""), 2, 3}, {1, 0, 0}), DegenerateMapping);
    EXPECT_NO_THROW(make(kind, {1e-7, 0, 0}, {0, 1e-7, 0})) << static_cast<int>(kind);
  }
}

}  // namespace
}  // namespace rayshade
