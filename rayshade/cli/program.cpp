// SPDX-License-Identifier: MIT
#include "rayshade/cli/program.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>

#include "rayshade/cli/cost_recorder.h"
#include "rayshade/cli/kept_work.h"
#include "rayshade/cli/options.h"
#include "rayshade/cli/pictures.h"
#include "rayshade/cli/progress.h"
#include "rayshade/cli/report.h"
#include "rayshade/cli/signals.h"
#include "rayshade/cli/tree_svg.h"
#include "rayshade/lang/parse.h"
#include "rayshade/render/picture_identity.h"
#include "rayshade/render/renderer.h"
#include "rayshade/scene/hashing_provider.h"
#include "rayshade/scene/provider.h"

namespace rayshade {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void complain(const Engine& engine, const std::string& text) {
  fmt::print(stderr, "{}: {}\n", engine.program(), text);
}

struct CloseFile {
  void operator()(std::FILE* file) const {
    if (file && file != stderr) std::fclose(file);
  }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

void note_resources(RunSummary& run, Clock::time_point start) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  run.total_cpu_seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  run.wall_seconds = seconds_since(start);
  run.peak_memory = peak_memory();
}

void write_text(const std::string& name, const std::string& text) {
  OutputFile file(name);
  file.write(text);
  file.commit();
}

std::string size_text(std::uint64_t bytes) {
  const auto size = static_cast<double>(bytes);
  return size < 1e6   ? fmt::format("{:.1f} kB", size / 1e3)
         : size < 1e9 ? fmt::format("{:.1f} MB", size / 1e6)
                      : fmt::format("{:.1f} GB", size / 1e9);
}

/// One run of the program, step by step; each step may end it.
class Run {
 public:
  Run(Options options, Engine& engine) : options_(std::move(options)), engine_(engine) {}

  int go() {
    if (options_.settings.tolerance && options_.settings.sampling != SamplingKind::kSobol)
      throw UsageError("--tolerance needs --sampling sobol");
    open_report();
    if (!read_scene()) return kFailed;
    if (options_.action == Action::kDumpScene) {
      write_text(options_.output.value_or("-"), canonical_text(scene_));
      return kComplete;
    }
    settings_ = resolve_settings(scene_.settings, options_.settings);
    take_report_settings();
    if (options_.cluster.estimate > 0) return estimate();
    if (options_.action == Action::kRender) return render();
    Renderer renderer(scene_, settings_, engine_.provider(), render_options());
    if (options_.action == Action::kExplain) return explain(renderer);
    if (!options_.quiet) {
      fmt::print(stderr, "{}: {} primitive{}, {} error{}, {} warning{}\n", shown_name(),
                 renderer.compiled().counts.primitives, renderer.compiled().counts.primitives == 1 ? "" : "s",
                 0, "s", warnings_, warnings_ == 1 ? "" : "s");
    }
    return kComplete;
  }

  std::string describe(const Location& where) const {
    return where.line > 0 ? scene_.describe(where) + ": " : "";
  }

 private:
  std::string scene_name() const { return options_.scene(); }
  std::string shown_name() const { return scene_name() == "-" ? "stdin" : scene_name(); }
  bool chatty() const { return report_.get() != stderr || !options_.quiet; }

  void open_report() {
    report_.reset(stderr);
    if (!options_.report_file) return;
    std::FILE* file = std::fopen(options_.report_file->c_str(), "w");
    if (!file)
      throw UsageError(
          fmt::format("cannot open report file '{}': {}", *options_.report_file, std::strerror(errno)));
    report_.reset(file);
  }

  /// What the scene says about reports counts from here on; options win.
  void take_report_settings() {
    const SceneSettings& s = scene_.settings;
    options_.quiet = options_.quiet || s.quiet;
    options_.verbose = options_.verbose || s.verbose;
    if (!options_.report_frequency) options_.report_frequency = s.report_frequency;
    if (!options_.report_file && s.report_file && options_.action == Action::kRender) {
      std::FILE* file = std::fopen(s.report_file->c_str(), "w");
      if (!file) {
        throw RenderError(
            fmt::format("cannot open report file '{}': {}", *s.report_file, std::strerror(errno)), {});
      }
      report_.reset(file);
    }
  }

