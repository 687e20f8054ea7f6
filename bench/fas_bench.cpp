// SPDX-License-Identifier: MIT
// usage: fas_bench [--samples N] [--repeat N] [--size N] SCENE...
//
// Records the rays of each scene and replays them through adaptive subdivision, through its trees whatever
// they cost (with no choice between trees and hierarchy), through the hierarchy alone,
// and through Embree's single rays (fast and robust) and 16-wide packets, in turn within one run, on one
// thread and in its processor time. Every repetition starts without trees, and building is part of the time.
// Prints nanoseconds per ray of each class and ratios; wrong answers of ours end the run.
//
// Rays are recorded and replayed in batches, so that memory does not grow with samples; the trees of a
// repetition stay from batch to batch.
#include <pmmintrin.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/recording.h"
#include "bench/yardstick.h"
#include "rayshade/image/frame_buffer.h"

namespace rayshade::bench {
namespace {

/// Seconds of processor time of this thread: what else the machine does counts as little as possible.
double now() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

enum Class { kEye, kShadow, kSecondary, kClasses };
enum Way { kFas, kTrees, kHierarchy, kFast, kRobust, kWays };
constexpr const char* kNames[kWays] = {"fas", "trees", "hierarchy", "embree", "robust"};

struct Times {
  double rays[kClasses] = {};
  double seconds[kWays][kClasses] = {};
  double mixed[kWays] = {};
  double build[kWays] = {};
  double packets = 0;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// The queries of one class, span after span.
struct Stream {
  std::vector<NearestQuery> nearest;
  std::vector<OcclusionQuery> shadow;
  std::vector<std::size_t> spans;   ///< lengths
  std::vector<std::size_t> places;  ///< in the recording
};

Stream stream_of(const Recording& r, Class which) {
  Stream out;
  for (const Recording::Span& span : r.spans) {
    if (span.nearest == (which == kShadow)) continue;
    std::size_t taken = 0;
    for (std::size_t i = span.first; i < span.first + span.count; ++i) {
      if (which == kShadow) {
        out.shadow.push_back(r.shadow[i]);
      } else if ((r.nearest[i].kind == RayKind::kEye) == (which == kEye)) {
        out.nearest.push_back(r.nearest[i]);
      } else {
        continue;
      }
      out.places.push_back(i);
      ++taken;
    }
    if (taken > 0) out.spans.push_back(taken);
  }
  return out;
}

[[noreturn]] void wrong(const char* scene, const char* what, std::size_t ray) {
  std::fprintf(stderr, "%s: %s gives another answer for ray %zu\n", scene, what, ray);
  std::exit(1);
}

/// Replays one class span by span, and checks the answers bit by bit, outside the time taken: every few
/// thousand rays, so that reading the clock costs nothing and answers stay in the cache.
double replay(const Intersector& intersector, const Stream& s, const Recording& r, const char* scene,
              const char* name) {
  constexpr std::size_t kBetweenChecks = 2048;
  TraceScratch scratch;
  std::vector<NearestAnswer> nearest;
  std::vector<OcclusionAnswer> shadow;
  double seconds = 0;
  std::size_t first = 0;
  for (std::size_t span = 0; span < s.spans.size();) {
    std::size_t count = 0, end = span;
    while (end < s.spans.size() && count < kBetweenChecks) count += s.spans[end++];
    if (!s.shadow.empty())
      shadow.resize(std::max(shadow.size(), count));
    else
      nearest.resize(std::max(nearest.size(), count));
    const double start = now();
    for (std::size_t at = 0; span < end; at += s.spans[span++]) {
      const std::size_t n = s.spans[span];
      if (!s.shadow.empty())
        intersector.occluded({s.shadow.data() + first + at, n}, {shadow.data() + at, n}, scratch);
      else
        intersector.nearest({s.nearest.data() + first + at, n}, {nearest.data() + at, n}, scratch);
    }
    seconds += now() - start;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t place = s.places[first + i];
      if (!s.shadow.empty()) {
        if (shadow[i].occluded != (r.occluded[place] != 0)) wrong(scene, name, place);
      } else {
        const double t = nearest[i].found ? nearest[i].hit.t() : -1;
        if (t != r.distance[place] || (nearest[i].found && nearest[i].hit.leaf != r.leaf[place]))
          wrong(scene, name, place);
      }
    }
    first += count;
  }
  return seconds;
}

double replay_mixed(const Intersector& intersector, const Recording& r) {
  TraceScratch scratch;
  std::vector<NearestAnswer> nearest(8192);
  std::vector<OcclusionAnswer> shadow(8192);
  const double start = now();
  for (const Recording::Span& span : r.spans) {
    if (span.nearest)
      intersector.nearest({r.nearest.data() + span.first, span.count}, {nearest.data(), span.count}, scratch);
    else
      intersector.occluded({r.shadow.data() + span.first, span.count}, {shadow.data(), span.count}, scratch);
  }
  return now() - start;
}

double replay_mixed(Yardstick& embree, const Recording& r) {
  std::vector<double> distances(8192);
  std::vector<std::uint8_t> occluded(8192);
  const double start = now();
  for (const Recording::Span& span : r.spans) {
    if (span.nearest)
      embree.nearest({r.nearest.data() + span.first, span.count}, distances.data());
    else
      embree.occluded({r.shadow.data() + span.first, span.count}, occluded.data());
  }
  return now() - start;
}

double replay(Yardstick& embree, const Stream& s, bool packets = false) {
  std::vector<double> distances(s.nearest.size() + 16);
  std::vector<std::uint8_t> occluded(s.shadow.size());
  const double start = now();
  if (!s.shadow.empty())
    embree.occluded(s.shadow, occluded.data());
  else if (packets)
    embree.nearest16(s.nearest, distances.data());
  else
    embree.nearest(s.nearest, distances.data());
  return now() - start;
}

struct Arguments {
  int samples = 1, repeat = 3, size = 512;
  std::vector<std::string> scenes;
};

// A batch of gears is about 1 GB, and as much again while its classes are told apart.
constexpr std::size_t kBatch = 6'000'000;

/// Replays the batches of one scene in all ways, and adds up.
class Contest {
 public:
  Contest(const CompiledScene& scene, const FasOptions& options, int repeat, const char* name)
      : name_(name), fast_(scene, false), robust_(scene, true), repetitions_(repeat) {
    FasOptions always = options;
    always.choose = false;
    for (Repetition& repetition : repetitions_) {
      repetition.by_class = make_fas(scene, options);
      repetition.mixed = make_fas(scene, options);
      repetition.always_by_class = make_fas(scene, always);
      repetition.always_mixed = make_fas(scene, always);
    }
    hierarchy_ = make_hierarchy(scene);
  }

