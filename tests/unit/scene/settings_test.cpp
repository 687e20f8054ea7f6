// SPDX-License-Identifier: MIT
// Defaults, precedence, window arithmetic and refusals of resolve_settings.
#include "rayshade/scene/settings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

namespace rayshade {
namespace {

RenderSettings resolved(const std::function<void(SceneSettings&, SettingsOverrides&)>& set) {
  SceneSettings scene;
  SettingsOverrides options;
  set(scene, options);
  return resolve_settings(scene, options);
}

/// The message and line of the error that must come.
struct Failure {
  std::string what;
  std::uint32_t line = 0;
};
Failure failure(const std::function<void(SceneSettings&, SettingsOverrides&)>& set) {
  try {
    resolved(set);
  } catch (const SettingsError& error) {
    return {error.what(), error.location.line};
  }
  ADD_FAILURE() << "no error";
  return {};
}

bool mentions(const Failure& f, const std::string& part) { return f.what.find(part) != std::string::npos; }

std::array<int, 4> window(const RenderSettings& s) { return {s.min_x, s.max_x, s.min_y, s.max_y}; }

TEST(SettingsTest, DefaultsAreThoseOfTheLanguage) {
  const RenderSettings s = resolve_settings({}, {});
  EXPECT_EQ(s.eye, (Vec3{0, -10, 0}));
  EXPECT_EQ(s.look, (Vec3{0, 0, 0}));
  EXPECT_EQ(s.up, (Vec3{0, 0, 1}));
  EXPECT_EQ(s.horizontal_fov, 45);
  EXPECT_EQ(s.vertical_fov, 45);
  EXPECT_EQ(s.aperture, 0);
  EXPECT_FALSE(s.focal_distance.has_value());
  EXPECT_EQ(s.width, 512);
  EXPECT_EQ(s.height, 512);
  EXPECT_EQ(window(s), (std::array{0, 511, 0, 511}));
  EXPECT_EQ(s.samples, 3);
  EXPECT_TRUE(s.jitter);
  EXPECT_EQ(s.filter, FilterKind::kBox);
  EXPECT_EQ(s.filter_width, 1);
  EXPECT_EQ(s.contrast, (Color{0.2, 0.15, 0.3}));
  EXPECT_EQ(s.cutoff, (Color{0.002, 0.002, 0.002}));
  EXPECT_EQ(s.max_depth, 5);
  EXPECT_EQ(s.background, Color{});
  EXPECT_TRUE(s.shadows);
  EXPECT_TRUE(s.transparent_shadows);
  EXPECT_FALSE(s.flip_normals);
  EXPECT_EQ(s.shutter, 0);
  EXPECT_EQ(s.start_time, 0);
  EXPECT_EQ(s.frame_length, 1);
  EXPECT_EQ(s.frames, 1);
  EXPECT_EQ(s.first_frame, 0);
  EXPECT_EQ(s.ambient_light, (Color{1, 1, 1}));
  EXPECT_EQ(s.atmosphere_index, 1);
}

TEST(SettingsTest, OptionsWinOverTheScene) {
  const RenderSettings s = resolved([](SceneSettings& scene, SettingsOverrides& options) {
    scene.screen = {100, 50};
    options.screen = {64, 32};
    scene.samples = 2;
    options.samples = 4;
    scene.jitter = true;
    options.jitter = false;
    scene.filter = FilterKind::kBox;
    options.filter = FilterKind::kGauss;
    scene.contrast = Color{1, 1, 1};
    options.contrast = Color{0, 0.5, 0};
    scene.cutoff = Color{1, 1, 1};
    options.cutoff = Color{0, 0, 0.25};
    scene.max_depth = 7;
    options.max_depth = 2;
    scene.frames = 9;
    options.frames = 3;
    options.first_frame = 5;
    options.seed = 77;
  });
  EXPECT_EQ(s.width, 64);
  EXPECT_EQ(s.height, 32);
  EXPECT_EQ(s.samples, 4);
  EXPECT_FALSE(s.jitter);
  EXPECT_EQ(s.filter, FilterKind::kGauss);
  EXPECT_EQ(s.filter_width, 1.8);
  EXPECT_EQ(s.contrast, (Color{0, 0.5, 0}));
  EXPECT_EQ(s.cutoff, (Color{0, 0, 0.25}));
  EXPECT_EQ(s.max_depth, 2);
  EXPECT_EQ(s.frames, 3);
  EXPECT_EQ(s.first_frame, 5);
  EXPECT_EQ(s.seed, 77u);
}

TEST(SettingsTest, ToleranceIsForLowDiscrepancySampling) {
  EXPECT_FALSE(resolve_settings({}, {}).sobol());
  EXPECT_EQ(resolve_settings({}, {}).strata(), 3);
  SettingsOverrides options;
  options.tolerance = .02;
  EXPECT_THROW(resolve_settings({}, options), SettingsError);
  options.sampling = SamplingKind::kSobol;
  EXPECT_EQ(resolve_settings({}, options).tolerance, .02);
  EXPECT_EQ(resolve_settings({}, options).strata(), 1);
  options.tolerance = 0;
  EXPECT_EQ(resolve_settings({}, options).tolerance, 0);
  for (const double wrong : {-.1, 1.5, std::nan("")}) {
    options.tolerance = wrong;
    EXPECT_THROW(resolve_settings({}, options), SettingsError) << wrong;
  }
}

TEST(SettingsTest, VerticalFieldOfViewFollowsTheAngle) {
  const auto screen = [](SceneSettings& scene, SettingsOverrides&) { scene.screen = {16, 8}; };
  EXPECT_EQ(resolved(screen).vertical_fov, 22.5);
  EXPECT_EQ(resolved([&](auto& scene, auto& options) {
              screen(scene, options);
              scene.horizontal_fov = 60;
            }).vertical_fov,
            30);
  EXPECT_EQ(resolved([&](auto& scene, auto& options) {
              screen(scene, options);
              scene.vertical_fov = 60;
            }).vertical_fov,
            60);
}

TEST(SettingsTest, AGivenFilterWidthIsKept) {
  EXPECT_EQ(resolved([](auto& scene, auto&) {
              scene.filter = FilterKind::kGauss;
              scene.filter_width = 2.5;
            }).filter_width,
            2.5);
}

TEST(SettingsTest, TogglesCancelOut) {
  const auto shadows = [](bool scene_toggle, bool option_toggle) {
    return resolved([&](auto& scene, auto& options) {
             scene.toggle_transparent_shadows = scene_toggle;
             options.toggle_transparent_shadows = option_toggle;
           })
        .transparent_shadows;
  };
  EXPECT_TRUE(shadows(false, false));
  EXPECT_FALSE(shadows(true, false));
  EXPECT_FALSE(shadows(false, true));
  EXPECT_TRUE(shadows(true, true));
  EXPECT_FALSE(resolved([](auto&, auto& options) { options.no_shadows = true; }).shadows);
}

TEST(SettingsTest, CropExamplesOfTheLanguage) {
  const auto cropped = [](std::array<double, 4> crop) {
    return window(resolved([&](SceneSettings& scene, SettingsOverrides&) {
      scene.screen = {16, 8};
      scene.crop = crop;
    }));
  };
  EXPECT_EQ(cropped({0, .5, 0, .5}), (std::array{0, 7, 0, 3}));
  EXPECT_EQ(cropped({.5, 1, .5, 1}), (std::array{7, 15, 3, 7}));
  EXPECT_EQ(cropped({.9, .1, -5, 7}), (std::array{1, 13, 0, 7}));
  EXPECT_EQ(window(resolved([](SceneSettings& scene, SettingsOverrides&) {
              scene.screen = {16, 8};
              scene.window = {4, 11, 2, 5};
              scene.crop = {.25, .5, .25, .5};
            })),
            (std::array{5, 7, 2, 3}));
}

TEST(SettingsTest, WindowOptionWinsAndWindowsMustFit) {
  const RenderSettings s = resolved([](SceneSettings& scene, SettingsOverrides& options) {
    scene.window = {-5, 100000, 0, 1};
    options.window = {1, 2, 3, 3};
  });
  EXPECT_EQ(window(s), (std::array{1, 2, 3, 3}));
  EXPECT_EQ(s.window_width(), 2);
  EXPECT_EQ(s.window_height(), 1);

  const auto bad = [](std::array<int, 4> where) {
    return failure([&](SceneSettings& scene, SettingsOverrides&) {
      scene.screen = {16, 8};
      scene.window = where;
      scene.window_location.line = 9;
    });
  };
  for (const auto& w :
       {std::array{-1, 3, 0, 3}, std::array{0, 16, 0, 3}, std::array{0, 3, 0, 8}, std::array{0, 3, -1, 3}}) {
    const Failure f = bad(w);
    EXPECT_TRUE(mentions(f, "not inside the 16 x 8 screen")) << f.what;
    EXPECT_EQ(f.line, 9u);
  }
  EXPECT_TRUE(mentions(bad({5, 3, 0, 3}), "window is empty"));
  EXPECT_TRUE(mentions(bad({0, 3, 7, 6}), "window is empty"));
}

TEST(SettingsTest, MinusOneInAnOptionStandsForTheDefault) {
  const RenderSettings defaults;
  const RenderSettings set = resolved([](auto& scene, auto& options) {
    scene.screen = {30, 20};
    scene.contrast = scene.cutoff = Color{.5, .5, .5};
    options.screen = {-1, 40};
    options.contrast = options.cutoff = Color{-1, 0, 0};
  });
  EXPECT_EQ(set.width, defaults.width);
  EXPECT_EQ(set.height, 40);
  EXPECT_EQ(set.contrast, defaults.contrast);
  EXPECT_EQ(set.cutoff, defaults.cutoff);
  EXPECT_TRUE(mentions(failure([](auto& scene, auto& options) {
                         scene.eye_separation = 1;
                         options.eye_separation = -1;
                         options.eye = Eye::kLeft;
                       }),
                       "eye separation"));
}

TEST(SettingsTest, ScreensHaveSensibleSizes) {
  const auto bad = [](int width, int height) {
    return failure([&](SceneSettings& scene, SettingsOverrides&) {
      scene.screen = {width, height};
      scene.screen_location.line = 3;
    });
  };
  EXPECT_TRUE(mentions(bad(0, 5), "no pixels"));
  EXPECT_TRUE(mentions(bad(5, -2), "no pixels"));
  EXPECT_TRUE(mentions(bad(1000001, 1), "too large"));
  EXPECT_EQ(bad(1, 1000001).line, 3u);
  const RenderSettings large = resolved([](auto& scene, auto&) { scene.screen = {1000000, 1000000}; });
  EXPECT_EQ(large.max_y, 999999);
  // An option is not blamed on the scene.
  EXPECT_EQ(failure([](auto& scene, auto& options) {
              scene.screen_location.line = 3;
              options.screen = {0, 0};
            }).line,
            0u);
}

TEST(SettingsTest, SamplesFrom1To64) {
  const auto sample = [](int n) {
    return [n](SceneSettings& scene, SettingsOverrides&) {
      scene.samples = n;
      scene.samples_location.line = 4;
    };
  };
  EXPECT_EQ(resolved(sample(1)).samples, 1);
  EXPECT_EQ(resolved(sample(64)).samples, 64);
  EXPECT_EQ(failure(sample(0)).line, 4u);
  EXPECT_TRUE(mentions(failure(sample(65)), "out of range"));
}

TEST(SettingsTest, DepthAndFramesAreClamped) {
  const RenderSettings s = resolved([](auto& scene, auto&) {
    scene.max_depth = -3;
    scene.frames = -2;
    scene.shutter = -1;
  });
  EXPECT_EQ(s.max_depth, 0);
  EXPECT_EQ(s.frames, 1);
  EXPECT_EQ(s.shutter, 0);
  EXPECT_TRUE(mentions(failure([](auto&, auto& options) {
                         options.first_frame = std::numeric_limits<int>::max();
                         options.frames = 2;
                       }),
                       "last frame"));
}

TEST(SettingsTest, FramesStartAtAbsoluteNumbers) {
  const RenderSettings s = resolved([](auto& scene, auto&) {
    scene.start_time = 1;
    scene.frame_length = 0.5;
  });
  EXPECT_EQ(s.frame_start(2), 2);
  EXPECT_EQ(s.frame_start(-1), 0.5);
}

TEST(SettingsTest, TheCameraNeedsABasis) {
  EXPECT_TRUE(mentions(failure([](auto& scene, auto&) {
                         scene.look = Vec3{0, -10, 0};
                       }),
                       "eye point is the look point"));
  EXPECT_TRUE(mentions(failure([](auto& scene, auto&) { scene.up = Vec3{0, -3, 0}; }), "parallel"));
  EXPECT_TRUE(mentions(failure([](auto& scene, auto&) { scene.up = Vec3{0, 0, 0}; }), "up vector is zero"));
  EXPECT_TRUE(mentions(failure([](auto& scene, auto&) {
                         scene.eye = Vec3{0.1, 0.2, 0.3};
                         scene.look = Vec3{0.3, 0.6, 0.9};
                         scene.up = Vec3{1, 2, 3};
                       }),
                       "parallel"));
  EXPECT_TRUE(mentions(failure([](auto& scene, auto&) {
                         scene.eye = Vec3{std::nan(""), 0, 0};
                       }),
                       "not finite"));
  // Only truly degenerate views are refused: tiny models and tiny up vectors are fine.
  EXPECT_NO_THROW(resolved([](auto& scene, auto&) {
    scene.eye = Vec3{0, -1e-7, 0};
    scene.up = Vec3{0, 0, 1e-9};
  }));
  EXPECT_NO_THROW(resolved([](auto& scene, auto&) { scene.up = Vec3{0, 1, 1e-4}; }));
}

TEST(SettingsTest, StereoNeedsASeparation) {
  EXPECT_TRUE(mentions(failure([](auto&, auto& options) { options.eye = Eye::kLeft; }), "eye separation"));
  const RenderSettings s = resolved([](auto& scene, auto& options) {
    options.eye = Eye::kRight;
    scene.eye_separation = 4;
    options.eye_separation = 2;
  });
  EXPECT_EQ(s.stereo, Eye::kRight);
  EXPECT_EQ(s.eye_separation, 2);
  EXPECT_TRUE(mentions(failure([](auto& scene, auto& options) {
                         options.eye = Eye::kLeft;
                         scene.eye_separation = std::numeric_limits<double>::infinity();
                       }),
                       "not a finite number"));
}

}  // namespace
}  // namespace rayshade