  bool read_scene() {
    const Clock::time_point start = Clock::now();
    ParseResult result = parse_scene(engine_.provider(), scene_name(), parsing_options(options_));
    const bool color = isatty(STDERR_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr;
    const bool quiet = options_.quiet || result.scene.settings.quiet;
    for (const std::string& line : result.prints) fmt::print(stderr, "{}", line);
    if (report_.get() != stderr || !quiet)
      for (const std::string& line : result.notes) fmt::print(report_.get(), "{}", line);
    for (const Diagnostic& d : result.diagnostics) {
      if (d.severity == Severity::kAdvice && quiet) continue;
      warnings_ += d.severity == Severity::kWarning || d.severity == Severity::kAdvice;
      fmt::print(stderr, "{}", format_diagnostic(d, color));
    }
    scene_ = std::move(result.scene);
    run_.parse_seconds = seconds_since(start);
    return result.ok;
  }

  RenderOptions render_options() const {
    RenderOptions out = rendering_options(options_, engine_.machine_share());
    out.report_difference = [this](const std::string& text) {
      fmt::print(stderr, "{}: error: {}", engine_.program(), text);
    };
    engine_.adjust(options_, out);
    return out;
  }

  int explain(Renderer& renderer) {
    if (options_.explain_x >= settings_.width || options_.explain_y >= settings_.height) {
      throw UsageError(fmt::format("--explain: pixel {} {} is not on the screen of {} x {}",
                                   options_.explain_x, options_.explain_y, settings_.width,
                                   settings_.height));
    }
    // Not to the file of -O: there the picture is that is to be explained.
    write_text("-", renderer.explain(settings_.first_frame, options_.explain_x, options_.explain_y));
    return verified(renderer.statistics(), kComplete);
  }

  /// The picture's memory against what may be taken, before anything large is allocated.
  std::uint64_t check_memory(const FrameBufferOptions& picture) const {
    const std::uint64_t limit = options_.memory_limit.value_or(available_memory());
    const std::uint64_t per_pixel = pixel_size(picture.storage) + 4 * picture.layers.size();
    const std::uint64_t need = estimate_picture_bytes(settings_, per_pixel) + (std::uint64_t{32} << 20);
    if (options_.verbose && chatty()) {
      fmt::print(report_.get(), "Memory for the picture: {:.1f} MB of {:.1f} MB available\n",
                 static_cast<double>(need) / 1e6, static_cast<double>(limit) / 1e6);
    }
    if (need > limit) {
      throw RenderError(
          fmt::format("a picture of {} x {} pixels needs {} of memory, and {} are available: "
                      "render it in parts with -W, or raise --memory",
                      settings_.window_width(), settings_.window_height(), size_text(need), size_text(limit)),
          scene_.settings.screen_location);
    }
    return limit;
  }

  int render() {
    const std::string name = options_.output.value_or(scene_.settings.output.value_or("-"));
    PictureOutput output(options_, settings_, name);
    if (name == "-" && isatty(STDOUT_FILENO)) {
      throw UsageError("standard output is a terminal: name a file with -O, or redirect");
    }
    if (options_.resume && options_.no_journal)
      throw UsageError("-c continues from a journal: not with --no-journal");
    const FrameBufferOptions buffer = output.frame_buffer_options(
        check_memory(output.frame_buffer_options(options_.memory_limit.value_or(available_memory()))));
    HashingProvider files(engine_.provider());
    Renderer renderer(scene_, settings_, files, render_options());
    if (options_.fas_dump && !renderer.eye_tree()) throw UsageError("--fas-dump: " + why_no_eye_tree());
    run_.program = engine_.program();
    run_.scene = shown_name();
    run_.version = RAYSHADE_VERSION;
    run_.scene_hash = scene_hash(scene_);
    output.set_provenance({{"Software", "rayshade " RAYSHADE_VERSION},
                           {"Scene-Hash", run_.scene_hash},
                           {"Seed", fmt::format("{}", settings_.seed)},
                           {"Samples", fmt::format("{} x {}{}", settings_.samples, settings_.samples,
                                                   settings_.jitter ? " jittered" : "")}});
    if (options_.verbose && chatty()) {
      fmt::print(report_.get(), "rayshade {}\n{}", RAYSHADE_VERSION, settings_text(settings_, renderer));
      std::fflush(report_.get());
    }

    output.check_writable();
    FrameBuffer picture(buffer);
    const PictureFormat format = format_of(picture);
    const auto say = [this](const std::string& text) { complain(engine_, text); };
    KeptWork kept(options_, output, say, [&](const std::string& text) {
      if (!options_.quiet) say(text);
    });
    kept.open(
        name,
        [&] {
          return picture_identity(scene_, run_.scene_hash, settings_, format, options_.sample_map,
                                  files.hashes(), RAYSHADE_VERSION);
        },
        scene_.nodes.size(), picture);
    output.remove_leftovers();
    engine_.begin({options_, settings_, renderer, format, run_.scene_hash});
    Progress progress(report_.get(), {!chatty(), report_.get() == stderr && isatty(STDERR_FILENO) != 0,
                                      options_.report_frequency.value_or(0), settings_.min_y});
    SignalRequests requests;
    CostRecorder costs;
    bool complete = true;
    for (int i = 0; i < settings_.frames && complete; ++i) {
      const int frame = settings_.first_frame + i;
      if (kept.finished_before(frame)) continue;
      picture.clear();
      kept.load(frame, picture);
      progress.start(settings_.frames > 1 ? fmt::format("frame {} ({} of {})", frame, i + 1, settings_.frames)
                                          : "rendering");
      complete = engine_.render_frame(renderer, {frame, picture, requests.stop(),
                                                 [&](const FrameProgress& now) {
                                                   progress.update(now);
                                                   if (requests.take_progress()) progress.print_now(now);
                                                   kept.tend(frame, picture);
                                                   if (requests.take_save()) {
                                                     kept.save();
                                                     output.write_partial(picture, frame);
                                                   }
                                                 },
                                                 kept.keeper(frame, picture), costs.of_frame()});
      progress.finish();
      if (complete) {
        output.write_frame(picture, frame);
        kept.finish_frame(frame);
        if (options_.fas_dump)
          write_text(output.file_name(*options_.fas_dump, frame), tree_drawing(renderer, picture, frame));
      } else {
        kept.save();
        const std::string partial = output.write_stopped(picture, frame);
        complain(engine_, fmt::format("stopped at {}; {}{}", progress_text(picture, i),
                                      partial.empty() ? "no partial picture is kept on standard output"
                                                      : "the partial picture is " + partial,
                                      kept.advice()));
      }
    }
    if (complete) {
      output.finish();
      kept.finish();
    }
    run_.blocks_resumed = kept.blocks_resumed();
    run_.pixels_resumed = kept.pixels_resumed();
    run_.frames_resumed = kept.frames_resumed();
    RenderStatistics statistics = renderer.statistics();
    engine_.end(statistics);
    if (options_.block_costs && complete)
      write_text(*options_.block_costs,
                 format_block_costs(
                     costs.costs(settings_, format, statistics, run_.parse_seconds, engine_.scene_bytes())));
    const bool differs = statistics.verify.differing > 0;
    report(statistics, differs ? "differs" : complete ? "complete" : "stopped");
    return verified(statistics, complete ? kComplete : kStopped);
  }

  /// How far the i-th frame is, rounded down: "43 %" or "43 % of frame 7 (3 of 10)".
  std::string progress_text(const FrameBuffer& picture, int i) const {
    std::string out = fmt::format("{} %", 100 * picture.present() / (picture.width() * picture.height()));
    if (settings_.frames > 1)
      out += fmt::format(" of frame {} ({} of {})", settings_.first_frame + i, i + 1, settings_.frames);
    return out;
  }

  int estimate() {
    Renderer renderer(scene_, settings_, engine_.provider(), render_options());
    PictureFormat format;
    return engine_.estimate({options_, settings_, renderer, format, run_.scene_hash});
  }

  std::string why_no_eye_tree() const {
    if (options_.intersector != IntersectorKind::kFas)
      return "there is no tree of eye rays to draw: --intersector fas makes one";
    if (settings_.aperture > 0)
      return "there is no tree of eye rays to draw: they do not start at one point, because the camera has "
             "an aperture";
    return "there is no tree of eye rays to draw: the scene has so few objects that all are tested";
  }

  std::string tree_drawing(const Renderer& renderer, const FrameBuffer& picture, int frame) const {
    TreeDrawing drawing;
    drawing.width = settings_.window_width();
    drawing.height = settings_.window_height();
    drawing.title = fmt::format("Tree of eye rays of {}, frame {}", shown_name(), frame);
    for (const ClassReport& c : renderer.statistics().intersector.classes) {
      if (c.rays != ClassReport::Rays::kEye || c.queries() == 0) continue;
      drawing.note =
          fmt::format("Of {} eye rays so far, {:.1f} % were answered in the tree.", c.queries(),
                      100 * static_cast<double>(c.in_tree.rays) / static_cast<double>(c.queries()));
    }
    return tree_svg(tree_cells(*renderer.eye_tree(), renderer.camera(), settings_), drawing,
                    embeddable_png(picture));
  }

  /// The exit code, after a last word about what --verify found.
  ExitCode verified(const RenderStatistics& statistics, ExitCode code) const {
    const VerifyCounts& found = statistics.verify;
    if (found.differing == 0) return code;
    complain(engine_, fmt::format("error: of {} rays verified, {} have another answer than brute force gives",
                                  found.rays(), found.differing));
    return kDiffers;
  }

  void report(const RenderStatistics& statistics, const char* outcome) {
    run_.outcome = outcome;
    note_resources(run_, start_);
    if (chatty()) {
      fmt::print(report_.get(), "{}{}", statistics_text(statistics, run_, options_.verbose),
                 engine_.report_text(options_.verbose));
      std::fflush(report_.get());
    }
    if (options_.stats_file) {
      write_text(*options_.stats_file, statistics_json(statistics, settings_, run_, [this](JsonWriter& json) {
        engine_.report_json(json);
      }));
    }
  }

  Options options_;
  Engine& engine_;
  Scene scene_;
  RenderSettings settings_;
  RunSummary run_;
  File report_{stderr};
  int warnings_ = 0;
  Clock::time_point start_ = Clock::now();
};

int guarded(Run& run) {
  try {
    return run.go();
  } catch (const SettingsError& error) {
    fmt::print(stderr, "{}error: {}\n", run.describe(error.location), error.what());
  } catch (const RenderError& error) {
    fmt::print(stderr, "{}error: {}\n", run.describe(error.location), error.what());
  }
  return kFailed;
}

}  // namespace

int run_program(const std::vector<std::string>& arguments, Engine& engine) {
  try {
    const Options options = parse_options(arguments, engine.kind());
    switch (options.action) {
      case Action::kHelp:
        fmt::print("{}", help_text(engine.kind()));
        return kComplete;
      case Action::kVersion:
        fmt::print("{} {}\n", engine.program(), RAYSHADE_VERSION);
        return kComplete;
      case Action::kManOptions:
        fmt::print("{}", man_options(engine.kind()));
        return kComplete;
      case Action::kCompletion:
        fmt::print("{}", bash_completion(engine.kind()));
        return kComplete;
      default:
        break;
    }
    Run run(options, engine);
    return guarded(run);
  } catch (const UsageError& error) {
    complain(engine, error.what());
    fmt::print(stderr, "Try '{} --help'.\n", engine.program());
    return kUsage;
  } catch (const FormatError& error) {
    complain(engine, error.what());
    return kUsage;
  } catch (const std::bad_alloc&) {
    complain(engine, "out of memory");
  } catch (const std::exception& error) {
    complain(engine, error.what());
  }
  return kFailed;
}

}  // namespace rayshade
