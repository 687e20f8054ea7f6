// SPDX-License-Identifier: MIT
// The data layers are as independent of who rendered them as the picture: whatever intersector, threads,
// blocks and frames before.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "rayshade/lang/parse.h"
#include "rayshade/render/object_numbers.h"
#include "rayshade/render/renderer.h"

namespace rayshade {
namespace {

/// Enough leaves for hierarchies in the world, in a shared group and in an operand; planes; coincident
/// surfaces; motion, so that leaves change their places from frame to frame.
std::string many_objects() {
  std::string text =
      "screen 48 40 sample 2 nojitter eyep 0 -20 3 lookp 0 0 0 fov 42\nframes 3 framelength 1\n";
  text += "surface clay diffuse .7 .5 .4\nplane clay 0 0 -1 0 0 1\nplane clay 0 0 -4 0 0 1\n";
  text += "name cluster list\n";
  for (int i = 0; i < 9; ++i) {
    text += "sphere clay .3 " + std::to_string(i % 3) + " " + std::to_string(i * 5 % 9) + " " +
            std::to_string(i / 3) + "\n";
  }
  text += "end\nobject cluster translate 2 0 -1\nobject cluster rotate 0 0 1 90 translate -3 1 -1\n";
  text += "difference box clay -5 -4 -1 -2 -3 1 union\n";
  for (int i = 0; i < 7; ++i)
    text += "sphere clay .35 " + std::to_string(-5 + i * 3 % 7 * .5) + " -4 " + std::to_string(i * .3) + "\n";
  text += "end end\n";
  for (int i = 0; i < 30; ++i) {
    const int at = i * 7 % 30;
    text += "sphere clay .4 " + std::to_string(at % 6 * 1.7 - 4) + " " + std::to_string(at / 6 - 2.5) + " " +
            std::to_string(i % 4 - .5) + " translate (time * " + std::to_string(i % 5 - 2) + ") 0 0\n";
  }
  text += "triangle clay 3 -5 0 6 -5 0 4 -5 3\ntriangle clay 3 -5 0 6 -5 0 4 -5 3\n";
  return text;
}

Scene parse(const std::string& text) {
  MemoryProvider provider;
  provider.add("test.ray", text);
  ParseResult result = parse_scene(provider, "test.ray", {});
  for (const Diagnostic& d : result.diagnostics) {
    if (d.severity == Severity::kError) ADD_FAILURE() << format_diagnostic(d, false);
  }
  return std::move(result.scene);
}

const std::vector<std::string> kLayers{"depth.Z", "normal.X", "normal.Y", "normal.Z", "object", "samples"};

/// All layers of a frame, one after the other.
std::vector<float> layers_of(Renderer& renderer, const RenderSettings& settings, int frame) {
  FrameBufferOptions buffer;
  buffer.width = settings.window_width();
  buffer.height = settings.window_height();
  buffer.layers = kLayers;
  FrameBuffer picture(buffer);
  const std::atomic<bool> stop{false};
  EXPECT_TRUE(renderer.render_frame({frame, picture, stop}));
  std::vector<float> out;
  for (int layer = 0; layer < static_cast<int>(kLayers.size()); ++layer) {
    for (std::int64_t y = 0; y < buffer.height; ++y) {
      const float* row = picture.layer_row(layer, y);
      out.insert(out.end(), row, row + buffer.width);
    }
  }
  return out;
}

std::vector<std::uint64_t> orders_of(const CompiledScene& scene) {
  std::vector<std::uint64_t> out;
  for (const Leaf& leaf : scene.leaves) out.push_back(leaf.order);
  return out;
}

class LayersTest : public ::testing::Test {
 protected:
  const Scene scene = parse(many_objects());
  const RenderSettings settings = resolve_settings(scene.settings, {});
  MemoryProvider provider;

  std::unique_ptr<Renderer> make(IntersectorKind kind, int threads = 1, int block = 0) {
    RenderOptions options;
    options.layers = true;
    options.intersector = kind;
    options.threads = threads;
    options.block_side = block;
    return std::make_unique<Renderer>(scene, settings, provider, options);
  }
};

TEST_F(LayersTest, AreTheSameByEveryIntersector) {
  const auto brute = make(IntersectorKind::kBruteForce);
  const auto hierarchy = make(IntersectorKind::kHierarchy, 2, 7);
  const auto fas = make(IntersectorKind::kFas, 3, 11);
  for (int frame = 0; frame < 3; ++frame) {
    const std::vector<float> truth = layers_of(*brute, settings, frame);
    EXPECT_EQ(layers_of(*hierarchy, settings, frame), truth) << frame;
    EXPECT_EQ(layers_of(*fas, settings, frame), truth) << frame;
    // What the numbers must be independent of does differ.
    EXPECT_NE(orders_of(hierarchy->compiled()), orders_of(brute->compiled()));
    const std::size_t pixels = static_cast<std::size_t>(settings.window_width()) * settings.window_height();
    const std::set<float> objects(truth.begin() + 4 * pixels, truth.begin() + 5 * pixels);
    EXPECT_GT(objects.size(), 25u);
    EXPECT_EQ(*objects.begin(), 0) << "some pixel sees nothing";
    EXPECT_LE(*objects.rbegin(), static_cast<float>(brute->compiled().leaves.size()));
  }
}

TEST_F(LayersTest, DoNotDependOnTheFramesBefore) {
  const auto series = make(IntersectorKind::kFas);
  for (int frame = 0; frame < 3; ++frame) {
    EXPECT_EQ(layers_of(*series, settings, frame), layers_of(*make(IntersectorKind::kFas), settings, frame))
        << frame;
  }
}

TEST_F(LayersTest, EveryLeafHasANumberOfItsOwn) {
  const auto renderer = make(IntersectorKind::kHierarchy);
  std::vector<std::uint32_t> numbers = object_numbers(renderer->compiled());
  std::sort(numbers.begin(), numbers.end());
  ASSERT_EQ(numbers.size(), renderer->compiled().leaves.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) EXPECT_EQ(numbers[i], i + 1);
}

TEST_F(LayersTest, ExplainNamesTheNumbersOfTheLayer) {
  const auto brute = make(IntersectorKind::kBruteForce), fas = make(IntersectorKind::kFas);
  const std::vector<float> layers = layers_of(*brute, settings, 1);
  const int width = settings.window_width(), height = settings.window_height();
  int named = 0;
  for (int y = 2; y < height; y += 3) {
    for (int x = 1; x < width; x += 5) {
      const std::string text = brute->explain(1, x, y);
      EXPECT_EQ(fas->explain(1, x, y), text);
      const float number = layers[(static_cast<std::size_t>(4) * height + y) * width + x];
      if (number == 0) continue;
      // "hits sphere 17 at distance", "hits sphere 3 in instance 40 at distance"
      const std::string wanted = " " + std::to_string(std::lround(number)) + " ";
      const std::size_t hits = text.find("hits ");
      ASSERT_NE(hits, std::string::npos) << text;
      EXPECT_NE(text.substr(hits, 30).find(wanted), std::string::npos) << wanted << text;
      ++named;
    }
  }
  EXPECT_GT(named, 20);
}

}  // namespace
}  // namespace rayshade
