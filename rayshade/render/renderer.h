// SPDX-License-Identifier: MIT
// A scene ready to be rendered, and the threads that render its frames.
//
// Blocks come from a feed; a finished block is converted to the picture's format at once. No sum depends on
// which thread did what when. A stop request ends after the blocks at hand, so that what is in the frame
// buffer is whole blocks.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "rayshade/image/frame_buffer.h"
#include "rayshade/render/block_renderer.h"
#include "rayshade/render/frame_crew.h"
#include "rayshade/render/frame_job.h"
#include "rayshade/render/statistics.h"
#include "rayshade/scene/provider.h"
#include "rayshade/scene/scene.h"

namespace rayshade {

enum class IntersectorKind : std::uint8_t { kFas, kHierarchy, kBruteForce };

struct RenderOptions {
  int threads = 1;
  int block_side = 0;  ///< 0: chosen from picture and threads
  IntersectorKind intersector = IntersectorKind::kFas;
  std::size_t fas_memory = 0;  ///< bytes for the hyper-trees; 0: a quarter of what the process may use
  fas::Split fas_split = fas::Split::kAdaptive;
  bool fas_choose = true;  ///< FasOptions::choose
  int renderers = 1;       ///< processes that share the pictures, about evenly: each expects as few rays
  /// Puts an intersector of one's own around (or in place of) the one made: to record or to check its
  /// answers.
  std::function<std::unique_ptr<Intersector>(const CompiledScene&, std::unique_ptr<Intersector>)> wrap;
  /// Share of all queries that brute force is asked again (VerifyingIntersector); 0: none, at no cost.
  double verify = 0;
  std::function<void(const std::string&)> report_difference;  ///< VerifyOptions::report
  bool layers = false;
  bool cost = false;
  bool sample_map = false;    ///< alpha tells which pixels are fully sampled
  bool unused_files = false;  ///< CompileOptions::unused_files
};

/// An error while preparing or rendering, with its place where there is one.
struct RenderError : std::runtime_error {
  RenderError(const std::string& what, Location where) : std::runtime_error(what), location(where) {}
  Location location;
};

class Renderer {
 public:
  /// Compiles geometry and textures; reads the files they name through the provider. Throws RenderError.
  Renderer(const Scene& scene, const RenderSettings& settings, Provider& provider,
           const RenderOptions& options);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Renders what is missing of a frame. Returns false if the job was stopped before the end. Throws
  /// RenderError.
  bool render_frame(const FrameJob& job);
  /// Prepares a frame and sets the threads to work on the blocks of a feed. One crew at a time; it and the
  /// feed end before the renderer does. Throws RenderError.
  std::unique_ptr<FrameCrew> start_frame(int frame, const PictureFormat& format, BlockFeed& feed,
                                         int threads);
  /// After the feed has ended: waits for the crew. Throws RenderError.
  void finish_frame(FrameCrew& crew);
  /// Counts a frame that took so many seconds.
  void count_frame(const FrameBuffer& picture, double seconds);
  /// The ray tree of one pixel as text.
  std::string explain(int frame, int x, int y);

  const RenderStatistics& statistics() const { return statistics_; }
  const CompiledScene& compiled() const { return *compiled_; }
  const Camera& camera() const { return *camera_; }
  /// The tree of eye rays as it is now; null where there is none. Not while a frame is rendered.
  const fas::HyperTree* eye_tree() const { return intersector_->eye_tree(); }
  /// The classes of rays of this scene, as make_fas takes them.
  FasOptions fas_options() const;

 private:
  bool brute_force() const { return options_.intersector == IntersectorKind::kBruteForce; }
  void make_intersector();
  void prepare_frame(int frame);

  RenderSettings settings_;
  RenderOptions options_;
  std::unique_ptr<CompiledScene> compiled_;
  std::unique_ptr<CompiledTextures> textures_;
  std::unique_ptr<Intersector> intersector_;
  const VerifyingIntersector* verifier_ = nullptr;  ///< intersector_, if that is one
  std::unique_ptr<Camera> camera_;
  std::unique_ptr<SampleGrid> grid_;
  std::unique_ptr<PixelFilter> filter_;  ///< where the sampling has one
  FrameScene frame_;
  RenderStatistics statistics_;
};

/// Bytes that a rendering will need, before anything large is allocated: picture, layers, threads.
std::uint64_t estimate_picture_bytes(const RenderSettings& settings, std::size_t bytes_per_pixel);
/// Bytes that this process may still take: the smallest of the machine's available memory, the limit of its
/// control group, and its address space limit.
std::uint64_t available_memory();
/// Bytes that this process has had of the machine's memory at most.
std::uint64_t peak_memory();
/// Threads that this process may use: affinity mask, control group quota, SLURM_CPUS_PER_TASK. Where `share`
/// processes of one job are on this machine, what is not already given to each of them is divided (rule 19).
int available_threads(int share = 1);

}  // namespace rayshade