  void replay_batch(const Recording& recording) {
    Stream streams[kClasses];
    for (int c = 0; c < kClasses; ++c) {
      streams[c] = stream_of(recording, static_cast<Class>(c));
      rays_[c] += static_cast<double>(streams[c].places.size());
    }
    for (std::size_t i = 0; i < repetitions_.size(); ++i)
      for (int turn = 0; turn < kWays; ++turn)
        replay_way(static_cast<Way>((turn + i) % kWays), recording, streams, repetitions_[i]);
  }

  /// Of all batches: medians of the repetitions. Building the hierarchy is left to the caller.
  Times times() const {
    Times out;
    const auto median_of = [&](auto&& value) {
      std::vector<double> values;
      for (const Repetition& repetition : repetitions_) values.push_back(value(repetition));
      return median(values);
    };
    for (int c = 0; c < kClasses; ++c) out.rays[c] = rays_[c];
    for (int way = 0; way < kWays; ++way) {
      for (int c = 0; c < kClasses; ++c)
        out.seconds[way][c] = median_of([&](const Repetition& r) { return r.seconds[way][c]; });
      out.mixed[way] = median_of([&](const Repetition& r) { return r.mixed_seconds[way]; });
    }
    out.packets = median_of([](const Repetition& r) { return r.packets; });
    out.build[kFast] = fast_.build_seconds();
    out.build[kRobust] = robust_.build_seconds();
    return out;
  }

