// SPDX-License-Identifier: MIT
#include "rayshade/render/renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "rayshade/render/explain.h"
#include "rayshade/render/object_numbers.h"
#include "rayshade/render/picture_feed.h"
#include "rayshade/schedule/block_grid.h"
#include "rayshade/texture/compiled_textures.h"

namespace rayshade {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Interval shutter_of(const RenderSettings& settings, int frame) {
  const double start = settings.frame_start(frame);
  return {start, start + std::max(0.0, settings.shutter)};
}

/// Turns the exceptions of the lower layers into one kind with a place.
template <typename Work>
auto located(const Work& work) {
  try {
    return work();
  } catch (const CompileError& error) {
    throw RenderError(error.what(), error.location);
  } catch (const TextureError& error) {
    throw RenderError(error.what(), error.location);
  } catch (const MotionError& error) {
    throw RenderError(error.what(), error.location);
  }
}

}  // namespace

Renderer::Renderer(const Scene& scene, const RenderSettings& settings, Provider& provider,
                   const RenderOptions& options)
    : settings_(settings), options_(options) {
  const Clock::time_point start = Clock::now();
  located([&] {
    CompileOptions compile;
    compile.flip_normals = settings.flip_normals;
    compile.shutter = shutter_of(settings, settings.first_frame);
    compile.frame = settings.first_frame;
    compile.hierarchies = !brute_force();
    compile.threads = options.threads;
    compile.unused_files = options.unused_files;
    compiled_ = compile_scene(scene, provider, compile);
    textures_ = std::make_unique<CompiledTextures>(*compiled_, provider, options.unused_files);
  });
  if (compiled_->counts.primitives == 0) throw RenderError("nothing to render: the scene has no objects", {});
  camera_ = std::make_unique<Camera>(settings_);
  grid_ = std::make_unique<SampleGrid>(settings_);
  if (settings_.sobol()) filter_ = std::make_unique<PixelFilter>(settings_.filter, settings_.filter_width);
  frame_.shading.compiled = compiled_.get();
  frame_.shading.textures = textures_.get();
  frame_.shading.settings = &settings_;
  frame_.shading.lights = prepare_lights(scene, settings_);
  for (std::size_t i = 0; i < frame_.shading.lights.size(); ++i)
    statistics_.light_names.push_back(light_name(frame_.shading.lights, i));
  make_intersector();
  frame_.shading.intersector = intersector_.get();
  frame_.camera = camera_.get();
  frame_.shading.look_distance = camera_->look_distance();
  frame_.grid = grid_.get();
  frame_.filter = filter_.get();
  frame_.layers = options.layers;
  frame_.cost = options.cost;
  frame_.sample_map = options.sample_map;

  statistics_.compile = compiled_->counts;
  statistics_.threads = options.threads;
  statistics_.verify_share = options.verify;
  statistics_.without_motion = !compiled_->has_motion;
  statistics_.without_lens = !camera_->has_lens();
  statistics_.without_csg = !compiled_->has_csg;
  statistics_.without_transparency = !compiled_->has_transparent;
  statistics_.without_textures = !compiled_->has_textures;
  statistics_.without_atmosphere = settings.effects.empty();
  statistics_.compile_seconds = seconds_since(start);
}

Renderer::~Renderer() = default;

FasOptions Renderer::fas_options() const {
  FasOptions options;
  if (camera_->has_lens())
    options.eye.bounds = camera_->lens_bounds();
  else
    options.eye = {RayClass::Kind::kPoint, camera_->eye(), {}};
  for (const ShadingLight& light : frame_.shading.lights) options.lights.push_back(shadow_class(light));
  options.memory = options_.fas_memory > 0 ? options_.fas_memory : available_memory() / 4;
  options.split = options_.fas_split;
  options.choose = options_.fas_choose;
  options.rays = static_cast<double>(settings_.window_width()) * settings_.window_height() *
                 settings_.samples * settings_.samples / std::max(options_.renderers, 1);
  return options;
}

void Renderer::make_intersector() {
  switch (options_.intersector) {
    case IntersectorKind::kBruteForce:
      intersector_ = make_brute_force(*compiled_);
      break;
    case IntersectorKind::kHierarchy:
      intersector_ = make_hierarchy(*compiled_);
      break;
    case IntersectorKind::kFas:
      intersector_ = make_fas(*compiled_, fas_options());
      break;
  }
  if (options_.wrap) intersector_ = options_.wrap(*compiled_, std::move(intersector_));
  if (options_.verify > 0) {
    auto verifier = std::make_unique<VerifyingIntersector>(
        *compiled_, std::move(intersector_),
        VerifyOptions{options_.verify, statistics_.light_names, options_.report_difference});
    verifier_ = verifier.get();
    intersector_ = std::move(verifier);
  }
}

void Renderer::prepare_frame(int frame) {
  frame_.shading.frame = frame;
  if (located(
          [&] { return compiled_->prepare_frame(shutter_of(settings_, frame), frame, !brute_force()); })) {
    intersector_->scene_changed();
    frame_.numbers.clear();
  }
  if (options_.layers && frame_.numbers.empty()) frame_.numbers = object_numbers(*compiled_);
}

std::unique_ptr<FrameCrew> Renderer::start_frame(int frame, const PictureFormat& format, BlockFeed& feed,
                                                 int threads) {
  prepare_frame(frame);
  return std::make_unique<FrameCrew>(
      FrameCrew::Job{frame_, settings_, format, feed, threads, brute_force(), statistics_});
}

void Renderer::finish_frame(FrameCrew& crew) {
  located([&] { crew.finish(); });
  if (verifier_) statistics_.verify = verifier_->counts();
}

bool Renderer::render_frame(const FrameJob& job) {
  const Clock::time_point start = Clock::now();
  FrameBuffer& picture = job.picture;
  const int width = settings_.window_width(), height = settings_.window_height();
  PictureFeed feed(job, options_.block_side > 0 ? options_.block_side
                                                : default_block_side(width, height, options_.threads));
  if (feed.missing() > 0) {
    const int threads = static_cast<int>(std::min<std::int64_t>(options_.threads, feed.missing()));
    const std::unique_ptr<FrameCrew> crew = start_frame(job.frame, format_of(picture), feed, threads);
    for (bool ended = false; !ended;) {
      ended = crew->wait(0.1);
      if (job.progress) job.progress(feed.progress());
    }
    finish_frame(*crew);
  }
  count_frame(picture, seconds_since(start));
  return picture.complete();
}

void Renderer::count_frame(const FrameBuffer& picture, double seconds) {
  statistics_.render_seconds += seconds;
  const PixelStatistics seen = picture.statistics();
  statistics_.nan_pixels += seen.not_a_number;
  statistics_.negative_pixels += seen.negative;
  statistics_.frames += picture.complete();
}

std::string Renderer::explain(int frame, int x, int y) {
  prepare_frame(frame);
  frame_.numbers = object_numbers(*compiled_);
  BlockRenderer renderer(frame_);
  renderer.tree().scratch().brute_force = brute_force();
  ExplainText text(frame_);
  located([&] { renderer.observe(x, y, text); });
  if (verifier_) statistics_.verify = verifier_->counts();
  return text.text();
}

}  // namespace rayshade
