// SPDX-License-Identifier: MIT
// Who renders the frames of a run: the threads of this process, or the ranks of a cluster. The program around
// it (options, scene, picture files, reports) is the same.
#pragma once

#include <string>

#include "rayshade/cli/options.h"
#include "rayshade/render/renderer.h"
#include "rayshade/scene/provider.h"

namespace rayshade {

class JsonWriter;

/// What is known once the scene is compiled. All of it outlives the engine's use.
struct EnginePlan {
  const Options& options;
  const RenderSettings& settings;
  Renderer& renderer;
  const PictureFormat& format;
  const std::string& scene_hash;
};

class Engine {
 public:
  virtual ~Engine() = default;
  /// Which options the program has, and what it calls itself in messages.
  virtual Program kind() const = 0;
  const char* program() const { return program_name(kind()); }
  /// Every file that the scene names is read through it.
  virtual Provider& provider() = 0;
  /// Processes of this job on this machine: threads and memory are divided by it (rule 19).
  virtual int machine_share() const { return 1; }
  /// A last word on how this process renders.
  virtual void adjust(const Options&, RenderOptions&) const {}
  /// Before the first frame. Throws RenderError.
  virtual void begin(const EnginePlan&) {}
  /// As Renderer::render_frame. Throws RenderError.
  virtual bool render_frame(Renderer& renderer, const FrameJob& job) { return renderer.render_frame(job); }
  /// After the last frame: adds the counts of others to the statistics of this process.
  virtual void end(RenderStatistics&) {}
  /// Bytes of the scene and all its files, as far as they are known.
  virtual std::uint64_t scene_bytes() const { return 0; }
  /// In place of rendering (--estimate): predicts what it would take. Returns the exit code.
  virtual int estimate(const EnginePlan&) { throw UsageError("nothing to estimate for a single machine"); }
  /// What it has to say of itself, after the statistics: text for people, members of the JSON object.
  virtual std::string report_text(bool /*verbose*/) const { return {}; }
  virtual void report_json(JsonWriter&) const {}
};

/// The threads of this process.
class LocalEngine : public Engine {
 public:
  Program kind() const override { return Program::kRayshade; }
  Provider& provider() override { return provider_; }
  std::uint64_t scene_bytes() const override { return provider_.bytes_read(); }

 private:
  FileProvider provider_;
};

}  // namespace rayshade