 private:
  struct Repetition {
    /// Trees of their own: all start without any.
    std::unique_ptr<Intersector> by_class, mixed, always_by_class, always_mixed;
    double seconds[kWays][kClasses] = {};
    double mixed_seconds[kWays] = {};
    double packets = 0;
  };

  void replay_way(Way way, const Recording& recording, const Stream* streams, Repetition& out) {
    if (way == kFas || way == kTrees || way == kHierarchy) {
      const Intersector& by_class = way == kFas     ? *out.by_class
                                    : way == kTrees ? *out.always_by_class
                                                    : *hierarchy_;
      const Intersector& mixed = way == kFas ? *out.mixed : way == kTrees ? *out.always_mixed : *hierarchy_;
      for (int c = 0; c < kClasses; ++c)
        out.seconds[way][c] += replay(by_class, streams[c], recording, name_, kNames[way]);
      out.mixed_seconds[way] += replay_mixed(mixed, recording);
      return;
    }
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    Yardstick& embree = way == kFast ? fast_ : robust_;
    for (int c = 0; c < kClasses; ++c) out.seconds[way][c] += replay(embree, streams[c]);
    out.mixed_seconds[way] += replay_mixed(embree, recording);
    if (way == kFast) out.packets += replay(embree, streams[kEye], true);
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_OFF);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_OFF);
  }

  const char* name_;
  Yardstick fast_, robust_;
  std::unique_ptr<Intersector> hierarchy_;
  std::vector<Repetition> repetitions_;
  double rays_[kClasses] = {};
};

Times measure(const std::string& path, const Arguments& arguments) {
  FileProvider provider;
  ParseResult parsed = parse_scene(provider, path, {});
  if (!parsed.ok) {
    std::fprintf(stderr, "%s: does not parse\n", path.c_str());
    std::exit(1);
  }
  SettingsOverrides overrides;
  overrides.screen = {{arguments.size, arguments.size}};
  overrides.samples = arguments.samples;
  overrides.jitter = false;
  RenderSettings settings = resolve_settings(parsed.scene.settings, overrides);
  settings.contrast = {-1, -1, -1};  // every sample of every pixel

  Recording recording;
  RenderOptions options;
  options.intersector = IntersectorKind::kHierarchy;
  std::function<void(const Recording&)> replay_batch;
  options.wrap = [&](const CompiledScene&,
                     std::unique_ptr<Intersector> inner) -> std::unique_ptr<Intersector> {
    return std::make_unique<Recorder>(std::move(inner), recording, kBatch,
                                      [&](const Recording& batch) { replay_batch(batch); });
  };
  Renderer renderer(parsed.scene, settings, provider, options);
  std::optional<Contest> contest;  // from the first batch on: the classes of rays are the frame's
  replay_batch = [&](const Recording& batch) {
    if (!contest)
      contest.emplace(renderer.compiled(), renderer.fas_options(), arguments.repeat, path.c_str());
    contest->replay_batch(batch);
  };
  FrameBufferOptions buffer;
  buffer.width = settings.window_width();
  buffer.height = settings.window_height();
  FrameBuffer picture(buffer);
  const std::atomic<bool> stop{false};
  renderer.render_frame({0, picture, stop});
  replay_batch(recording);

  Times out = contest->times();
  const double start = now();
  const_cast<CompiledScene&>(renderer.compiled()).rebuild(true);  // gives the same again
  out.build[kHierarchy] = out.build[kTrees] = out.build[kFas] = now() - start;
  return out;
}

}  // namespace

