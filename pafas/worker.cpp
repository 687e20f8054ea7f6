// SPDX-License-Identifier: MIT
#include "pafas/worker.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "pafas/package.h"
#include "pafas/run_report.h"
#include "rayshade/cli/program.h"
#include "rayshade/image/block_record.h"
#include "rayshade/lang/parse.h"
#include "rayshade/scene/scene.h"
#include "rayshade/schedule/granularity.h"

namespace pafas {

using namespace rayshade;

struct Worker::Scene {
  MemoryProvider provider;
  Options options;
  rayshade::Scene scene;
  RenderSettings settings;
  std::unique_ptr<Renderer> renderer;
  std::string hash;
};

namespace {

void sleep_seconds(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

}  // namespace

Worker::Worker(Transport& transport, WorkerOptions options)
    : transport_(transport), options_(std::move(options)) {
  report_.host = RunReport::host_name();
  report_.process = getpid();
}

Worker::~Worker() {
  if (crew_) crew_.reset();  // before the feed and the scene
}

template <class M>
void Worker::tell(const M& message) {
  transport_.send(0, pack(message));
  said_ = seconds_now();
}

int Worker::run() {
  heard_ = seconds_now();
  ask_again();
  while (!leaving_) {
    try {
      while (std::optional<Message> message = transport_.receive()) {
        if (message->from == 0) heard_ = seconds_now();
        idle_polls_ = 0;
        handle(*message);
      }
      if (leaving_) break;
      if (preparing() && prepared_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
        finish_preparing();
      if (next_work_ && (!crew_ || crew_->wait(0))) {
        end_frame();
        begin_frame(next_work_->frame);
        feed_->add(std::exchange(next_work_, {})->blocks);
      }
      collect_results();
    } catch (const std::exception& error) {
      failure_ = error.what();
    }
    if (!failure_.empty()) {
      tell(Failed{failure_});
      break;
    }
    if (seconds_now() - heard_ > options_.timing.patience) {
      failure_ = "the master has not been heard of for a long time";
      break;
    }
    keep_alive();
    wait();
  }
  if (failure_.empty()) report();
  // What was sent is on its way; a dead master is not waited for.
  for (const double start = seconds_now();
       !transport_.sent(0) && seconds_now() - start < options_.timing.last_blocks;)
    sleep_seconds(.001);
  if (crew_) crew_.reset();
  if (failure_.empty()) return kComplete;
  fmt::print(stderr, "pafas: rank {} on {}: {}\n", transport_.rank(), report_.host, failure_);
  return kFailed;
}

void Worker::wait() {
  // Messages come without a knock, so one that is expected is looked for often, but ever less so.
  const bool expecting = asking_ || !plan_ || piece_ < pieces_;
  if (!expecting) {
    if (feed_)
      feed_->wait_for_news(.02);
    else
      sleep_seconds(.01);
    return;
  }
  const unsigned turn = 1 + idle_polls_++ / 16;
  const double pause = std::min(2e-4 * turn, .005);
  if (feed_)
    feed_->wait_for_news(pause);
  else
    sleep_seconds(pause);
}

void Worker::keep_alive() {
  const double now = seconds_now();
  if (now - said_ > options_.timing.alive) tell(Alive{now});
  if (plan_ && piece_ < pieces_ && source_ != 0 && now - piece_at_ > options_.timing.relay) {
    source_ = 0;
    pull();
  }
  // Who asks later gets it from the master.
  if (scene_ && package_ && now - std::max(served_at_, prepare_start_) > options_.timing.keep_package)
    package_.reset();
  if (now - asked_ > options_.timing.ask_again) ask_again();
}

void Worker::ask_again() {
  asked_ = seconds_now();
  if (!plan_)
    tell(Hello{kProtocol, options_.version, report_.host, report_.process});
  else if (piece_ < pieces_)
    pull();
  else if (asking_ && frame_ < 0)
    tell(Ready{scene_->hash, report_.threads, report_.compile_seconds});
  else if (asking_)
    send_results(true);
}

void Worker::handle(const Message& message) {
  switch (kind_of(message.bytes)) {
    case Kind::kPlan:
      take_plan(unpack<Plan>(message.bytes));
      return;
    case Kind::kPiece:
      take_piece(unpack<Piece>(message.bytes));
      return;
    case Kind::kPull:
      served_.ask(message.from, unpack<Pull>(message.bytes));
      served_at_ = seconds_now();
      serve_pieces();
      return;
    case Kind::kWork:
      take_work(unpack<Work>(message.bytes));
      return;
    case Kind::kLeave:
      leaving_ = true;
      if (unpack<Leave>(message.bytes).losses) transport_.note_losses();
      return;
    case Kind::kHeard:
      return;
    default:
      throw ArchiveError("a message that only masters get");
  }
}

void Worker::take_plan(Plan plan) {
  if (plan_) return;
  if (!plan.refusal.empty()) {
    failure_ = plan.refusal;
    return;
  }
  plan_ = std::move(plan);
  pieces_ = pieces_of(plan_->package_bytes);
  package_->reserve(static_cast<std::size_t>(plan_->package_bytes));
  if (plan_->source > 0 && plan_->source < transport_.size() && plan_->source != transport_.rank())
    source_ = plan_->source;
  pull();
}

void Worker::pull() {
  asked_pieces_ = std::min(piece_ + kWindow, pieces_);
  asked_ = piece_at_ = seconds_now();
  const Pull pull{piece_, asked_pieces_ - piece_};
  if (source_ == 0)
    tell(pull);
  else
    transport_.send(source_, pack(pull));
}

void Worker::serve_pieces() {
  if (package_) served_.serve(transport_, *package_, piece_);
}

void Worker::take_piece(const Piece& piece) {
  // One that was overtaken is asked for again by and by.
  if (piece.number != piece_ || piece_ >= pieces_) return;
  if (piece.bytes.size() !=
      std::min<std::uint64_t>(Piece::kBytes, plan_->package_bytes - piece_ * Piece::kBytes))
    throw ArchiveError("a piece of a wrong length");
  *package_ += piece.bytes;
  ++piece_;
  piece_at_ = seconds_now();
  if (piece_ < pieces_ && piece_ == asked_pieces_) pull();
  if (served_.waits()) serve_pieces();
  if (piece_ == pieces_) prepare();
}

void Worker::prepare() {
  prepare_start_ = seconds_now();
  prepared_ = std::async(std::launch::async, [this, package = package_] {
    auto scene = std::make_unique<Scene>();
    unpack_files(*package, scene->provider);
    scene->options = parse_options(plan_->arguments, Program::kPafas);
    ParseResult parsed =
        parse_scene(scene->provider, scene->options.scene(), parsing_options(scene->options));
    if (!parsed.ok) throw std::runtime_error("the scene has errors here that it has not on rank 0");
    scene->scene = std::move(parsed.scene);
    scene->hash = scene_hash(scene->scene);
    if (scene->hash != plan_->scene_hash)
      throw std::runtime_error("the scene is not the same here as on rank 0");
    scene->settings = resolve_settings(scene->scene.settings, scene->options.settings);
    RenderOptions options = rendering_options(scene->options, options_.ranks_here);
    options.renderers = scene->options.cluster.renderers(transport_.size());
    options.report_difference = [rank = transport_.rank()](const std::string& text) {
      fmt::print(stderr, "pafas: rank {}: error: {}", rank, text);
    };
    scene->renderer = std::make_unique<Renderer>(scene->scene, scene->settings, scene->provider, options);
    report_.threads = static_cast<std::uint32_t>(options.threads);
    return scene;
  });
}

void Worker::finish_preparing() {
  scene_ = prepared_.get();
  report_.compile_seconds = seconds_now() - prepare_start_;
  tell(Ready{scene_->hash, report_.threads, report_.compile_seconds});
  asking_ = true;
  asked_ = seconds_now();
}

void Worker::take_work(Work work) {
  if (!scene_) return;
  asking_ = false;
  if (work.frame == frame_) {
    feed_->add(work.blocks);
    return;
  }
  if (feed_) feed_->close();
  next_work_ = std::move(work);
}

void Worker::begin_frame(int frame) {
  frame_ = frame;
  feed_ = std::make_unique<QueueFeed>();
  crew_ = scene_->renderer->start_frame(frame, plan_->format, *feed_, static_cast<int>(report_.threads));
}

void Worker::end_frame() {
  if (!crew_) return;
  feed_->close();
  scene_->renderer->finish_frame(*crew_);
  crew_.reset();
  report_.wait_seconds += feed_->waited();
  results_.clear();  // nobody waits for the rest of that frame
}

void Worker::collect_results() {
  if (!feed_ || next_work_) return;
  if (crew_->wait(0)) {  // it ends by itself only if it cannot go on
    end_frame();
    return;
  }
  for (QueueFeed::Finished& f : feed_->take_finished()) {
    if (results_.empty()) oldest_result_ = f.end;
    ++report_.blocks;
    results_.push_back({f.block.number, f.begin, f.end, f.cost.seconds,
                        encode_block_record(frame_, f.pixels, plan_->format.storage)});
  }
  const QueueFeed::State state = feed_->state();
  const bool idle = state.queued == 0 && state.rendered == 0;
  const bool wants = !asking_ && asks_for_more(state.queued + state.rendered, report_.threads);
  if (wants || (!results_.empty() && (idle || seconds_now() - oldest_result_ > options_.timing.hold)))
    send_results(wants);
}

void Worker::send_results(bool wants_work) {
  const double now = seconds_now();
  if (wants_work) {
    asking_ = true;
    asked_ = now;
    idle_polls_ = 0;
  }
  tell(Results{frame_, wants_work, now, std::exchange(results_, {})});
}

void Worker::report() {
  if (crew_) {
    feed_->close();
    const bool ended = crew_->wait(options_.timing.last_blocks);
    report_.wait_seconds += feed_->waited();
    if (ended) {
      try {
        scene_->renderer->finish_frame(*crew_);
      } catch (const std::exception& error) {
        fmt::print(stderr, "pafas: rank {}: {}\n", transport_.rank(), error.what());
      }
    }
    if (ended) report_.statistics = scene_->renderer->statistics();
  } else if (scene_) {
    report_.statistics = scene_->renderer->statistics();
  }
  report_.cpu_seconds = report_.statistics.cpu_seconds;
  report_.peak_memory = peak_memory();
  tell(Report{report_});
}

}  // namespace pafas
