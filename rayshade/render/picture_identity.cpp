// SPDX-License-Identifier: MIT
#include "rayshade/render/picture_identity.h"

#include <fmt/format.h>

namespace rayshade {
namespace {

/// Of larger scenes only the hash is compared: their texts would take memory and time.
constexpr std::size_t kMostNodes = 50'000;
constexpr std::size_t kLargestText = 4 << 20;

std::string words(const Vec3& v) { return fmt::format("{} {} {}", v.x, v.y, v.z); }
std::string words(const Color& c) { return fmt::format("{} {} {}", c.r, c.g, c.b); }

const char* storage_name(PixelStorage storage) {
  switch (storage) {
    case PixelStorage::kByte:
      return "8 bits";
    case PixelStorage::kWord:
      return "16 bits";
    case PixelStorage::kFloat:
      return "floats";
    case PixelStorage::kExponential:
      break;
  }
  return "exponential";
}

std::string scene_text(const Scene& scene) {
  if (scene.nodes.size() > kMostNodes) return {};
  std::string text = canonical_text(scene);
  return text.size() > kLargestText ? std::string() : text;
}

}  // namespace

// Effects of the atmosphere come from the scene alone, whose hash covers them.
JournalIdentity picture_identity(const Scene& scene, const std::string& scene_hash, const RenderSettings& s,
                                 const PictureFormat& format, bool sample_map,
                                 const std::map<std::string, std::string>& files,
                                 const std::string& version) {
  JournalIdentity out{scene_hash, {}, [&scene] { return scene_text(scene); }};
  const auto add = [&](const std::string& name, const auto& value) {
    out.values.emplace_back(name, fmt::format("{}", value));
  };
  add("version", version);
  add("screen", fmt::format("{} x {}", s.width, s.height));
  add("window", fmt::format("{} {} {} {}", s.min_x, s.max_x, s.min_y, s.max_y));
  add("samples", s.samples);
  add("sampling", s.sobol() ? "sobol" : "original");
  add("tolerance", s.sobol() ? fmt::format("{}", s.tolerance) : "none");
  add("jitter", s.jitter);
  add("filter", s.filter == FilterKind::kGauss ? "gauss" : "box");
  add("filter width", s.filter_width);
  add("contrast", words(s.contrast));
  add("cutoff", words(s.cutoff));
  add("maximum depth", s.max_depth);
  add("shadows", s.shadows);
  add("transparent shadows", s.transparent_shadows);
  add("flipped normals", s.flip_normals);
  add("seed", s.seed);
  add("eye", words(s.eye));
  add("look", words(s.look));
  add("up", words(s.up));
  add("field of view", fmt::format("{} {}", s.horizontal_fov, s.vertical_fov));
  add("aperture", s.aperture);
  add("focal distance", s.focal_distance ? fmt::format("{}", *s.focal_distance) : "not set");
  add("eye separation", s.eye_separation);
  add("stereo", s.stereo == Eye::kLeft ? "left" : s.stereo == Eye::kRight ? "right" : "none");
  add("background", words(s.background));
  add("ambient light", words(s.ambient_light));
  add("atmosphere index", s.atmosphere_index);
  add("shutter", s.shutter);
  add("start time", s.start_time);
  add("frame length", s.frame_length);
  add("first frame", s.first_frame);
  add("frames", s.frames);
  add("pixels", storage_name(format.storage));
  add("gamma", format.encoding.gamma);
  add("srgb", format.encoding.srgb);
  add("sample map", sample_map);
  std::string layers;
  for (const std::string& layer : format.layers) layers += (layers.empty() ? "" : " ") + layer;
  add("layers", layers.empty() ? "none" : layers);
  for (const auto& [name, hash] : files) add(fmt::format("the content of '{}'", name), hash);
  return out;
}

}  // namespace rayshade