int run(const Arguments& arguments) {
  double logs[6] = {};
  int counts[6] = {};
  const auto mean = [&](int which, double ratio) {
    if (!(ratio > 0) || !std::isfinite(ratio)) return;
    logs[which] += std::log(ratio);
    ++counts[which];
  };
  std::printf("%d samples per pixel, %d x %d, medians of %d, processor time per ray in ns\n\n",
              arguments.samples * arguments.samples, arguments.size, arguments.size, arguments.repeat);
  std::printf(
      "| scene | rays eye/shadow/secondary (M) | way | eye | shadow | secondary | mixed | build ms |\n");
  std::printf("| --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const std::string& path : arguments.scenes) {
    const Times t = measure(path, arguments);
    std::string name = path.substr(path.find_last_of('/') + 1);
    name = name.substr(0, name.find('.'));
    const double all = t.rays[0] + t.rays[1] + t.rays[2];
    const auto ns = [&](double seconds, double rays) { return rays > 0 ? 1e9 * seconds / rays : 0; };
    for (int way = 0; way < kWays; ++way) {
      std::printf("| %s | %.2f/%.2f/%.2f | %s | %.0f | %.0f | %.0f | %.0f | %.1f |\n", name.c_str(),
                  1e-6 * t.rays[0], 1e-6 * t.rays[1], 1e-6 * t.rays[2], kNames[way],
                  ns(t.seconds[way][0], t.rays[0]), ns(t.seconds[way][1], t.rays[1]),
                  ns(t.seconds[way][2], t.rays[2]), ns(t.mixed[way], all), 1e3 * t.build[way]);
    }
    const double total_fas = t.build[kFas] + t.seconds[kFas][0] + t.seconds[kFas][1] + t.seconds[kFas][2];
    const double total_fast =
        t.build[kFast] + t.seconds[kFast][0] + t.seconds[kFast][1] + t.seconds[kFast][2];
    const auto ratio = [&](Way a, Way b, Class c) {
      return t.rays[c] > 0 ? t.seconds[a][c] / t.seconds[b][c] : 0;
    };
    std::printf("| %s | | fas / embree | %.2f | %.2f | %.2f | %.2f | all %.2f |\n", name.c_str(),
                ratio(kFas, kFast, kEye), ratio(kFas, kFast, kShadow), ratio(kFas, kFast, kSecondary),
                (t.mixed[kFas] + t.build[kFas]) / (t.mixed[kFast] + t.build[kFast]), total_fas / total_fast);
    std::printf("| %s | | fas / packets | %.2f | | | | packets %.0f ns |\n", name.c_str(),
                t.seconds[kFas][kEye] / t.packets, ns(t.packets, t.rays[0]));
    std::printf("| %s | | hierarchy / robust | %.2f | %.2f | %.2f | %.2f | |\n", name.c_str(),
                ratio(kHierarchy, kRobust, kEye), ratio(kHierarchy, kRobust, kShadow),
                ratio(kHierarchy, kRobust, kSecondary), t.mixed[kHierarchy] / t.mixed[kRobust]);
    std::fflush(stdout);
    mean(0, ratio(kFas, kFast, kEye));
    mean(1, ratio(kFas, kFast, kShadow));
    mean(2, ratio(kFas, kFast, kSecondary));
    mean(3, (t.mixed[kFas] + t.build[kFas]) / (t.mixed[kFast] + t.build[kFast]));
    mean(4, total_fas / total_fast);
    mean(5, t.seconds[kFas][kEye] / t.packets);
  }
  const auto result = [&](int i) { return counts[i] > 0 ? std::exp(logs[i] / counts[i]) : 0; };
  std::printf(
      "\ngeometric means, fas / embree: eye %.2f shadow %.2f secondary %.2f mixed %.2f all %.2f; fas / "
      "packets: eye %.2f\n",
      result(0), result(1), result(2), result(3), result(4), result(5));
  return 0;
}

}  // namespace rayshade::bench

int main(int count, char** values) {
  rayshade::bench::Arguments arguments;
  for (int i = 1; i < count; ++i) {
    const auto number = [&](int& out) { out = i + 1 < count ? std::atoi(values[++i]) : out; };
    if (std::strcmp(values[i], "--samples") == 0)
      number(arguments.samples);
    else if (std::strcmp(values[i], "--repeat") == 0)
      number(arguments.repeat);
    else if (std::strcmp(values[i], "--size") == 0)
      number(arguments.size);
    else
      arguments.scenes.emplace_back(values[i]);
  }
  return rayshade::bench::run(arguments);
}
