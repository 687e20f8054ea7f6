// SPDX-License-Identifier: MIT
#include "pafas/master.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <thread>

#include "pafas/estimate.h"
#include "rayshade/cli/program.h"
#include "rayshade/image/block_record.h"
#include "rayshade/image/output_file.h"

namespace pafas {

using namespace rayshade;

namespace {

bool process_is_gone(std::int64_t process) {
  return kill(static_cast<pid_t>(process), 0) != 0 && errno == ESRCH;
}

}  // namespace

Master::Master(Transport& transport, MasterOptions options)
    : transport_(transport),
      options_(std::move(options)),
      ranks_(static_cast<std::size_t>(transport.size())),
      report_(transport.size()) {
  ranks_[0].phase = Phase::kWorking;
}

Master::~Master() { dismiss(); }

void Master::begin(const EnginePlan& plan) {
  renderer_ = &plan.renderer;
  run_options_ = &plan.options;
  threads_ = rendering_options(plan.options, options_.ranks_here).threads;
  dedicated_ = plan.options.cluster.master_only_serves(transport_.size());
  report_.width = plan.settings.window_width();
  report_.height = plan.settings.window_height();
  if (plan.options.cluster.costs) {
    costs_ = read_block_costs(*plan.options.cluster.costs);
    if (costs_->width != report_.width || costs_->height != report_.height)
      throw RenderError(
          fmt::format("'{}' has the costs of a picture of {} x {} pixels, and this one has {} x {}",
                      *plan.options.cluster.costs, costs_->width, costs_->height, report_.width,
                      report_.height),
          {});
  }
  // One rank alone sends nothing; block costs tell what others would be sent.
  if (!alone() || plan.options.block_costs) package_ = files_.package();
  files_.forget();
  if (alone()) return;
  report_.package_bytes = package_.size();
  plan_ = {{}, options_.arguments, plan.scene_hash, plan.format, package_.size()};
  planned_ = true;
  for (const auto& [rank, hello] : std::exchange(early_, {})) greet(rank, hello);
}

int Master::estimate(const EnginePlan& plan) { return run_estimate(plan, files_.package().size()); }

// ---- messages

void Master::serve() {
  while (std::optional<Message> message = transport_.receive()) {
    const int from = message->from;
    if (from <= 0 || from >= transport_.size()) continue;
    Rank& rank = ranks_[static_cast<std::size_t>(from)];
    RankRow& row = report_.rows[static_cast<std::size_t>(from)];
    rank.heard = seconds_now();
    ++row.messages;
    row.bytes += message->bytes.size();
    if (rank.phase == Phase::kLost) {
      rank.phase = rank.ready ? Phase::kWorking : Phase::kLoading;
      row.outcome = "back";
      fmt::print(stderr, "pafas: rank {} on {} is back\n", from, row.host);
    }
    try {
      handle(*message);
    } catch (const ArchiveError& error) {
      lose(from, Phase::kFailed, fmt::format("sent rubbish: {}", error.what()));
    }
  }
}

void Master::handle(const Message& message) {
  const int from = message.from;
  Rank& rank = ranks_[static_cast<std::size_t>(from)];
  RankRow& row = report_.rows[static_cast<std::size_t>(from)];
  const auto note_clock = [&](double sent) {
    // The quickest message tells best how the clocks differ.
    const double offset = seconds_now() - sent;
    row.clock_offset = row.has_clock ? std::min(row.clock_offset, offset) : offset;
    row.has_clock = true;
  };
  switch (kind_of(message.bytes)) {
    case Kind::kHello: {
      const auto hello = unpack<Hello>(message.bytes);
      row.host = hello.host;
      row.process = hello.process;
      if (planned_)
        greet(from, hello);
      else
        early_.emplace_back(from, hello);
      return;
    }
    case Kind::kPull:
      pieces_.ask(from, unpack<Pull>(message.bytes));
      pieces_.serve(transport_, package_, pieces_of(package_.size()));
      return;
    case Kind::kReady: {
      const auto ready = unpack<Ready>(message.bytes);
      rank.phase = Phase::kWorking;
      rank.ready = rank.wants_work = true;
      row.outcome = "working";
      row.report.threads = ready.threads;
      row.report.compile_seconds = ready.seconds;
      return;
    }
    case Kind::kResults: {
      const auto results = unpack<Results>(message.bytes);
      note_clock(results.sent);
      rank.phase = Phase::kWorking;
      take_results(from, results);
      return;
    }
    case Kind::kAlive:
      note_clock(unpack<Alive>(message.bytes).sent);
      tell(from, Heard{});
      return;
    case Kind::kReport:
      row.report = unpack<Report>(message.bytes).report;
      row.reported = rank.reported = true;
      row.outcome = "reported";
      rank.phase = Phase::kGone;
      return;
    case Kind::kFailed:
      lose(from, Phase::kFailed, unpack<Failed>(message.bytes).text);
      return;
    default:
      throw ArchiveError("a message that only slaves get");
  }
}

std::string Master::refusal_of(const Hello& hello) const {
  if (hello.protocol != kProtocol || hello.version != options_.version)
    return fmt::format("this is pafas {} (protocol {}), and rank 0 is pafas {} (protocol {})", hello.version,
                       hello.protocol, options_.version, kProtocol);
  return {};
}

void Master::greet(int rank, const Hello& hello) {
  Rank& at = ranks_[static_cast<std::size_t>(rank)];
  Plan plan = plan_;
  plan.refusal = refusal_of(hello);
  if (over_) {
    tell(rank, Leave{report_.lost_ranks > 0});
    return;
  }
  if (plan.refusal.empty()) plan.source = source_for(rank);
  if (!plan.refusal.empty())
    lose(rank, Phase::kFailed, plan.refusal);
  else if (at.phase == Phase::kExpected)
    at.phase = Phase::kLoading;
  // Another container may have the same name and other numbers for its processes: then it is not there now.
  at.watched = hello.host == RunReport::host_name() && !process_is_gone(hello.process);
  tell(rank, plan);
}

/// Where a slave that can take part gets the package: from the one above it in the tree, the first time.
int Master::source_for(int rank) {
  if (std::find(greeted_.begin(), greeted_.end(), rank) != greeted_.end()) return 0;
  const int above = place_above(static_cast<int>(greeted_.size()));
  greeted_.push_back(rank);
  if (above < 0) return 0;
  const int source = greeted_[static_cast<std::size_t>(above)];
  const Phase phase = ranks_[static_cast<std::size_t>(source)].phase;
  return phase == Phase::kLoading || phase == Phase::kWorking ? source : 0;
}

void Master::lose(int number, Phase phase, const std::string& why) {
  Rank& rank = ranks_[static_cast<std::size_t>(number)];
  if (rank.phase == Phase::kGone) return;
  RankRow& row = report_.rows[static_cast<std::size_t>(number)];
  rank.phase = phase;
  row.outcome = why;
  ++report_.lost_ranks;
  if (book_) book_->lost(worker_of(number));
  fmt::print(stderr, "pafas: rank {}{}: {}; its work goes to others\n", number,
             row.host.empty() ? "" : " on " + row.host, why);
}

void Master::watch() {
  const double now = seconds_now();
  if (now - watched_ < .1) return;
  watched_ = now;
  for (std::size_t i = 1; i < ranks_.size(); ++i) {
    const Rank& rank = ranks_[i];
    if (rank.phase != Phase::kLoading && rank.phase != Phase::kWorking) continue;
    if (rank.watched && process_is_gone(report_.rows[i].process))
      lose(static_cast<int>(i), Phase::kLost, "its process has died");
    else if (now - rank.heard > options_.timing.silence)
      lose(static_cast<int>(i), Phase::kLost, fmt::format("not heard of for {:.0f} s", now - rank.heard));
  }
}

// ---- a frame

bool Master::render_frame(Renderer& renderer, const FrameJob& job) {
  if (alone()) {
    const bool complete = renderer.render_frame(job);
    report_.rows[0].blocks = renderer.statistics().sampling.blocks;
    return complete;
  }
  const double start = seconds_now();
  FrameBuffer& picture = job.picture;
  job_ = &job;
  const ClusterOptions& cluster = run_options_->cluster;
  WorkBookOptions options;
  options.schedule = cluster.schedule;
  options.starts = cluster.start;
  options.granularity = cluster.granularity;
  options.workers = cluster.renderers(transport_.size());
  options.block_side = run_options_->block;
  book_ = std::make_unique<WorkBook>(static_cast<int>(picture.width()), static_cast<int>(picture.height()),
                                     options);
  report_.schedule = book_->schedule_name();
  for (std::size_t i = 1; i < ranks_.size(); ++i)
    if (ranks_[i].phase == Phase::kLost || ranks_[i].phase == Phase::kFailed)
      book_->lost(worker_of(static_cast<int>(i)));
  for (std::int64_t i = 0; i < book_->count(); ++i) {
    const Block block = book_->block(i);
    if (picture.is_present(block.x, block.y, block.width, block.height)) book_->skip(i);
  }
  expect_costs();
  progress_ = {};
  progress_.blocks = book_->missing();
  progress_.pixels = picture.width() * picture.height();
  progress_.pixels_before = picture.present();
  report_.resumed_pixels += static_cast<std::uint64_t>(progress_.pixels_before);

  feed_ = std::make_unique<QueueFeed>();
  std::unique_ptr<FrameCrew> crew;
  if (!dedicated_ && progress_.blocks > 0)
    crew = renderer.start_frame(job.frame, format_of(picture), *feed_, threads_);
  double told = 0;
  while (!book_->complete() && !job.stop) {
    serve();
    take_own_results();
    watch();
    give_work();
    if (crew && crew->wait(0)) break;  // it ends by itself only if it cannot go on
    if (const double now = seconds_now(); now - told > .1) {
      told = now;
      if (job.progress) job.progress(progress());
    }
    feed_->wait_for_news(5e-4);
  }
  feed_->close();
  if (crew) {
    renderer.finish_frame(*crew);
    take_own_results();
    report_.rows[0].report.wait_seconds += feed_->waited();
  }
  if (job.stop)  // what others have done by now is not thrown away
    for (const double until = seconds_now() + options_.timing.last_results;
         seconds_now() < until && !book_->complete() && book_->leased() > 0;) {
      serve();
      feed_->wait_for_news(1e-3);
    }
  if (job.progress) job.progress(progress());
  book_.reset();
  job_ = nullptr;
  renderer.count_frame(picture, seconds_now() - start);
  return picture.complete();
}

void Master::expect_costs() {
  if (!costs_) return;
  const std::vector<double> seconds = redistribute(*costs_, book_->grid());
  for (std::size_t i = 0; i < seconds.size(); ++i) book_->expect(static_cast<std::int64_t>(i), seconds[i]);
}

FrameProgress Master::progress() {
  const FrameBuffer& picture = job_->picture;
  while (progress_.rows_done < picture.height() && picture.row_complete(progress_.rows_done))
    ++progress_.rows_done;
  progress_.pixels_done = picture.present();
  return progress_;
}

void Master::take_results(int rank, const Results& results) {
  const double offset = report_.rows[static_cast<std::size_t>(rank)].clock_offset;
  for (const Result& result : results.results) {
    BlockSpan span{rank, results.frame, {}, result.begin + offset, result.end + offset, false};
    // A frame that is done, of which others brought this block first.
    if (!book_ || results.frame != job_->frame) {
      note_repeated(span);
      continue;
    }
    if (result.number < 0 || result.number >= book_->count()) throw ArchiveError("a result of no block");
    span.block = book_->block(result.number);
    const PictureFormat& format = plan_.format;
    const std::optional<BlockRecord> record =
        decode_block_record(result.record, static_cast<std::uint64_t>(span.block.pixels()) *
                                               recorded_pixel_size(format.storage, format.layers.size()));
    if (!record || record->frame != results.frame || record->storage != format.storage)
      throw ArchiveError("a result that is no block of this picture");
    take_block(span, result.cpu_seconds, record->block);
  }
  if (results.wants_work) ranks_[static_cast<std::size_t>(rank)].wants_work = true;
}

void Master::take_own_results() {
  for (const QueueFeed::Finished& f : feed_->take_finished()) {
    ++report_.rows[0].report.blocks;
    take_block({0, job_->frame, f.block, f.begin, f.end, false}, f.cost.seconds, f.pixels);
  }
}

void Master::take_block(BlockSpan span, double cpu_seconds, const EncodedBlock& pixels) {
  const Block& block = span.block;
  if (pixels.x != block.x || pixels.y != block.y || pixels.width != block.width ||
      pixels.height != block.height)
    throw ArchiveError("a result of another block than it says");
  span.counted = book_->finished(block.number, worker_of(span.rank), cpu_seconds, seconds_now());
  if (!span.counted) return note_repeated(span);
  if (job_->keep) job_->keep(pixels);
  if (job_->cost) job_->cost(block, {cpu_seconds});
  job_->picture.put(pixels);
  ++progress_.blocks_done;
  RankRow& row = report_.rows[static_cast<std::size_t>(span.rank)];
  ++row.blocks;
  row.render_seconds += cpu_seconds;
  report_.spans.push_back(span);
}

void Master::note_repeated(const BlockSpan& span) {
  ++report_.repeated_blocks;
  report_.spans.push_back(span);
}

void Master::give_work() {
  if (!dedicated_ && feed_->state().queued == 0)
    feed_->add(book_->take(worker_of(0), threads_, seconds_now()));
  for (std::size_t i = 1; i < ranks_.size(); ++i) {
    Rank& rank = ranks_[i];
    if (rank.phase != Phase::kWorking || !rank.wants_work) continue;
    const int threads = static_cast<int>(report_.rows[i].report.threads);
    std::vector<Block> blocks = book_->take(worker_of(static_cast<int>(i)), threads, seconds_now());
    if (blocks.empty()) continue;
    rank.wants_work = false;
    tell(static_cast<int>(i), Work{job_->frame, std::move(blocks)});
  }
}

// ---- the end

void Master::dismiss() {
  if (over_) return;
  over_ = true;
  if (report_.lost_ranks > 0) transport_.note_losses();
  for (int i = 1; i < transport_.size(); ++i) {
    const Phase phase = ranks_[static_cast<std::size_t>(i)].phase;
    if (phase != Phase::kFailed && phase != Phase::kGone) tell(i, Leave{report_.lost_ranks > 0});
  }
}

void Master::end(RenderStatistics& statistics) {
  RankRow& own = report_.rows[0];
  own.host = report_.host_name();
  own.process = getpid();
  own.outcome = "reported";
  own.reported = true;
  own.report.statistics = statistics;
  own.report.threads = dedicated_ ? 0 : static_cast<std::uint32_t>(threads_);
  own.report.cpu_seconds = statistics.cpu_seconds;
  own.report.compile_seconds = statistics.compile_seconds;
  dismiss();
  const auto awaited = [&] {
    return std::any_of(ranks_.begin() + 1, ranks_.end(), [](const Rank& rank) {
      return rank.phase == Phase::kWorking || rank.phase == Phase::kLoading;
    });
  };
  for (const double until = seconds_now() + options_.timing.reports; awaited() && seconds_now() < until;) {
    serve();
    std::this_thread::sleep_for(std::chrono::microseconds(500));
  }
  for (std::size_t i = 1; i < ranks_.size(); ++i) {
    RankRow& row = report_.rows[i];
    if (row.reported)
      add_counts(row.report.statistics, statistics);
    else if (ranks_[i].phase == Phase::kExpected)
      row.outcome = "never heard of";
    else if (ranks_[i].phase == Phase::kWorking || ranks_[i].phase == Phase::kLoading)
      row.outcome = "left without a report";
  }
  own.report.peak_memory = peak_memory();
  const ClusterOptions& cluster = run_options_->cluster;
  if (cluster.tile_map && !report_.spans.empty())
    report_.write_tile_map(*cluster.tile_map, report_.spans.back().frame);
  if (cluster.timeline) {
    OutputFile file(*cluster.timeline);
    file.write(report_.timeline());
    file.commit();
  }
}

}  // namespace pafas
