// SPDX-License-Identifier: MIT
#include "rayshade/render/frame_crew.h"

#include <chrono>
#include <ctime>

#include "rayshade/render/block_layers.h"

namespace rayshade {
namespace {

double thread_cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

PictureFormat format_of(const FrameBuffer& picture) {
  return {picture.storage(), picture.encoder().encoding(), picture.layers()};
}

FrameCrew::FrameCrew(const Job& job) : job_(job), encoder_(job.format.encoding), working_(job.threads) {
  const BlockLayers check(job.format.layers);
  threads_.reserve(static_cast<std::size_t>(job.threads));
  for (int i = 0; i < job.threads; ++i) threads_.emplace_back([this] { work(); });
}

FrameCrew::~FrameCrew() {
  job_.feed.close();
  for (std::thread& thread : threads_)
    if (thread.joinable()) thread.join();
}

bool FrameCrew::wait(double seconds) {
  std::unique_lock lock(mutex_);
  return ended_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return working_ == 0; });
}

void FrameCrew::finish() {
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
  if (error_) std::rethrow_exception(error_);
}

void FrameCrew::render_blocks(BlockRenderer& renderer) {
  BlockLayers layers(job_.format.layers);
  BlockPixels pixels;
  const RenderSettings& settings = job_.settings;
  while (const std::optional<Block> block = job_.feed.next()) {
    const double start = thread_cpu_seconds();
    const int x = settings.min_x + block->x, y = settings.min_y + block->y;
    renderer.render({x, y, x + block->width, y + block->height}, pixels);
    EncodedBlock out =
        encode_block({block->x, block->y, block->width, block->height, pixels.rgba, layers.of(pixels)},
                     job_.format.storage, encoder_);
    job_.feed.finished(*block, std::move(out), {thread_cpu_seconds() - start});
  }
}

void FrameCrew::work() {
  const double cpu = thread_cpu_seconds();
  BlockRenderer renderer(job_.frame);
  TraceScratch& scratch = renderer.tree().scratch();
  scratch.brute_force = job_.brute_force;
  std::exception_ptr error;
  try {
    render_blocks(renderer);
  } catch (...) {
    error = std::current_exception();
    job_.feed.close();
  }
  const std::lock_guard lock(mutex_);
  if (error && !error_) error_ = error;
  RenderStatistics& statistics = job_.statistics;
  statistics.trace.add(scratch.counts);
  job_.frame.shading.intersector->report(scratch, statistics.intersector);
  statistics.shading.add(renderer.tree().counts());
  statistics.sampling.add(renderer.counts());
  statistics.peak_tree_nodes =
      std::max<std::uint64_t>(statistics.peak_tree_nodes, renderer.tree().peak_nodes());
  statistics.cpu_seconds += thread_cpu_seconds() - cpu;
  if (--working_ == 0) ended_.notify_all();
}

}  // namespace rayshade
