// SPDX-License-Identifier: MIT
// The camera against pictures of the original (language.md 11): which pixels see a sphere.
#include "rayshade/sampling/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "fas/dispatch.h"
#include "rayshade/sampling/grid.h"

namespace rayshade {
namespace {

RenderSettings screen(int width, int height) {
  SceneSettings scene;
  scene.screen = {width, height};
  scene.samples = 1;
  scene.jitter = false;
  return resolve_settings(scene, {});
}

bool meets_sphere(const Ray& ray, const Vec3& center, double radius) {
  const Vec3 way = center - ray.origin;
  const double along = dot(way, ray.direction);
  return along > 0 && length(way - along * ray.direction) < radius;
}

/// Columns and rows of the pixels whose single sample meets a sphere, as a renderer without jitter sees it.
struct Seen {
  int count = 0, min_x = 1 << 30, max_x = -1, min_y = 1 << 30, max_y = -1;
  bool operator==(const Seen&) const = default;
};
Seen seen(const RenderSettings& settings, const Vec3& center, double radius) {
  const Camera camera(settings);
  const SampleGrid grid(settings);
  Seen out;
  for (int y = 0; y < settings.height; ++y) {
    for (int x = 0; x < settings.width; ++x) {
      const auto offset = grid.offset(0, 0, 0);
      if (!meets_sphere(camera.ray(x + offset[0], y + offset[1]), center, radius)) continue;
      ++out.count;
      out.min_x = std::min(out.min_x, x);
      out.max_x = std::max(out.max_x, x);
      out.min_y = std::min(out.min_y, y);
      out.max_y = std::max(out.max_y, y);
    }
  }
  return out;
}

// language.md 11: results of the original.
TEST(CameraTest, SmallSpheresShowWhereThePixelsAre) {
  const RenderSettings square = screen(8, 8);
  EXPECT_EQ(seen(square, {-.5178, 0, .5178}, .2), (Seen{1, 4, 4, 4, 4}));
  EXPECT_EQ(seen(square, {-.5178, 0, -.5178}, .2), (Seen{1, 4, 4, 5, 5}));
  EXPECT_EQ(seen(square, {-.5178, 0, 0}, .2).count, 0);
  const RenderSettings wide = screen(16, 8);
  EXPECT_EQ(seen(wide, {-.2589, 0, 1.7405}, .03), (Seen{1, 8, 8, 1, 1}));
  EXPECT_EQ(seen(wide, {-.2589, 0, 1.812}, .03).count, 0);
}

TEST(CameraTest, SpheresCoverThePixelsOfTheOriginal) {
  const RenderSettings settings = screen(64, 64);
  EXPECT_EQ(seen(settings, {0, 0, 0}, .5), (Seen{52, 29, 36, 29, 36}));
  EXPECT_EQ(seen(settings, {2, 0, 0}, .5), (Seen{46, 45, 51, 29, 36}));
  EXPECT_EQ(seen(settings, {0, 0, -2}, .5), (Seen{46, 29, 36, 45, 51}));  // turned by 90 degrees about y
}

TEST(CameraTest, StereoMovesTheEyes) {
  const auto columns = [](Eye eye, double separation) {
    RenderSettings settings = screen(128, 128);
    settings.stereo = eye;
    settings.eye_separation = separation;
    const Seen s = seen(settings, {0, 5, 0}, .3);
    return std::pair(s.min_x, s.max_x);
  };
  EXPECT_EQ(columns(Eye::kCenter, 4), std::pair(62, 67));
  EXPECT_EQ(columns(Eye::kLeft, 4), std::pair(52, 57));
  EXPECT_EQ(columns(Eye::kRight, 4), std::pair(72, 77));
  EXPECT_EQ(columns(Eye::kLeft, 2), std::pair(57, 62));
  EXPECT_EQ(columns(Eye::kLeft, -4), std::pair(72, 77));
}

TEST(CameraTest, TheLensBlursWhatIsOutOfFocus) {
  // 256 x 256, sphere .05 at (0,10,0): columns about 127-129 sharp, 120-136 with aperture .5, sharp with
  // focaldist 20.
  const auto columns = [](double aperture, std::optional<double> focus) {
    SceneSettings scene;
    scene.screen = {256, 256};
    scene.samples = 8;
    scene.aperture = aperture;
    scene.focal_distance = focus;
    const RenderSettings settings = resolve_settings(scene, {});
    const Camera camera(settings);
    EXPECT_EQ(camera.has_lens(), aperture > 0);
    int low = 1000, high = -1;
    for (int y = 118; y < 138; ++y) {
      for (int x = 110; x < 146; ++x) {
        for (int s = 0; s < 64; ++s) {
          for (const double xi : {0.05, 0.5, 0.95}) {
            const Ray ray = camera.has_lens() ? camera.lens_ray(x, y, s, xi, 1 - xi) : camera.ray(x, y);
            if (!meets_sphere(ray, {0, 10, 0}, .05)) continue;
            low = std::min(low, x);
            high = std::max(high, x);
          }
        }
      }
    }
    return std::pair(low, high);
  };
  const auto sharp = columns(0, std::nullopt);
  EXPECT_EQ(columns(.5, 20.0), sharp);
  const auto blurred = columns(.5, std::nullopt);
  EXPECT_NEAR(blurred.first, 120, 1);
  EXPECT_NEAR(blurred.second, 136, 1);
}

TEST(CameraTest, LensCellsFillTheSquareAndFocusOnASphere) {
  RenderSettings settings = screen(100, 80);
  settings.samples = 3;
  settings.aperture = 0.25;
  settings.focal_distance = 7;
  const Camera camera(settings);
  const Ray axis = camera.ray(31, 17);
  const Vec3 focus = axis.at(7);
  for (int s = 0; s < 9; ++s) {
    const Ray low = camera.lens_ray(31, 17, s, 0, 0),
              high = camera.lens_ray(31, 17, s, 0.999999999, 0.999999999);
    EXPECT_NEAR(dot(low.origin - camera.eye(), camera.right()), 0.25 * (-1 + s % 3 * 2 / 3.0), 1e-12);
    EXPECT_NEAR(dot(low.origin - camera.eye(), camera.up()), 0.25 * (-1 + s / 3 * 2 / 3.0), 1e-12);
    EXPECT_NEAR(dot(high.origin - camera.eye(), camera.right()), 0.25 * (-1 + (s % 3 + 1) * 2 / 3.0), 1e-8);
    EXPECT_NEAR(length(cross(focus - high.origin, high.direction)), 0, 1e-12);
    EXPECT_NEAR(length(high.direction), 1, 1e-15);
  }
}

TEST(CameraTest, FieldOfViewIsProportionalInTheAngle) {
  // 16 x 8: 45 degrees across, 22.5 degrees down.
  const Camera camera(screen(16, 8));
  const Vec3 left = camera.ray(0, 4).direction, top = camera.ray(8, 0).direction;
  EXPECT_NEAR(std::atan2(-left.x, left.y), 22.5 * std::acos(-1.0) / 180, 1e-14);
  EXPECT_NEAR(std::atan2(top.z, top.y), 11.25 * std::acos(-1.0) / 180, 1e-14);
}

TEST(CameraTest, ScreenPointsAndRaysAgree) {
  SceneSettings scene;
  scene.eye = Vec3{3, -7, 2};
  scene.look = Vec3{-1, 1, 0.5};
  scene.up = Vec3{0.2, 0.1, 5};
  scene.screen = {300, 200};
  scene.horizontal_fov = 70;
  const Camera camera(resolve_settings(scene, {}));
  for (const auto& [u, v] : {std::pair(0.0, 0.0), std::pair(150.0, 100.0), std::pair(299.5, 13.25)}) {
    const Ray ray = camera.ray(u, v);
    EXPECT_NEAR(length(ray.direction), 1, 1e-15);
    const auto back = camera.project(ray.at(4.2));
    EXPECT_NEAR(back[0], u, 1e-10);
    EXPECT_NEAR(back[1], v, 1e-10);
  }
  EXPECT_TRUE(std::isnan(camera.project(camera.eye() - camera.forward())[0]));
  EXPECT_NEAR(dot(camera.right(), camera.up()), 0, 1e-15);
  EXPECT_NEAR(dot(camera.right(), camera.forward()), 0, 1e-15);
  EXPECT_NEAR(camera.focal_distance(), length(Vec3{4, -8, 1.5}), 1e-14);
}

TEST(CameraTest, SizeOfTheModelDoesNotMatter) {
  for (const double size : {1e-9, 1.0, 1e9}) {
    SceneSettings scene;
    scene.eye = size * Vec3{1, -2, 3};
    scene.look = Vec3{0, 0, 0};
    const Camera camera(resolve_settings(scene, {}));
    const Vec3 direction = camera.ray(17, 400).direction;
    scene.eye = Vec3{1, -2, 3};
    const Vec3 expected = Camera(resolve_settings(scene, {})).ray(17, 400).direction;
    EXPECT_NEAR(length(direction - expected), 0, 1e-14) << size;
  }
}

// Whatever instruction set aims, and also where squares under- or overflow.
TEST(CameraTest, ManyPointsAreAimedAtAsOneByOne) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> place(-50, 2000);
  std::vector<std::int64_t> targets = {0};  // the best
  for (std::int64_t bit = 1; bit > 0 && bit <= fas::supported_targets(); bit <<= 1)
    if ((fas::supported_targets() & bit) != 0) targets.push_back(bit);
  ASSERT_GE(targets.size(), 2U);
  for (const std::int64_t target : targets) {
    fas::pretend_targets(target);
    for (const double size : {1e-150, 1e-9, 1.0, 1e9, 1e148}) {
      RenderSettings settings = screen(640, 480);
      settings.eye = size * Vec3{1, -8, 2.5};
      settings.look = size * Vec3{.25, 0, -.125};
      const Camera camera(settings);
      for (std::size_t count = 1; count <= ScreenPoints::kMost; ++count) {
        ScreenPoints points;
        points.count = count;
        for (std::size_t i = 0; i < count; ++i) points.u[i] = place(random), points.v[i] = place(random);
        camera.aim(points);
        for (std::size_t i = 0; i < count; ++i) {
          const Vec3 one = camera.ray(points.u[i], points.v[i]).direction, many = points.direction(i);
          ASSERT_NEAR(length(one), 1, 1e-15);
          ASSERT_TRUE(one.x == many.x && one.y == many.y && one.z == many.z)
              << "target " << target << ", size " << size << ", " << i << " of " << count;
        }
      }
    }
  }
  fas::pretend_targets(0);
}

TEST(CameraTest, TimesFillTheShutterInterval) {
  RenderSettings settings = screen(8, 8);
  settings.start_time = 1;
  settings.frame_length = 0.5;
  settings.samples = 2;
  EXPECT_EQ(Camera(settings).time(3, 3, 0.7), 2.5);  // no shutter: the start of the frame
  settings.shutter = 2;
  const Camera camera(settings);
  EXPECT_EQ(camera.time(0, 0, 0), 1);
  EXPECT_EQ(camera.time(2, 3, 0), 3.5);
  EXPECT_EQ(camera.time(2, 3, 0.5), 3.75);
  EXPECT_EQ(camera.time(-1, 1, 0), 1);
}

}  // namespace
}  // namespace rayshade
