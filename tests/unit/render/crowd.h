// SPDX-License-Identifier: MIT
// A scene with enough objects for trees, rendered with its statistics and layers.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "rayshade/lang/parse.h"
#include "rayshade/render/renderer.h"

namespace rayshade::test {

/// Spheres of all surfaces before a backdrop that fills the field of view; lights of every kind. `view`:
/// settings of the screen.
inline std::string crowd(const std::string& view,
                         const std::string& eye = "eyep .3 -12 4 lookp 0 0 .7 fov 36 28") {
  std::string text = view + "\n" + eye + R"(
light .4 point 5 -9 8
light .3 directional 1 -2 3
light .2 spot -4 -8 6 0 0 0 2 40 60
light .2 extended .5 -4 -6 8
light .1 area 3 -4 6  4 -4 6 2  3 -3 6 2
surface clay ambient .1 .1 .1 diffuse .7 .5 .4
surface steel ambient .05 .05 .05 diffuse .2 .2 .25 specular .8 .8 .8 specpow 30 reflect .5
surface glass transp .8 body .95 1 .95 specular .5 .5 .5 specpow 40 reflect .1 index 1.1
plane clay 0 0 -3 0 0 1
poly clay -30 9 -30  30 9 -30  30 9 30  -30 9 30
)";
  for (int i = 0; i < 40; ++i) {
    const char* surface = i % 5 == 0 ? "glass" : i % 5 == 1 ? "steel" : "clay";
    text += "sphere " + std::string(surface) + " .45 " + std::to_string(i % 8 * .9 - 3.1) + " " +
            std::to_string(i * 3 % 5 - 2) + " " + std::to_string(i / 8 * .8 - .9) + "\n";
  }
  return text;
}

inline Scene parse_scene_text(const std::string& text) {
  MemoryProvider provider;
  provider.add("test.ray", text);
  ParseResult result = parse_scene(provider, "test.ray", {});
  for (const Diagnostic& d : result.diagnostics) {
    if (d.severity == Severity::kError) ADD_FAILURE() << format_diagnostic(d, false);
  }
  return std::move(result.scene);
}

/// One frame of a scene, and the renderer that made it.
struct Rendered {
  Scene scene;
  RenderSettings settings;
  MemoryProvider provider;
  Renderer renderer;
  FrameBuffer picture;

  Rendered(const std::string& text, const RenderOptions& options, const std::vector<std::string>& layers = {})
      : scene(parse_scene_text(text)),
        settings(resolve_settings(scene.settings, {})),
        renderer(scene, settings, provider, options),
        picture(buffer(settings, layers)) {
    const std::atomic<bool> stop{false};
    EXPECT_TRUE(renderer.render_frame({0, picture, stop}));
  }
  const RenderStatistics& statistics() const { return renderer.statistics(); }
  double sum_of(const std::string& layer) const {
    double sum = 0;
    for (std::int64_t y = 0; y < picture.height(); ++y) {
      const float* row = picture.layer_row(picture.layer_index(layer), y);
      for (std::int64_t x = 0; x < picture.width(); ++x) sum += row[x];
    }
    return sum;
  }

 private:
  static FrameBufferOptions buffer(const RenderSettings& settings, const std::vector<std::string>& layers) {
    FrameBufferOptions out;
    out.width = settings.window_width();
    out.height = settings.window_height();
    out.layers = layers;
    return out;
  }
};

}  // namespace rayshade::test
