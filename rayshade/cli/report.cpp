// SPDX-License-Identifier: MIT
#include "rayshade/cli/report.h"

#include <fmt/format.h>

#include "rayshade/cli/class_report.h"
#include "rayshade/cli/json.h"

namespace rayshade {
namespace {

constexpr const char* kLeafNames[kLeafKinds] = {
    "Plane",           "Sphere",      "Box",     "Disc", "Cylinder",    "Cone",       "Torus",   "Triangle",
    "Smooth triangle", "Uv triangle", "Polygon", "Blob", "Heightfield", "CSG object", "Instance"};

double percent(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : 100 * static_cast<double>(part) / static_cast<double>(whole);
}

double per(double seconds, std::uint64_t count) {
  return count == 0 ? 0 : seconds / static_cast<double>(count);
}

/// Skipped work, as (name, count, explanation).
struct Skipped {
  const char* name;
  std::uint64_t count;
  const char* what;
};

std::vector<Skipped> skipped_work(const RenderStatistics& s) {
  return {{"back_lights", s.shading.skipped_back_lights, "shadow rays not shot: light behind the surface"},
          {"dark_lights", s.shading.skipped_dark_lights, "shadow rays not shot: light or answer black"},
          {"unshadowed", s.shading.skipped_unshadowed, "shadow rays not shot: no shadows wanted"},
          {"cutoff", s.shading.skipped_cutoff, "secondary rays below the cutoff"},
          {"depth", s.shading.skipped_depth, "hits at the maximum depth"},
          {"unused_objects", s.compile.unused_objects, "named objects never built"}};
}

std::vector<std::pair<const char*, bool>> unused_features(const RenderStatistics& s) {
  return {{"motion", s.without_motion},     {"lens", s.without_lens},
          {"csg", s.without_csg},           {"transparency", s.without_transparency},
          {"textures", s.without_textures}, {"atmosphere", s.without_atmosphere}};
}

}  // namespace

std::string settings_text(const RenderSettings& r, const Renderer& renderer) {
  std::string out;
  const CompiledScene& scene = renderer.compiled();
  out += "list \"World\":\n";
  const Bounds3& b = scene.groups[0].bounds;
  if (!b.empty() && scene.groups[0].unbounded == 0) {
    out += fmt::format("\tX: {:f} to {:f}\n\tY: {:f} to {:f}\n\tZ: {:f} to {:f}\n", b.lo.x, b.hi.x, b.lo.y,
                       b.hi.y, b.lo.z, b.hi.z);
  }
  out += fmt::format("\t{} primitive{}\n", scene.counts.primitives, scene.counts.primitives == 1 ? " " : "s");
  if (r.frames > 1) {
    out += fmt::format("Frames: {} - {}\n", r.first_frame, r.first_frame + r.frames - 1);
  } else {
    out += fmt::format("Frame: {}\n", r.first_frame);
  }
  out += fmt::format("Screen resolution: {} x {}\n", r.width, r.height);
  out += fmt::format("Image window: ({} - {}), ({} - {})\n", r.min_x, r.max_x, r.min_y, r.max_y);
  out += fmt::format("{}{} sample{} per pixel at most, {} filter of width {:g}\n",
                     r.sobol()  ? "Low-discrepancy sampling, "
                     : r.jitter ? "Jittered sampling, "
                                : "",
                     r.samples * r.samples, r.samples == 1 ? "" : "s",
                     r.filter == FilterKind::kBox ? "box" : "Gaussian", r.filter_width);
  if (r.sobol())
    out += fmt::format("Tolerated error: {:g}\n", r.tolerance);
  else
    out += fmt::format("Maximum contrast: {:g} red, {:g} green, {:g} blue\n", r.contrast.r, r.contrast.g,
                       r.contrast.b);
  out += fmt::format("Maximum ray depth: {}. Cutoff thresholds: {:g} {:g} {:g}\n", r.max_depth, r.cutoff.r,
                     r.cutoff.g, r.cutoff.b);
  if (r.stereo == Eye::kLeft) out += "Rendering the left eye's view\n";
  if (r.stereo == Eye::kRight) out += "Rendering the right eye's view\n";
  if (!r.shadows)
    out += "No shadows are rendered.\n";
  else if (r.transparent_shadows)
    out += "Object opacity affects depth of shadowing.\n";
  if (r.frames > 1) out += fmt::format("Rendering {} frames.\n", r.frames);
  return out;
}

std::string statistics_text(const RenderStatistics& s, const RunSummary& run, bool verbose) {
  const ShadingCounts& c = s.shading;
  std::string out;
  const auto row = [&](const char* label, const std::string& value) {
    out += fmt::format("{:<36}{}\n", label, value);
  };
  const auto count = [&](const char* label, std::uint64_t n) { row(label, fmt::format("{}", n)); };
  if (run.frames_resumed > 0 || run.blocks_resumed > 0) {
    // The counts that follow are of this run.
    row("Done by earlier runs:", fmt::format("{} frame{}, {} block{} ({} pixels)", run.frames_resumed,
                                             run.frames_resumed == 1 ? "" : "s", run.blocks_resumed,
                                             run.blocks_resumed == 1 ? "" : "s", run.pixels_resumed));
  }
  count("Eye rays:", c.eye_rays);
  count("Shadow rays:", c.shadow_rays);
  count("Reflected rays:", c.reflected_rays);
  count("Refracted rays:", c.transmitted_rays);
  count("Total rays:", c.total_rays());
  const std::uint64_t hits = c.shaded_hits + c.shadow_hits;
  row("Intersecting rays:", fmt::format("{} ({:.2f}%)", hits, percent(hits, c.total_rays())));
  if (c.shadow_rays > 0) {
    row("Total shadow hits:",
        fmt::format("{} ({:.2f}%)", c.shadow_hits, percent(c.shadow_hits, c.shadow_rays)));
  }
  count("Supersampled pixels:", s.sampling.supersampled);
  count("B.V. intersection tests:", s.trace.bounds_tests);
  std::uint64_t tests = 0, test_hits = 0;
  for (int k = 0; k < kLeafKinds; ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (s.trace.tests[i] == 0) continue;
    row(fmt::format("{} intersection tests:", kLeafNames[i]).c_str(),
        fmt::format("{} ({} hit, {:f}%)", s.trace.tests[i], s.trace.hits[i],
                    percent(s.trace.hits[i], s.trace.tests[i])));
    if (k < static_cast<int>(LeafKind::kCsg)) {
      tests += s.trace.tests[i];
      test_hits += s.trace.hits[i];
    }
  }
  row("Total prim. intersection tests:",
      tests == 0 ? "0" : fmt::format("{} ({} hit, {:f}%)", tests, test_hits, percent(test_hits, tests)));
  row("Pixels not a number, negative:", fmt::format("{}, {}", s.nan_pixels, s.negative_pixels));
  if (s.verify_share > 0)
    row("Rays verified, differing:", fmt::format("{}, {}", s.verify.rays(), s.verify.differing));
  if (verbose) {
    for (const Skipped& skipped : skipped_work(s)) {
      if (skipped.count > 0) row("Skipped:", fmt::format("{} {}", skipped.count, skipped.what));
    }
    std::string unused;
    for (const auto& [name, is_unused] : unused_features(s)) {
      if (is_unused) unused += fmt::format("{}{}", unused.empty() ? "" : ", ", name);
    }
    if (!unused.empty()) row("Not used by the scene, never run:", unused);
    out += classes_text(s);
    count("Samples in halos of blocks:", s.sampling.halo_samples);
    row("Leaves, shared groups:", fmt::format("{}, {}", s.compile.leaves, s.compile.shared_groups));
    row("Reading, compiling, rendering:",
        fmt::format("{:.2f} s, {:.2f} s, {:.2f} s", run.parse_seconds, s.compile_seconds, s.render_seconds));
    row("Threads:", fmt::format("{}", s.threads));
    if (!run.scene_hash.empty()) row("Scene:", run.scene_hash);
  }
  row("Total CPU time (sec):", fmt::format("{:.2f}", run.total_cpu_seconds));
  row("Seconds / ray:", fmt::format("{:.4g}", per(run.total_cpu_seconds, c.total_rays())));
  row("Seconds / intersecting ray:", fmt::format("{:.4g}", per(run.total_cpu_seconds, hits)));
  row("Largest memory:", fmt::format("{:.1f} MB", static_cast<double>(run.peak_memory) / 1e6));
  return out;
}

std::string statistics_json(const RenderStatistics& s, const RenderSettings& r, const RunSummary& run,
                            const std::function<void(JsonWriter&)>& more) {
  JsonWriter j;
  const ShadingCounts& c = s.shading;
  j.begin_object();
  j.value("program", run.program).value("version", run.version).value("scene", run.scene);
  j.value("scene_hash", run.scene_hash).value("outcome", run.outcome);
  j.begin_object("settings");
  j.value("width", r.width).value("height", r.height);
  j.begin_array("window")
      .value("", r.min_x)
      .value("", r.max_x)
      .value("", r.min_y)
      .value("", r.max_y)
      .end_array();
  j.value("samples", r.samples).value("sampling", r.sobol() ? "sobol" : "original");
  if (r.sobol()) j.value("tolerance", r.tolerance);
  j.value("jitter", r.jitter).value("max_depth", r.max_depth);
  j.value("seed", r.seed).value("first_frame", r.first_frame).value("frames", r.frames);
  j.end_object();
  j.begin_object("resumed");
  j.value("blocks", run.blocks_resumed).value("pixels", run.pixels_resumed);
  j.value("frames", run.frames_resumed).end_object();
  j.begin_object("rays");
  j.value("eye", c.eye_rays).value("shadow", c.shadow_rays).value("reflected", c.reflected_rays);
  j.value("transmitted", c.transmitted_rays)
      .value("total", c.total_rays())
      .value("shaded_hits", c.shaded_hits);
  j.value("shadow_hits", c.shadow_hits).value("transparent_walks", c.transparent_walks);
  j.value("total_reflections", c.total_reflections);
  j.value("nearest_queries", c.nearest_queries).value("occlusion_queries", c.occlusion_queries);
  j.end_object();
  j.begin_object("sampling");
  j.value("pixels", s.sampling.pixels).value("supersampled", s.sampling.supersampled);
  j.value("halo_samples", s.sampling.halo_samples).value("blocks", s.sampling.blocks);
  j.value("nan_pixels", s.nan_pixels).value("negative_pixels", s.negative_pixels);
  j.end_object();
  j.begin_object("intersection");
  j.value("bounds_tests", s.trace.bounds_tests);
  for (std::size_t k = 0; k < kLeafKinds; ++k) {
    if (s.trace.tests[k] == 0) continue;
    j.begin_object(kLeafNames[k])
        .value("tests", s.trace.tests[k])
        .value("hits", s.trace.hits[k])
        .end_object();
  }
  j.end_object();
  write_classes(s, j);
  if (s.verify_share > 0) {
    j.begin_object("verification");
    j.value("share", s.verify_share).value("nearest", s.verify.nearest);
    j.value("occlusion", s.verify.occlusion).value("differing", s.verify.differing);
    j.end_object();
  }
  j.begin_object("skipped");
  for (const Skipped& skipped : skipped_work(s)) j.value(skipped.name, skipped.count);
  j.end_object();
  j.begin_array("unused_features");
  for (const auto& [name, is_unused] : unused_features(s)) {
    if (is_unused) j.value("", name);
  }
  j.end_array();
  j.begin_object("scene_compiled");
  j.value("primitives", s.compile.primitives).value("leaves", s.compile.leaves);
  j.value("shared_groups", s.compile.shared_groups).value("unused_objects", s.compile.unused_objects);
  j.value("bytes", s.compile.bytes);
  j.end_object();
  j.begin_object("resources");
  j.value("threads", s.threads).value("frames", s.frames).value("peak_tree_nodes", s.peak_tree_nodes);
  j.value("parse_seconds", run.parse_seconds).value("compile_seconds", s.compile_seconds);
  j.value("render_seconds", s.render_seconds).value("render_cpu_seconds", s.cpu_seconds);
  j.value("cpu_seconds", run.total_cpu_seconds).value("wall_seconds", run.wall_seconds);
  j.value("peak_memory_bytes", run.peak_memory);
  j.end_object();
  if (more) more(j);
  j.end_object();
  return j.text();
}

}  // namespace rayshade
