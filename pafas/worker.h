// SPDX-License-Identifier: MIT
// A slave: everything that a rank other than 0 does.
//
// The scene comes as a package of files, so that no disk is shared, from the master or from a slave that
// passes it on (relay.h), as this one does for others. It is read and compiled
// in a thread of its own and rendered by others, while the main thread talks: a slave that works is never
// silent. It asks for more blocks when the last of those it has is begun, and holds results back until then,
// but no longer than some seconds.
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pafas/message.h"
#include "pafas/queue_feed.h"
#include "pafas/relay.h"
#include "pafas/timing.h"
#include "pafas/transport.h"
#include "rayshade/cli/options.h"
#include "rayshade/render/renderer.h"

namespace pafas {

struct WorkerOptions {
  std::string version;  ///< of the program; the master's must be the same
  int ranks_here = 1;   ///< of this job on this machine
  Timing timing = {};
};

class Worker {
 public:
  Worker(Transport& transport, WorkerOptions options);
  ~Worker();

  /// Works until the master says that it is over, or has not been heard of for long. Returns the exit code of
  /// the process.
  int run();

 private:
  static constexpr std::uint64_t kWindow = 64;  ///< pieces asked for at a time

  /// The scene as this rank holds it.
  struct Scene;

  template <class M>
  void tell(const M& message);
  void handle(const Message& message);
  void take_plan(Plan plan);
  void take_piece(const Piece& piece);
  void pull();
  void prepare();
  void serve_pieces();
  void ask_again();
  void take_work(Work work);
  void begin_frame(int frame);
  void end_frame();
  bool preparing() const { return prepared_.valid(); }
  void finish_preparing();
  void collect_results();
  void send_results(bool wants_work);
  void keep_alive();
  void wait();
  void report();

  Transport& transport_;
  WorkerOptions options_;
  double heard_ = 0, said_ = 0, asked_ = 0;
  bool leaving_ = false, asking_ = false;
  std::string failure_;
  unsigned idle_polls_ = 0;

  std::optional<Plan> plan_;
  /// The package as far as it is here; null once nobody needs it any more.
  std::shared_ptr<std::string> package_ = std::make_shared<std::string>();
  std::uint64_t piece_ = 0, pieces_ = 0, asked_pieces_ = 0;
  int source_ = 0;       ///< the rank it is pulled from
  double piece_at_ = 0;  ///< when it was last asked for, or sent, a piece
  PieceServer served_;
  double served_at_ = 0;  ///< when another slave last asked
  std::future<std::unique_ptr<Scene>> prepared_;
  std::unique_ptr<Scene> scene_;
  double prepare_start_ = 0;

  std::optional<Work> next_work_;  ///< of a frame that waits until the one before has ended
  std::int32_t frame_ = -1;
  std::unique_ptr<QueueFeed> feed_;
  std::unique_ptr<rayshade::FrameCrew> crew_;
  std::vector<Result> results_;
  double oldest_result_ = 0;
  RankReport report_;
};

}  // namespace pafas
