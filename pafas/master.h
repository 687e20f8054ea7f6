// SPDX-License-Identifier: MIT
// Rank 0: the program around, and a master that hands out blocks, keeps what comes back, and renders too.
//
// It serves while it renders: slaves get the scene when they ask for it, so that one that comes late or dies
// on the way holds up nobody. A slave is lost when it has been silent for some seconds; its blocks go to
// others, and if it speaks again it is welcome. Everything here runs in the main thread.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pafas/message.h"
#include "pafas/package.h"
#include "pafas/queue_feed.h"
#include "pafas/relay.h"
#include "pafas/run_report.h"
#include "pafas/timing.h"
#include "pafas/transport.h"
#include "rayshade/cli/engine.h"
#include "rayshade/schedule/block_costs.h"
#include "rayshade/schedule/work_book.h"

namespace pafas {

struct MasterOptions {
  std::string version;
  std::vector<std::string> arguments;  ///< of the command line, for the slaves
  int ranks_here = 1;                  ///< of this job on this machine
  Timing timing = {};
};

class Master final : public rayshade::Engine {
 public:
  Master(Transport& transport, MasterOptions options);
  ~Master() override;

  rayshade::Program kind() const override { return rayshade::Program::kPafas; }
  rayshade::Provider& provider() override { return files_; }
  int machine_share() const override { return options_.ranks_here; }
  void adjust(const rayshade::Options& options, rayshade::RenderOptions& out) const override {
    out.renderers = options.cluster.renderers(transport_.size());
  }
  void begin(const rayshade::EnginePlan& plan) override;
  bool render_frame(rayshade::Renderer& renderer, const rayshade::FrameJob& job) override;
  void end(rayshade::RenderStatistics& statistics) override;
  std::uint64_t scene_bytes() const override { return package_.size(); }
  int estimate(const rayshade::EnginePlan& plan) override;
  std::string report_text(bool verbose) const override { return report_.text(verbose); }
  void report_json(rayshade::JsonWriter& json) const override { report_.write_json(json); }

  /// Sends away all slaves that are still there. The run is over, well or not.
  void dismiss();

 private:
  enum class Phase : std::uint8_t { kExpected, kLoading, kWorking, kLost, kFailed, kGone };
  struct Rank {
    Phase phase = Phase::kExpected;
    double heard = 0;
    bool ready = false;  ///< has compiled the scene
    bool wants_work = false;
    bool reported = false;
    bool watched = false;  ///< a process of this machine, whose death can be seen
  };

  bool alone() const { return transport_.size() == 1; }
  /// The number of a rank among those that render.
  int worker_of(int rank) const { return dedicated_ ? rank - 1 : rank; }
  template <class M>
  void tell(int rank, const M& message) {
    transport_.send(rank, pack(message));
  }
  void serve();
  void handle(const Message& message);
  void greet(int rank, const Hello& hello);
  int source_for(int rank);
  void take_results(int rank, const Results& results);
  void take_own_results();
  void take_result(int rank, const Result& result);
  void take_block(BlockSpan span, double cpu_seconds, const rayshade::EncodedBlock& pixels);
  void note_repeated(const BlockSpan& span);
  void give_work();
  void give_own_work();
  void watch();
  void lose(int rank, Phase phase, const std::string& why);
  void expect_costs();
  std::string refusal_of(const Hello& hello) const;
  rayshade::FrameProgress progress();

  Transport& transport_;
  MasterOptions options_;
  RecordingProvider files_;
  std::vector<Rank> ranks_;
  Plan plan_;
  bool planned_ = false, over_ = false, dedicated_ = false;
  std::vector<std::pair<int, Hello>> early_;  ///< slaves that came before there was a plan
  std::string package_;
  PieceServer pieces_;
  std::vector<int> greeted_;  ///< slaves, by their place in the tree that passes the package on
  RunReport report_;
  rayshade::Renderer* renderer_ = nullptr;
  const rayshade::Options* run_options_ = nullptr;
  int threads_ = 1;
  std::optional<rayshade::BlockCosts> costs_;  ///< expected
  double watched_ = 0;

  // Of the frame at hand:
  const rayshade::FrameJob* job_ = nullptr;
  std::unique_ptr<rayshade::WorkBook> book_;
  std::unique_ptr<QueueFeed> feed_;
  rayshade::FrameProgress progress_;
};

}  // namespace pafas
