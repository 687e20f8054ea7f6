// SPDX-License-Identifier: MIT
#include "rayshade/render/renderer.h"

#include <fmt/format.h>

#include <chrono>
#include <condition_variable>
#include <ctime>
#include <exception>
#include <mutex>
#include <thread>

#include "rayshade/render/explain.h"
#include "rayshade/render/object_numbers.h"
#include "rayshade/schedule/block_grid.h"
#include "rayshade/texture/compiled_textures.h"

namespace rayshade {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double thread_cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
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
    throw RenderError(fmt::format("{} at time {}", error.what(), error.time), error.location);
  }
}

/// Float layers of a block, in the order of the frame buffer's layers.
class LayerSpans {
 public:
  explicit LayerSpans(const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      if (name == "depth.Z")
        fields_.push_back(offsetof(BlockPixels::Layer, depth));
      else if (name == "normal.X")
        fields_.push_back(offsetof(BlockPixels::Layer, normal));
      else if (name == "normal.Y")
        fields_.push_back(offsetof(BlockPixels::Layer, normal) + sizeof(float));
      else if (name == "normal.Z")
        fields_.push_back(offsetof(BlockPixels::Layer, normal) + 2 * sizeof(float));
      else if (name == "object")
        fields_.push_back(offsetof(BlockPixels::Layer, object));
      else if (name == "samples")
        fields_.push_back(offsetof(BlockPixels::Layer, samples));
      else if (name == "tests")
        fields_.push_back(offsetof(BlockPixels::Layer, tests));
      else if (name == "bounds_tests")
        fields_.push_back(offsetof(BlockPixels::Layer, bounds_tests));
      else if (name == "microseconds")
        fields_.push_back(offsetof(BlockPixels::Layer, microseconds));
      else if (name == "rays")
        fields_.push_back(offsetof(BlockPixels::Layer, rays));
      else if (name == "tree_rays")
        fields_.push_back(offsetof(BlockPixels::Layer, tree_rays));
      else
        throw std::invalid_argument("unknown layer " + name);
    }
    values_.resize(fields_.size());
  }

  std::vector<std::span<const float>> of(const BlockPixels& block) {
    std::vector<std::span<const float>> spans;
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      values_[i].clear();
      for (const BlockPixels::Layer& layer : block.layers) {
        values_[i].push_back(
            *reinterpret_cast<const float*>(reinterpret_cast<const char*>(&layer) + fields_[i]));
      }
      spans.emplace_back(values_[i]);
    }
    return spans;
  }

 private:
  std::vector<std::size_t> fields_;
  std::vector<std::vector<float>> values_;
};

/// What the threads of one frame share.
struct Crew {
  std::atomic<std::int64_t> next{0};
  std::atomic<bool> failed{false};
  std::mutex mutex;
  std::condition_variable news;
  int working = 0;
  FrameProgress progress;
  std::exception_ptr error;
};

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
    compiled_ = compile_scene(scene, provider, compile);
    textures_ = std::make_unique<CompiledTextures>(*compiled_, provider);
  });
  if (compiled_->counts.primitives == 0) throw RenderError("nothing to render: the scene has no objects", {});
  camera_ = std::make_unique<Camera>(settings_);
  grid_ = std::make_unique<SampleGrid>(settings_);
  frame_.shading.compiled = compiled_.get();
  frame_.shading.textures = textures_.get();
  frame_.shading.settings = &settings_;
  frame_.shading.lights = prepare_lights(scene);
  for (std::size_t i = 0; i < frame_.shading.lights.size(); ++i)
    statistics_.light_names.push_back(light_name(frame_.shading.lights, i));
  make_intersector();
  frame_.shading.intersector = intersector_.get();
  frame_.camera = camera_.get();
  frame_.grid = grid_.get();
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
  options.rays = static_cast<double>(settings_.window_width()) * settings_.window_height() *
                 settings_.samples * settings_.samples;
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

bool Renderer::render_frame(int frame, FrameBuffer& picture, const std::atomic<bool>& stop,
                            const std::function<void(const FrameProgress&)>& progress) {
  const Clock::time_point start = Clock::now();
  prepare_frame(frame);
  const int width = settings_.window_width(), height = settings_.window_height();
  const int side =
      options_.block_side > 0 ? options_.block_side : default_block_side(width, height, options_.threads);
  const BlockGrid grid(width, height, side);
  const int threads = static_cast<int>(std::min<std::int64_t>(options_.threads, grid.count()));

  Crew crew;
  crew.working = threads;
  crew.progress = {0, grid.count(), 0, std::int64_t{width} * height, 0};
  std::vector<int> columns_left(static_cast<std::size_t>(grid.rows()), grid.columns());

  const auto work = [&] {
    const double cpu = thread_cpu_seconds();
    BlockRenderer renderer(frame_);
    renderer.tree().scratch().brute_force = brute_force();
    try {
      LayerSpans layers(picture.layers());
      BlockPixels pixels;
      while (!stop.load(std::memory_order_relaxed) && !crew.failed.load(std::memory_order_relaxed)) {
        const std::int64_t number = crew.next.fetch_add(1, std::memory_order_relaxed);
        if (number >= grid.count()) break;
        const Block block = grid.block(number);
        const int x = settings_.min_x + block.x, y = settings_.min_y + block.y;
        renderer.render({x, y, x + block.width, y + block.height}, pixels);
        PixelBlock out{block.x, block.y, block.width, block.height, pixels.rgba, layers.of(pixels)};
        picture.put(out);
        const std::lock_guard lock(crew.mutex);
        ++crew.progress.blocks_done;
        crew.progress.pixels_done += std::int64_t{block.width} * block.height;
        --columns_left[static_cast<std::size_t>(number / grid.columns())];
      }
    } catch (...) {
      const std::lock_guard lock(crew.mutex);
      if (!crew.error) crew.error = std::current_exception();
      crew.failed = true;
    }
    const std::lock_guard lock(crew.mutex);
    statistics_.trace.add(renderer.tree().scratch().counts);
    intersector_->report(renderer.tree().scratch(), statistics_.intersector);
    statistics_.shading.add(renderer.tree().counts());
    statistics_.sampling.add(renderer.counts());
    statistics_.peak_tree_nodes =
        std::max<std::uint64_t>(statistics_.peak_tree_nodes, renderer.tree().peak_nodes());
    statistics_.cpu_seconds += thread_cpu_seconds() - cpu;
    --crew.working;
    crew.news.notify_all();
  };

  {
    std::vector<std::jthread> crew_threads;
    crew_threads.reserve(static_cast<std::size_t>(threads));
    for (int i = 0; i < threads; ++i) crew_threads.emplace_back(work);
    std::unique_lock lock(crew.mutex);
    std::size_t top_row = 0;
    while (crew.working > 0) {
      crew.news.wait_for(lock, std::chrono::milliseconds(100));
      while (top_row < columns_left.size() && columns_left[top_row] == 0) ++top_row;
      crew.progress.rows_done = std::min<std::int64_t>(height, static_cast<std::int64_t>(top_row) * side);
      const FrameProgress now = crew.progress;
      lock.unlock();
      if (progress) progress(now);
      lock.lock();
    }
  }
  statistics_.render_seconds += seconds_since(start);
  if (verifier_) statistics_.verify = verifier_->counts();
  if (crew.error) located([&] { std::rethrow_exception(crew.error); });
  const PixelStatistics seen = picture.statistics();
  statistics_.nan_pixels += seen.not_a_number;
  statistics_.negative_pixels += seen.negative;
  if (!picture.complete()) return false;
  ++statistics_.frames;
  return true;
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
