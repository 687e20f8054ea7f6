// SPDX-License-Identifier: MIT
// The picture does not depend on who rendered it.
#include <gtest/gtest.h>

#include <thread>

#include "rayshade/lang/parse.h"
#include "rayshade/render/renderer.h"

namespace rayshade {
namespace {

/// Jitter, lens, motion, soft and area lights, gloss, glass, mirrors, CSG, instances, textures, fog.
constexpr const char* kEverything = R"(
screen 61 47
sample 3
eyep 1 -9 4  lookp 0 0 0.6  fov 40
aperture .05 focaldist 9
shutter .5
light .3 .35 .4 ambient
light .7 .65 .6 extended .8 -4 -6 8
light .4 area 3 -4 6  4 -4 6 2  3 -3 6 2
light .3 spot 0 -3 5 0 0 0 3 20 35 noshadow
surface glass transp .9 body .95 1 .95 specular .5 .5 .5 specpow 40 reflect .2 index 1.5 extinct .9
surface steel ambient .05 .05 .05 diffuse .2 .2 .25 specular .8 .8 .8 specpow 30 reflect .6
surface clay ambient .1 .08 .06 diffuse .7 .5 .4
plane clay 0 0 0 0 0 1 texture checker diffuse .2 .2 .3 ambient .05 .05 .08
sphere glass .7 -1.2 -.5 .7
sphere steel .6 1.3 .2 .6 texture gloss .9
difference box clay -.3 .6 0 .9 1.8 1.2 sphere steel .6 .3 .9 1.2 end
name bead sphere clay .15 0 0 .15 texture marble scale .2 .2 .2
object bead translate -.5 -1.5 0
object bead translate .1 -1.7 0 scale 1 1 1.5
list object bead translate .8 -1.6 0 torus steel .3 .08 .8 -1.6 .4 0 1 1 end
sphere clay .25 0 -1 1.6 translate (time * .6) 0 0
blob clay .4 1 .6 -1.8 1.4 .5 1 .6 -1.4 1.4 .5
triangle clay 1.8 1.2 0 -1 -1 .2 2.6 1 0 1 -1 .2 2.2 1.4 1 0 -1 .4
atmosphere fog .4 .45 .5 30 28 26
)";

Scene parse(const std::string& text) {
  MemoryProvider provider;
  provider.add("test.ray", text);
  ParseResult result = parse_scene(provider, "test.ray", {});
  for (const Diagnostic& d : result.diagnostics) {
    if (d.severity == Severity::kError) ADD_FAILURE() << format_diagnostic(d, false);
  }
  return std::move(result.scene);
}

struct Picture {
  RenderSettings settings;
  std::vector<float> rgba;
  RenderStatistics statistics;
};

Picture render(const Scene& scene, const SettingsOverrides& overrides = {}, const RenderOptions& options = {},
               int frame = 0) {
  Picture out;
  out.settings = resolve_settings(scene.settings, overrides);
  MemoryProvider provider;
  Renderer renderer(scene, out.settings, provider, options);
  FrameBufferOptions buffer;
  buffer.width = out.settings.window_width();
  buffer.height = out.settings.window_height();
  buffer.storage = PixelStorage::kFloat;
  FrameBuffer picture(buffer);
  const std::atomic<bool> stop{false};
  EXPECT_TRUE(renderer.render_frame({frame, picture, stop}));
  out.rgba.resize(static_cast<std::size_t>(buffer.width) * buffer.height * 4);
  for (std::int64_t y = 0; y < buffer.height; ++y) {
    picture.read_row(y, reinterpret_cast<std::uint8_t*>(out.rgba.data() + 4 * y * buffer.width));
  }
  out.statistics = renderer.statistics();
  return out;
}

TEST(RenderTest, ThreadsAndBlocksDoNotMatter) {
  const Scene scene = parse(kEverything);
  const Picture one = render(scene);
  for (const int threads : {2, 5}) {
    RenderOptions options;
    options.threads = threads;
    EXPECT_EQ(render(scene, {}, options).rgba, one.rgba) << threads;
  }
  for (const int side : {5, 7, 61}) {
    RenderOptions options;
    options.block_side = side;
    EXPECT_EQ(render(scene, {}, options).rgba, one.rgba) << side;
  }
  // Neither all background nor all alike.
  float lowest = 1e9f, highest = -1e9f;
  for (std::size_t i = 0; i < one.rgba.size(); i += 4) {
    lowest = std::min(lowest, one.rgba[i]);
    highest = std::max(highest, one.rgba[i]);
  }
  EXPECT_LT(lowest, 0.2f);
  EXPECT_GT(highest, 0.6f);
}

SettingsOverrides sobol(std::optional<double> tolerance = {}) {
  SettingsOverrides out;
  out.sampling = SamplingKind::kSobol;
  out.tolerance = tolerance;
  return out;
}

TEST(RenderTest, LowDiscrepancySamplingDoesNotDependOnWhoRenders) {
  const Scene scene = parse(kEverything);
  const Picture one = render(scene, sobol(.02));
  EXPECT_NE(one.rgba, render(scene).rgba);
  RenderOptions options;
  options.threads = 3;
  EXPECT_EQ(render(scene, sobol(.02), options).rgba, one.rgba);
  for (const int side : {1, 5, 61}) {
    options.block_side = side;
    EXPECT_EQ(render(scene, sobol(.02), options).rgba, one.rgba) << side;
  }
  options = {};
  options.intersector = IntersectorKind::kBruteForce;
  EXPECT_EQ(render(scene, sobol(.02), options).rgba, one.rgba);
  SettingsOverrides window = sobol(.02);
  window.window = {{10, 33, 5, 21}};
  const Picture part = render(scene, window);
  for (std::size_t y = 0; y < 17; ++y) {
    for (std::size_t i = 0; i < 4 * 24; ++i)
      ASSERT_EQ(part.rgba[4 * 24 * y + i], one.rgba[4 * (61 * (y + 5) + 10) + i]) << y << ' ' << i;
  }
}

TEST(RenderTest, ToleranceDecidesHowManySamplesAreTaken) {
  const Scene scene = parse(std::string(kEverything) + "sample 6\n");
  const auto samples = [&](double tolerance) {
    const Picture picture = render(scene, sobol(tolerance));
    return picture.statistics.shading.eye_rays - picture.statistics.sampling.halo_samples;
  };
  const std::uint64_t all = samples(0), some = samples(.01), few = samples(.05), none = samples(1);
  EXPECT_EQ(all, 61u * 47 * 36);
  EXPECT_EQ(none, 61u * 47 * 2);
  EXPECT_LT(few, some);
  EXPECT_LT(some, all);
  EXPECT_GT(few, none);
}

TEST(RenderTest, TheSamplesOfAPixelShareAnAreaLight) {
  // As many points of the light as it has cells, for a pixel with all its samples; the same light.
  const Scene scene = parse(R"(
    screen 20 20  sample 2  eyep 0 -9 4  lookp 0 0 0  maxdepth 0
    light .9 area -1 -1 5  1 -1 5 4  -1 1 5 3
    plane 0 0 0 0 0 1
  )");
  const Picture cells = render(scene), shared = render(scene, sobol(0));
  EXPECT_EQ(cells.statistics.light_names.size(), 12u);
  EXPECT_EQ(shared.statistics.light_names.size(), 3u);
  const auto mean = [](const Picture& picture) {
    double sum = 0;
    for (const float value : picture.rgba) sum += value;
    return sum / static_cast<double>(picture.rgba.size());
  };
  EXPECT_GT(mean(cells), .6);
  EXPECT_NEAR(mean(shared), mean(cells), .001);
}

TEST(RenderTest, TheHierarchyGivesThePictureOfBruteForce) {
  const Scene scene = parse(kEverything);
  RenderOptions brute;
  brute.intersector = IntersectorKind::kBruteForce;
  EXPECT_EQ(render(scene, {}, brute).rgba, render(scene).rgba);
}

TEST(RenderTest, VerificationChecksTheSameRaysWhateverTheThreads) {
  const Scene scene = parse(kEverything);
  RenderOptions options;
  options.block_side = 16;  // the halos of blocks hold rays of their own
  const Picture plain = render(scene, {}, options);
  options.verify = 0.2;
  const Picture one = render(scene, {}, options);
  options.threads = 3;
  const Picture three = render(scene, {}, options);
  EXPECT_EQ(one.rgba, plain.rgba);
  const VerifyCounts &a = one.statistics.verify, &b = three.statistics.verify;
  EXPECT_EQ(a.nearest, b.nearest);
  EXPECT_EQ(a.occlusion, b.occlusion);
  EXPECT_EQ(a.differing + b.differing, 0u);
  const double share = static_cast<double>(a.rays()) / static_cast<double>(one.statistics.shading.queries());
  EXPECT_NEAR(share, 0.2, 0.05);
  EXPECT_EQ(plain.statistics.verify.rays(), 0u);
}

TEST(RenderTest, WindowsAndCropsAreThatPartOfTheWhole) {
  const Scene scene = parse(kEverything);
  const Picture whole = render(scene);
  SettingsOverrides window, crop;
  window.window = {{10, 33, 5, 21}};
  crop.crop = {{.25, .8, .1, .55}};
  for (const SettingsOverrides& overrides : {window, crop}) {
    const Picture part = render(scene, overrides);
    const RenderSettings& s = part.settings;
    ASSERT_GT(s.window_width(), 5);
    for (int y = s.min_y; y <= s.max_y; ++y) {
      for (int x = s.min_x; x <= s.max_x; ++x) {
        for (int c = 0; c < 4; ++c) {
          EXPECT_EQ(
              part.rgba[4 * (static_cast<std::size_t>(y - s.min_y) * s.window_width() + (x - s.min_x)) + c],
              whole.rgba[4 * (static_cast<std::size_t>(y) * s.width + x) + c])
              << x << ' ' << y;
        }
      }
    }
  }
}

TEST(RenderTest, FramesDoNotDependOnTheFramesBefore) {
  const Scene scene = parse(std::string(kEverything) + "frames 3 framelength .7\n");
  const RenderSettings settings = resolve_settings(scene.settings, {});
  MemoryProvider provider;
  Renderer renderer(scene, settings, provider, {});
  FrameBufferOptions buffer;
  buffer.width = settings.window_width();
  buffer.height = settings.window_height();
  buffer.storage = PixelStorage::kFloat;
  FrameBuffer picture(buffer);
  const std::atomic<bool> stop{false};
  std::vector<float> previous;
  for (int frame = 0; frame < 3; ++frame) {
    picture.clear();
    ASSERT_TRUE(renderer.render_frame({frame, picture, stop}));
    std::vector<float> rgba(static_cast<std::size_t>(buffer.width) * buffer.height * 4);
    for (std::int64_t y = 0; y < buffer.height; ++y) {
      picture.read_row(y, reinterpret_cast<std::uint8_t*>(rgba.data() + 4 * y * buffer.width));
    }
    SettingsOverrides alone;
    alone.first_frame = frame;
    EXPECT_EQ(rgba, render(scene, alone, {}, frame).rgba) << frame;
    EXPECT_NE(rgba, previous);
    previous = std::move(rgba);
  }
}

TEST(RenderTest, TheSeedChangesRandomPicturesOnly) {
  SettingsOverrides other;
  other.seed = 1;
  const Scene random = parse(kEverything);
  EXPECT_NE(render(random, other).rgba, render(random).rgba);
  const Scene fixed = parse("screen 32 32 sample 1 nojitter sphere 2 0 0 0");
  EXPECT_EQ(render(fixed, other).rgba, render(fixed).rgba);
}

TEST(RenderTest, TwoScenesRenderAtOnceInOneProcess) {
  const Scene first = parse(kEverything);
  const Scene second = parse("screen 40 40 sphere reflect .5 specular 1 1 1 2 0 0 0 plane 0 0 -2 0 0 1");
  const Picture a = render(first), b = render(second);
  Picture a2, b2;
  {
    std::jthread one([&] { a2 = render(parse(kEverything)); });
    std::jthread two([&] { b2 = render(second); });
  }
  EXPECT_EQ(a.rgba, a2.rgba);
  EXPECT_EQ(b.rgba, b2.rgba);
}

TEST(RenderTest, PendingWorkIsBounded) {
  // Every ray inside splits in two; the deepest trees have thousands of rays.
  const Scene scene = parse(R"(
screen 6 6  sample 1 nojitter  maxdepth 14  cutoff 0
surface m transp .5 reflect 1 specular .9 .9 .9 index 1.01
sphere m 4 0 0 0
sphere m 3 0 0 0
sphere m 2 0 0 0
)");
  const Picture picture = render(scene);
  EXPECT_GT(picture.statistics.shading.total_rays(), 20'000u);
  EXPECT_LT(picture.statistics.peak_tree_nodes, 64u * 2 * 16);
}

TEST(RenderTest, StoppingLeavesWholeBlocks) {
  const Scene scene = parse(kEverything);
  const RenderSettings settings = resolve_settings(scene.settings, {});
  MemoryProvider provider;
  RenderOptions options;
  options.block_side = 16;
  Renderer renderer(scene, settings, provider, options);
  FrameBufferOptions buffer;
  buffer.width = settings.window_width();
  buffer.height = settings.window_height();
  FrameBuffer picture(buffer);
  const std::atomic<bool> stop{true};
  EXPECT_FALSE(renderer.render_frame({0, picture, stop}));
  EXPECT_EQ(picture.present() % 16, 0);
  EXPECT_LT(picture.present(), buffer.width * buffer.height);
}

TEST(RenderTest, SkippedWorkIsCounted) {
  const Scene scene = parse(R"(
screen 32 32 sample 1 nojitter
light 1 point 0 -10 0
light 1 point 0 10 0
light 0 0 0 point 5 -10 0
name never list sphere 1 0 0 0 sphere 1 1 0 0 end
sphere ambient .1 .1 .1 diffuse .5 .5 .5 2 0 0 0
)");
  const RenderStatistics s = render(scene).statistics;
  EXPECT_GT(s.shading.skipped_back_lights, 100u);
  EXPECT_GT(s.shading.skipped_dark_lights, 100u);
  EXPECT_EQ(s.compile.unused_objects, 1u);
  EXPECT_TRUE(s.without_motion && s.without_lens && s.without_csg && s.without_transparency &&
              s.without_textures && s.without_atmosphere);
  EXPECT_EQ(s.shading.reflected_rays + s.shading.transmitted_rays, 0u);
}

TEST(RenderTest, ExplainTellsThePixelsColour) {
  const Scene scene = parse(kEverything);
  const RenderSettings settings = resolve_settings(scene.settings, {});
  MemoryProvider provider;
  Renderer renderer(scene, settings, provider, {});
  const std::string text = renderer.explain(0, 24, 26);
  EXPECT_NE(text.find("eye ray, depth 0"), std::string::npos) << text;
  EXPECT_NE(text.find("hits"), std::string::npos);
  EXPECT_NE(text.find("colour ["), std::string::npos);
}

TEST(RenderTest, DegenerateMotionIsAnErrorWithTimeAndPlace) {
  const Scene scene = parse("screen 8 8 sample 1 nojitter\nsphere 2 0 0 0 scale (time - 1) 1 1\nstarttime 1");
  try {
    render(scene);
    FAIL() << "no error";
  } catch (const RenderError& error) {
    EXPECT_NE(std::string(error.what()).find("time 1"), std::string::npos) << error.what();
    EXPECT_EQ(error.location.line, 2u);
  }
}

}  // namespace
}  // namespace rayshade
