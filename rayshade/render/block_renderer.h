// SPDX-License-Identifier: MIT
// Blocks in, pixels out: sampling, refinement and filtering of one rectangle of the screen (shading.md 7).
#pragma once

#include <cstdint>
#include <vector>

#include "rayshade/render/statistics.h"
#include "rayshade/sampling/camera.h"
#include "rayshade/sampling/grid.h"
#include "rayshade/sampling/pixel_filter.h"
#include "rayshade/sampling/refine.h"
#include "rayshade/sampling/stop.h"
#include "rayshade/shading/ray_tree.h"
#include "rayshade/shading/reused_list.h"

namespace rayshade {

/// What all threads share while a frame is rendered.
struct FrameScene {
  ShadingScene shading;
  const Camera* camera = nullptr;
  const SampleGrid* grid = nullptr;
  const PixelFilter* filter = nullptr;  ///< of SamplingKind::kSobol
  bool layers = false;                  ///< depth, normal, object and samples are wanted
  bool cost = false;                    ///< tests and time per pixel are wanted
  std::vector<std::uint32_t> numbers;   ///< object_numbers, where layers are wanted or a pixel is explained
  bool sample_map = false;              ///< alpha tells which pixels are fully sampled (-m)
};

/// Finished pixels of a rectangle, row by row.
struct BlockPixels {
  PixelRect rect;
  struct Layer {
    float depth = 0;  ///< distance of the first sample's hit; infinite where nothing was hit
    float normal[3] = {0, 0, 0};
    float object = 0;  ///< number of the primitive, from 1; 0 where nothing was hit
    float samples = 0;
    float tests = 0;  ///< exact tests and bounds tests of all rays of the pixel
    float bounds_tests = 0;
    float microseconds = 0;
    float rays = 0;       ///< queries of all rays of the pixel
    float tree_rays = 0;  ///< of these: answered by trees
  };
  std::vector<double> rgba;   ///< 4 per pixel: linear colour and alpha
  std::vector<Layer> layers;  ///< empty unless layers or cost are wanted
};

/// Samples traced together: enough to fill spans of queries, few enough to stay in cache.
inline constexpr std::size_t kSamplesTogether = 1024;

inline void store_pixel(double* pixel, const Color& color, double alpha) {
  pixel[0] = color.r;
  pixel[1] = color.g;
  pixel[2] = color.b;
  pixel[3] = alpha;
}

/// Renders blocks; one per thread. The pixels of a rectangle are a function of the frame and the rectangle's
/// pixels alone, whatever rectangle they are part of.
class BlockRenderer {
 public:
  explicit BlockRenderer(const FrameScene& frame);
  /// `rect` in screen coordinates, within the screen.
  void render(const PixelRect& rect, BlockPixels& out);
  /// The tree of every sample of one pixel, told to the observer.
  void observe(int x, int y, TreeObserver& observer);

  RayTree& tree() { return tree_; }
  const SamplingCounts& counts() const { return counts_; }

 private:
  /// Of one sample, beside what SampleDetail counts.
  struct SampleCost {
    float microseconds = 0, rays = 0, tree_rays = 0;
  };
  /// What samples brought back, in the order in which they were taken.
  struct Traced {
    std::vector<SampleResult> results;
    std::vector<SampleDetail> details;  ///< where layers or costs are wanted
    std::vector<SampleCost> costs;      ///< where costs are wanted

    void clear() {
      results.clear();
      details.clear();
      costs.clear();
    }
  };

  bool layered() const { return frame_.layers || frame_.cost; }
  void take_sample(int x, int y, int k);
  int chosen_sample(int x, int y) const;
  void make_rays();
  void trace_samples(Traced& traced);
  void render_single(const PixelRect& outer, BlockPixels& out);
  struct Rounds {
    BlockPixels& out;
    PixelRect outer;                  ///< the block and its halo
    std::vector<SampleSums> sums;     ///< per pixel of `outer`
    std::vector<std::size_t> owners;  ///< pixel in `outer` of each of samples_
  };
  void take_samples(Rounds& rounds, std::size_t pixel, int from, int to);
  void trace_round(Rounds& rounds);
  void render_until_exact(const PixelRect& rect, BlockPixels& out);
  /// What the first sample of a pixel tells its layers.
  void note_layer(const Traced& traced, std::size_t i, BlockPixels::Layer& layer) const;
  /// What sample `i` has cost.
  static void add_cost(const Traced& traced, std::size_t i, BlockPixels::Layer& layer);

  const FrameScene& frame_;
  RayTree tree_;
  SamplingCounts counts_;
  ReusedList<EyeSample> samples_;   ///< to be traced
  std::vector<NearestQuery> rays_;  ///< theirs; what all eye rays have alike stays as it is
  Traced single_;                   ///< the one sample of every pixel of a block and its halo
  Traced traced_;                   ///< all others
};

}  // namespace rayshade
