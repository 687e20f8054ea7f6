// SPDX-License-Identifier: MIT
// A scene from text, compiled, with its textures: what a ray sees of it. For tests.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "rayshade/lang/parse.h"
#include "rayshade/texture/apply.h"

namespace rayshade::test {

class TexturedScene {
 public:
  /// Throws what compiling throws, std::runtime_error with the messages where the text is no scene.
  explicit TexturedScene(const std::string& text, const std::map<std::string, std::string>& files = {}) {
    provider_.add("scene.ray", text);
    for (const auto& [name, content] : files) provider_.add(name, content);
    ParseResult result = parse_scene(provider_, "scene.ray");
    std::string messages;
    for (const Diagnostic& d : result.diagnostics) messages += format_diagnostic(d, false);
    if (!result.ok) throw std::runtime_error(messages);
    scene_ = std::move(result.scene);
    compiled_ = compile_scene(scene_, provider_, {});
    textures_ = CompiledTextures(*compiled_, provider_);
  }

  const Scene& scene() const { return scene_; }
  const CompiledScene& compiled() const { return *compiled_; }
  const CompiledTextures& textures() const { return textures_; }

  /// The nearest hit of a ray.
  std::optional<Hit> hit(const Ray& ray) {
    Hit nearest;
    if (!nearest_in_group(*compiled_, 0, ray, kEpsilon, kFar, kAnyOpacity, 0, scratch_, nearest)) return {};
    return nearest;
  }
  static Ray ray(const Vec3& from, const Vec3& toward, double time = 0) {
    return {from, normalize(toward - from), time, true};
  }

  /// What is seen from one point toward another; nothing hit is a failure of the test.
  TexturedHit look(const Vec3& from, const Vec3& toward, double time = 0, const SampleContext& sample = {}) {
    const Ray r = ray(from, toward, time);
    const auto found = hit(r);
    TexturedHit out;
    if (!found) {
      ADD_FAILURE() << "nothing hit";
    } else {
      evaluate_hit(*compiled_, textures_, *found, r, sample, scratch_, out);
    }
    return out;
  }
  Transmittance transmittance(const Vec3& from, const Vec3& toward, double time = 0) {
    const Ray r = ray(from, toward, time);
    const auto found = hit(r);
    if (!found) throw std::runtime_error("nothing hit");
    return evaluate_transmittance(*compiled_, textures_, *found, r, scratch_);
  }
  TraceScratch& scratch() { return scratch_; }

 private:
  MemoryProvider provider_;
  Scene scene_;
  std::unique_ptr<CompiledScene> compiled_;
  CompiledTextures textures_;
  TraceScratch scratch_;
};

}  // namespace rayshade::test
