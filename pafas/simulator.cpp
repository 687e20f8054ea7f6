// SPDX-License-Identifier: MIT
#include "pafas/simulator.h"

#include <fmt/format.h>

#include <algorithm>
#include <bitset>
#include <cmath>
#include <deque>
#include <queue>
#include <random>
#include <stdexcept>
#include <utility>

#include "pafas/relay.h"
#include "rayshade/cli/json.h"
#include "rayshade/schedule/granularity.h"

namespace pafas {

using namespace rayshade;

namespace {

constexpr int kRegions = 32;  ///< per side of the picture
constexpr double kMessageBytes = 64, kBlockBytes = 24, kResultBytes = 96;
/// Waiting workers that are refused before the others are not asked any more: what is due is due for all.
constexpr int kRefusals = 4;

enum class What : std::uint8_t { kReady, kMessage, kWork, kRendered, kPoll, kDeath, kLoss };

struct Result {
  std::int64_t number = 0;
  double seconds = 0;
};

struct Event {
  double time = 0;
  std::uint64_t serial = 0;
  What what = What::kPoll;
  int rank = 0;
  bool wants_work = false;
  std::vector<Result> results = {};
  std::vector<Block> blocks = {};
};
struct Later {
  bool operator()(const Event& a, const Event& b) const {
    return a.time != b.time ? a.time > b.time : a.serial > b.serial;
  }
};

struct Rank {
  double speed = 1;
  double ready = 0;  ///< when it has the scene
  double busy = 0, wasted = 0;
  bool renders = true, dead = false, lost = false, asking = false, waits = false;
  std::deque<Block> queue;
  std::int64_t rendered = -1;  ///< at this moment
  double seconds = 0;          ///< that it takes
  std::vector<Result> results;
  std::bitset<std::size_t{kRegions} * kRegions> regions;  ///< in which it has built trees

  std::size_t unfinished() const { return queue.size() + (rendered >= 0 ? 1 : 0); }
};

void check(const SimulatorOptions& o) {
  const auto need = [](bool good, const char* what) {
    if (!good) throw std::invalid_argument(what);
  };
  need(o.ranks >= 1, "there must be a rank");
  need(std::all_of(o.speeds.begin(), o.speeds.end(), [](double s) { return s > 0 && std::isfinite(s); }),
       "speeds must be positive");
  need(o.speed_spread >= 0 && o.speed_spread < 1, "the spread of speeds must be from 0 to below 1");
  need(o.bytes_per_second > 0, "the bandwidth must be positive");
  need(o.killed >= 0 && o.killed <= 1, "the part that is killed must be from 0 to 1");
  for (const double seconds : {o.latency_seconds, o.start_seconds, o.compile_seconds.value_or(0),
                               o.service_seconds, o.service_per_byte, o.silence_seconds})
    need(seconds >= 0 && std::isfinite(seconds), "times must not be negative");
}

WorkBookOptions book_options(const SimulatorOptions& o) {
  WorkBookOptions out;
  out.schedule = o.schedule;
  out.starts = o.starts;
  out.granularity = o.granularity;
  out.workers = o.dedicated_master && o.ranks > 1 ? o.ranks - 1 : o.ranks;
  out.block_side = o.block_side;
  out.most_copies = o.most_copies;
  return out;
}

class Simulation {
 public:
  Simulation(const BlockCosts& costs, const SimulatorOptions& options);
  SimulatorReport run();

 private:
  void at(double time, What what, int rank) { push({time, 0, what, rank}); }
  void push(Event event) {
    event.serial = ++serial_;
    events_.push(std::move(event));
  }
  Rank& rank(int number) { return ranks_[static_cast<std::size_t>(number)]; }
  /// As the master counts those that render.
  int worker_of(int number) const {
    return options_.dedicated_master && options_.ranks > 1 ? number - 1 : number;
  }
  double transfer(double bytes) const { return options_.latency_seconds + bytes / options_.bytes_per_second; }

  void start_ranks();
  void handle(Event&& event);
  double serve(double bytes);
  void take_results(int number, const std::vector<Result>& results, double time);
  bool give(int number, double time);
  void ask_waiting();
  void go_on(int number);
  void report_if_due(int number);
  double block_seconds(Rank& rank, const Block& block);
  void count(double bytes) {
    ++report_.messages;
    report_.bytes += static_cast<std::uint64_t>(bytes);
  }

  const BlockCosts& costs_;
  SimulatorOptions options_;
  WorkBook book_;
  std::vector<double> seconds_;         ///< of each block
  std::vector<double> region_seconds_;  ///< of trees
  double rest_ = 1;                     ///< part of a block's seconds that is not trees
  std::vector<Rank> ranks_;
  std::priority_queue<Event, std::vector<Event>, Later> events_;
  std::deque<int> waiting_;
  std::uint64_t serial_ = 0;
  double now_ = 0, master_free_ = 0, master_busy_ = 0, end_ = 0, poll_ = 0;
  bool polling_ = false;
  SimulatorReport report_;
};

Simulation::Simulation(const BlockCosts& costs, const SimulatorOptions& options)
    : costs_(costs),
      options_(options),
      book_(costs.width, costs.height, book_options(options)),
      seconds_(redistribute(costs, book_.grid())),
      ranks_(static_cast<std::size_t>(options.ranks)) {
  const double work = costs.total_seconds();
  if (!(work > 0)) throw std::invalid_argument("the blocks took no time");
  rest_ = std::max(0.0, 1 - costs.tree_region_seconds / work);
  const int region_width = (costs.width + kRegions - 1) / kRegions;
  const int region_height = (costs.height + kRegions - 1) / kRegions;
  const BlockGrid regions(costs.width, costs.height, region_width, region_height);
  const std::vector<double> by_region = redistribute(costs, regions);
  region_seconds_.assign(std::size_t{kRegions} * kRegions, 0);
  for (std::size_t i = 0; i < by_region.size(); ++i) {
    const std::size_t row = i / static_cast<std::size_t>(regions.columns());
    const std::size_t column = i % static_cast<std::size_t>(regions.columns());
    region_seconds_[row * kRegions + column] =
        std::min(work, costs.tree_region_seconds) * by_region[i] / work;
  }
  poll_ = std::max(1e-4, work / static_cast<double>(book_.count()) / 4);
  report_.schedule = book_.schedule_name();
  report_.ranks = options.ranks;
  report_.block_width = book_.grid().block_width();
  report_.block_height = book_.grid().block_height();
  report_.blocks = book_.count();
  report_.work_seconds = work;
}

void Simulation::start_ranks() {
  std::mt19937_64 random(options_.seed);
  std::uniform_real_distribution<double> even(0, 1);
  double speeds = 0;
  // When each has the package, and when its link is free to pass it on.
  std::vector<double> has(static_cast<std::size_t>(options_.ranks), options_.start_seconds);
  std::vector<double> link_free = has;
  double greeted = options_.start_seconds;
  const double guess = report_.work_seconds / options_.ranks;
  for (int i = 0; i < options_.ranks; ++i) {
    Rank& it = rank(i);
    it.renders = i > 0 || !options_.dedicated_master || options_.ranks == 1;
    if (!options_.speeds.empty())
      it.speed = options_.speeds[static_cast<std::size_t>(i) % options_.speeds.size()];
    else
      it.speed = 1 + options_.speed_spread * (2 * even(random) - 1);
    const bool dies = even(random) < options_.killed;
    const double death = even(random) * guess;
    if (i > 0) {
      const double bytes = static_cast<double>(costs_.scene_bytes);
      greeted += options_.service_seconds;
      const int source = place_above(i - 1) + 1;  // rank i is greeted as number i - 1
      double& link = link_free[static_cast<std::size_t>(source)];
      link = std::max({link, greeted + 2 * options_.latency_seconds, has[static_cast<std::size_t>(source)]}) +
             bytes / options_.bytes_per_second;
      double& here = has[static_cast<std::size_t>(i)];
      here = link_free[static_cast<std::size_t>(i)] = link + options_.latency_seconds;
      it.ready = here + options_.compile_seconds.value_or(costs_.compile_seconds);
      count(bytes + kMessageBytes);
      if (dies) at(it.ready + death, What::kDeath, i);
    }
    if (!it.renders) continue;
    ++report_.workers;
    speeds += it.speed;
    at(it.ready, What::kReady, i);
  }
  report_.efficiency = 1 / speeds;  // times work and over makespan at the end
}

SimulatorReport Simulation::run() {
  start_ranks();
  while (!book_.complete()) {
    if (events_.empty()) throw std::invalid_argument("all ranks are dead");
    Event event = events_.top();
    events_.pop();
    now_ = event.time;
    handle(std::move(event));
  }
  report_.makespan_seconds = end_;
  report_.speed_up = report_.work_seconds / end_;
  report_.efficiency *= report_.work_seconds / end_;
  for (const Rank& it : ranks_) {
    if (!it.renders) continue;
    const double busy = std::min(it.busy, end_);
    report_.idle_seconds += end_ - busy;
    report_.start_seconds += std::min(it.ready, end_);
    report_.wasted_seconds += it.wasted;
  }
  report_.master_busy = std::min(1.0, master_busy_ / end_);
  report_.copies = book_.copies();
  report_.repeated = book_.repeated();
  return report_;
}

/// The time at which the master has handled a message that is there now.
double Simulation::serve(double bytes) {
  const double service = options_.service_seconds + options_.service_per_byte * bytes;
  master_free_ = std::max(now_, master_free_) + service;
  master_busy_ += service;
  return master_free_;
}

void Simulation::handle(Event&& event) {
  Rank& it = rank(event.rank);
  switch (event.what) {
    case What::kReady: {
      const double trees = costs_.tree_fixed_seconds / it.speed;
      it.busy += trees;
      report_.tree_seconds += trees;
      it.ready += trees;
      it.asking = true;
      if (event.rank == 0) {
        // Its own trees are built before its first block; nobody waits for them.
        push({now_ + trees, 0, What::kMessage, 0, true});
      } else {
        count(kMessageBytes);
        push({now_ + trees + transfer(kMessageBytes), 0, What::kMessage, event.rank, true});
      }
      return;
    }
    case What::kMessage: {
      double bytes = kMessageBytes;
      for (const Result& result : event.results)
        bytes += kResultBytes +
                 costs_.result_bytes_per_pixel * static_cast<double>(book_.block(result.number).pixels());
      const double done = event.rank == 0 ? now_ : serve(bytes);
      take_results(event.rank, event.results, done);
      if (event.wants_work && !it.waits && !give(event.rank, done)) {
        it.waits = true;
        waiting_.push_back(event.rank);
      } else if (it.waits && it.unfinished() == 0 && give(event.rank, done)) {
        it.waits = false;
      }
      ask_waiting();
      return;
    }
    case What::kWork:
      if (it.dead) return;
      it.asking = false;
      it.queue.insert(it.queue.end(), event.blocks.begin(), event.blocks.end());
      go_on(event.rank);
      return;
    case What::kRendered: {
      if (it.dead) return;
      it.busy += it.seconds;
      it.results.push_back({std::exchange(it.rendered, -1), it.seconds});
      go_on(event.rank);
      return;
    }
    case What::kPoll:
      polling_ = false;
      ask_waiting();
      return;
    case What::kDeath:
      it.dead = true;
      ++report_.lost_workers;
      it.wasted += it.rendered >= 0 ? it.seconds / 2 : 0;
      at(now_ + options_.silence_seconds, What::kLoss, event.rank);
      return;
    case What::kLoss:
      it.lost = true;
      book_.lost(worker_of(event.rank));
      ask_waiting();
      return;
  }
}

void Simulation::take_results(int number, const std::vector<Result>& results, double time) {
  for (const Result& result : results) {
    if (book_.finished(result.number, worker_of(number), result.seconds, time))
      end_ = std::max(end_, time);
    else
      rank(number).wasted += result.seconds;
  }
}

bool Simulation::give(int number, double time) {
  if (rank(number).lost) return true;  // nothing is owed to it any more
  if (rank(number).dead) {
    // The master does not know; what it gives is lost until it does.
    book_.take(worker_of(number), 1, time);
    return true;
  }
  std::vector<Block> blocks = book_.take(worker_of(number), 1, time);
  if (blocks.empty()) return false;
  double arrival = time;
  if (number > 0) {
    const double bytes = kMessageBytes + kBlockBytes * static_cast<double>(blocks.size());
    count(bytes);
    arrival += transfer(bytes);
  }
  push({arrival, 0, What::kWork, number, false, {}, std::move(blocks)});
  return true;
}

void Simulation::ask_waiting() {
  int refused = 0;
  for (std::size_t left = waiting_.size(); left > 0 && refused < kRefusals; --left) {
    const int number = waiting_.front();
    waiting_.pop_front();
    if (!rank(number).waits) continue;  // it has got work since
    if (give(number, now_)) {
      rank(number).waits = false;
    } else {
      ++refused;
      waiting_.push_back(number);
    }
  }
  if (!waiting_.empty() && !polling_) {
    polling_ = true;
    at(now_ + poll_, What::kPoll, 0);
  }
}

void Simulation::go_on(int number) {
  Rank& it = rank(number);
  if (it.rendered < 0 && !it.queue.empty()) {
    const Block block = it.queue.front();
    it.queue.pop_front();
    it.rendered = block.number;
    it.seconds = block_seconds(it, block);
    at(now_ + it.seconds, What::kRendered, number);
  }
  report_if_due(number);
}

void Simulation::report_if_due(int number) {
  Rank& it = rank(number);
  const bool wants = !it.asking && asks_for_more(it.unfinished(), 1);
  const bool idle = it.unfinished() == 0 && !it.results.empty();
  if (!wants && !idle) return;
  it.asking |= wants;
  double delay = 0;
  if (number > 0) {
    double bytes = kMessageBytes;
    for (const Result& result : it.results)
      bytes += kResultBytes +
               costs_.result_bytes_per_pixel * static_cast<double>(book_.block(result.number).pixels());
    count(bytes);
    delay = transfer(bytes);
  }
  push({now_ + delay, 0, What::kMessage, number, wants, std::exchange(it.results, {}), {}});
}

double Simulation::block_seconds(Rank& it, const Block& block) {
  const int region_width = (costs_.width + kRegions - 1) / kRegions;
  const int region_height = (costs_.height + kRegions - 1) / kRegions;
  double trees = 0;
  for (int row = block.y / region_height; row <= (block.y + block.height - 1) / region_height; ++row) {
    for (int column = block.x / region_width; column <= (block.x + block.width - 1) / region_width;
         ++column) {
      const std::size_t region = static_cast<std::size_t>(row) * kRegions + static_cast<std::size_t>(column);
      if (it.regions[region]) continue;
      it.regions[region] = true;
      trees += region_seconds_[region];
    }
  }
  report_.tree_seconds += trees / it.speed;
  return (seconds_[static_cast<std::size_t>(block.number)] * rest_ + trees) / it.speed;
}

}  // namespace

SimulatorReport simulate(const BlockCosts& costs, const SimulatorOptions& options) {
  check(options);
  return Simulation(costs, options).run();
}

std::string report_text(const SimulatorReport& r) {
  std::string out = fmt::format("{} ranks, {} of them render; schedule {}, {} blocks of {} x {} pixels\n",
                                r.ranks, r.workers, r.schedule, r.blocks, r.block_width, r.block_height);
  out += fmt::format("work {:.6g} s, makespan {:.6g} s: speed-up {:.2f}, efficiency {:.3f}\n", r.work_seconds,
                     r.makespan_seconds, r.speed_up, r.efficiency);
  out += "(efficiency: work / (sum of the speeds of those that render * makespan))\n";
  out += fmt::format(
      "idle {:.6g} s, {:.6g} s of it before the scene was there; trees {:.6g} s, wasted {:.6g} s\n",
      r.idle_seconds, r.start_seconds, r.tree_seconds, r.wasted_seconds);
  out +=
      fmt::format("messages {}, bytes {}, master busy {:.1f} %\n", r.messages, r.bytes, 100 * r.master_busy);
  out += fmt::format("blocks given twice {}, results ignored {}, ranks lost {}\n", r.copies, r.repeated,
                     r.lost_workers);
  return out;
}

std::string report_json(const SimulatorReport& r) {
  JsonWriter j;
  const auto whole = [](std::int64_t number) { return static_cast<std::uint64_t>(number); };
  j.begin_object();
  j.value("schedule", r.schedule).value("ranks", r.ranks).value("workers", r.workers);
  j.value("block_width", r.block_width)
      .value("block_height", r.block_height)
      .value("blocks", whole(r.blocks));
  j.value("work_seconds", r.work_seconds).value("makespan_seconds", r.makespan_seconds);
  j.value("speed_up", r.speed_up).value("efficiency", r.efficiency);
  j.value("idle_seconds", r.idle_seconds).value("start_seconds", r.start_seconds);
  j.value("tree_seconds", r.tree_seconds).value("wasted_seconds", r.wasted_seconds);
  j.value("master_busy", r.master_busy).value("messages", whole(r.messages)).value("bytes", r.bytes);
  j.value("copies", whole(r.copies)).value("repeated", whole(r.repeated));
  j.value("lost_workers", whole(r.lost_workers));
  j.end_object();
  return j.text();
}

SimulatorOptions simulator_options(const rayshade::Options& options, int ranks) {
  const rayshade::ClusterOptions& cluster = options.cluster;
  SimulatorOptions out;
  out.ranks = ranks;
  out.schedule = cluster.schedule;
  out.starts = cluster.start;
  out.granularity = cluster.granularity;
  out.block_side = options.block;
  out.dedicated_master = cluster.dedicated_master;
  double compile = -1, seed = 1;
  const std::pair<const char*, double*> known[] = {{"latency", &out.latency_seconds},
                                                   {"bandwidth", &out.bytes_per_second},
                                                   {"start", &out.start_seconds},
                                                   {"compile", &compile},
                                                   {"service", &out.service_seconds},
                                                   {"spread", &out.speed_spread},
                                                   {"deaths", &out.killed},
                                                   {"silence", &out.silence_seconds},
                                                   {"seed", &seed}};
  for (const std::string& word : cluster.assume) {
    const std::size_t equals = word.find('=');
    const auto entry = std::find_if(std::begin(known), std::end(known),
                                    [&](const auto& k) { return k.first == word.substr(0, equals); });
    if (equals == std::string::npos || entry == std::end(known))
      throw rayshade::UsageError(fmt::format(
          "--assume: '{}' is none of latency, bandwidth, start, compile, service, spread, deaths, "
          "silence and seed with = and a number",
          word));
    *entry->second = rayshade::parse_real(word.substr(equals + 1), "--assume");
  }
  if (compile >= 0) out.compile_seconds = compile;
  out.seed = static_cast<std::uint64_t>(std::abs(seed));
  try {
    check(out);
  } catch (const std::invalid_argument& error) {
    throw rayshade::UsageError(fmt::format("--assume: {}", error.what()));
  }
  return out;
}

std::string run_simulator(const std::string& costs_path, const SimulatorOptions& options, bool json) {
  const SimulatorReport report = simulate(read_block_costs(costs_path), options);
  return json ? report_json(report) : report_text(report);
}

}  // namespace pafas
