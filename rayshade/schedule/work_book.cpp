// SPDX-License-Identifier: MIT
#include "rayshade/schedule/work_book.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rayshade/schedule/granularity.h"

namespace rayshade {
namespace {

/// Leases that are looked at for one worker without work: those of its own are passed over, and the first
/// that are not overdue tell that later ones will hardly be.
constexpr int kMostLooks = 16;
/// Part of a worker's record that is kept with each new block: machines have other users, who come and go.
constexpr double kMemory = .95;
/// By the clock, for a second of processor time: beyond this a worker was not slow but stopped.
constexpr double kMostStretch = 32;

}  // namespace

WorkBook::WorkBook(int width, int height, const WorkBookOptions& options)
    : options_(options), name_(resolve_schedule(options.schedule)) {
  const ScheduleOptions schedule{name_, options.starts, std::max(1, options.workers), options.block_side};
  grid_ = std::make_unique<BlockGrid>(schedule_grid(width, height, schedule));
  forecast_ = std::make_unique<CostForecast>(*grid_);
  left_ = std::make_unique<RemainingWork>(*grid_, *forecast_);
  schedule_ = make_schedule(schedule, *grid_, *forecast_);
  missing_ = grid_->count();
  states_.assign(static_cast<std::size_t>(missing_), State::kFree);
}

WorkBook::~WorkBook() = default;
WorkBook::WorkBook(WorkBook&&) noexcept = default;
WorkBook& WorkBook::operator=(WorkBook&&) noexcept = default;

void WorkBook::skip(std::int64_t number) {
  State& state = states_[static_cast<std::size_t>(number)];
  if (state != State::kFree) return;
  state = State::kDone;
  --missing_;
  left_->remove(number);
}

void WorkBook::expect(std::int64_t number, double seconds) {
  forecast_->learn(number, seconds);
  left_->learned(number);
  schedule_->learned(number);
}

// ---- workers

WorkBook::Worker& WorkBook::worker(int number) { return workers_[number]; }

double WorkBook::speed(const Worker& worker) const {
  // Until a worker has done several blocks it counts as average: a block may differ much from its neighbours.
  const double prior = forecast_->mean_per_pixel() * static_cast<double>(grid_->block(0).pixels()) * 2;
  if (prior <= 0) return 1;
  return std::clamp((worker.expected + prior) / (worker.took + prior), .01, 100.0);
}

/// Seconds by the clock for a second of processor time.
double WorkBook::stretch() const {
  return worked_ > 0 ? std::clamp(elapsed_ / worked_, 1.0, kMostStretch) : 1;
}

void WorkBook::weigh(Worker& worker, double weight) {
  speed_ += weight - worker.weight;
  worker.weight = weight;
}

void WorkBook::lost(int number) {
  Worker& it = worker(number);
  if (it.present) {
    it.present = false;
    --present_;
  }
  if (!it.lost) ++lost_;
  it.lost = true;
  weigh(it, 0);
  while (!it.held.empty()) give_back(it.held.back().number, number, true);
}

// ---- leases

void WorkBook::lease(std::int64_t number, int worker_number, double now) {
  Worker& it = worker(worker_number);
  if (it.held.empty()) {
    schedule_->rest(worker_number, false);
    it.since = now;
  }
  double expected = stretch() * forecast_->seconds(number) / (speed(it) * it.threads);
  if (!forecast_->knows()) expected = options_.lease_seconds / options_.lease_factor;
  it.busy_until = std::max(now, it.busy_until) + expected;
  const std::uint64_t serial = ++serial_;
  it.held.push_back({number, serial});
  ++leased_;
  // A block occupies one thread alone, however many there are.
  const double due = std::max(it.busy_until, now + expected * it.threads);
  const auto [entry, is_new] = leases_.try_emplace(number);
  Lease& lease = entry->second;
  if (is_new) lease.place = oldest_.insert(oldest_.end(), number);
  lease.workers.push_back(worker_number);
  lease.due = std::max(lease.due, now + options_.overdue_factor * (due - now));
  deadlines_.push({now + std::max(options_.lease_seconds, options_.lease_factor * (due - now)), number,
                   worker_number, serial});
  states_[static_cast<std::size_t>(number)] = State::kGiven;
}

bool WorkBook::drop(std::int64_t number, int worker_number) {
  Worker& it = worker(worker_number);
  const auto held =
      std::find_if(it.held.begin(), it.held.end(), [&](const Held& h) { return h.number == number; });
  if (held == it.held.end()) return false;
  it.held.erase(held);
  --leased_;
  if (it.held.empty()) {
    it.busy_until = 0;
    schedule_->rest(worker_number, true);
  }
  const auto entry = leases_.find(number);
  std::erase(entry->second.workers, worker_number);
  if (entry->second.workers.empty()) {
    oldest_.erase(entry->second.place);
    leases_.erase(entry);
  }
  return true;
}

void WorkBook::give_back(std::int64_t number, int worker_number, bool first) {
  if (!drop(number, worker_number) || leases_.contains(number)) return;
  states_[static_cast<std::size_t>(number)] = State::kReturned;
  if (first)
    returned_.push_front(number);
  else
    returned_.push_back(number);
}

void WorkBook::expire(double now) {
  while (!deadlines_.empty() && deadlines_.top().time < now) {
    const Deadline top = deadlines_.top();
    deadlines_.pop();
    const std::vector<Held>& held = worker(top.worker).held;
    const bool current =
        std::any_of(held.begin(), held.end(), [&](const Held& h) { return h.serial == top.serial; });
    if (!current) continue;
    ++expired_;
    give_back(top.number, top.worker, false);
  }
}

// ---- giving

std::int64_t WorkBook::next_block(int worker_number) {
  while (!returned_.empty()) {
    const std::int64_t number = returned_.front();
    returned_.pop_front();
    if (states_[static_cast<std::size_t>(number)] == State::kReturned) return number;
  }
  while (left_->blocks() > 0) {
    const std::int64_t number = schedule_->next(worker_number);
    if (number < 0) return -1;
    if (states_[static_cast<std::size_t>(number)] != State::kFree) continue;
    left_->remove(number);
    return number;
  }
  return -1;
}

std::vector<Block> WorkBook::take(int worker_number, int threads, double now) {
  std::vector<Block> blocks;
  Worker& it = worker(worker_number);
  if (!it.present) {
    it.present = true;
    ++present_;
    if (it.lost) --lost_;
    it.lost = false;
  }
  it.threads = std::max(1, threads);
  weigh(it, speed(it) * it.threads);
  expire(now);
  if (complete()) return blocks;

  // Those that are expected and have not come yet will want their share too.
  const int awaited = std::max(0, options_.workers - lost_ - present_);
  const double all = speed_ + awaited * (speed_ / present_);
  const MessageSize size = message_size({left_->blocks(), left_->seconds(), it.weight / all, it.threads,
                                         speed(it), present_ + awaited, options_.granularity});
  // Others will have done all the rest before this one comes to it: work is not put by for it.
  const bool late = it.held.size() >= static_cast<std::size_t>(it.threads) && left_->seconds() > 0 &&
                    it.busy_until - now > stretch() * left_->seconds() / all;
  if (late) return blocks;
  double seconds = 0;
  while (static_cast<int>(blocks.size()) < size.blocks) {
    const bool enough = static_cast<int>(blocks.size()) >= it.threads && seconds >= size.seconds;
    if (enough) break;
    const std::int64_t number = next_block(worker_number);
    if (number < 0) break;
    seconds += forecast_->seconds(number) / (speed(it) * it.threads);
    lease(number, worker_number, now);
    blocks.push_back(grid_->block(number));
  }
  if (blocks.empty()) give_copies(worker_number, blocks, now);
  return blocks;
}

void WorkBook::give_copies(int worker_number, std::vector<Block>& blocks, double now) {
  const auto most = static_cast<std::size_t>(std::max(1, options_.most_copies));
  const auto threads = static_cast<std::size_t>(worker(worker_number).threads);
  int looks = 0;
  for (auto i = oldest_.begin(); i != oldest_.end() && blocks.size() < threads && looks < kMostLooks;
       ++looks) {
    const std::int64_t number = *i++;
    Lease& it = leases_.at(number);
    if (it.workers.size() >= most || now < it.due ||
        std::find(it.workers.begin(), it.workers.end(), worker_number) != it.workers.end())
      continue;
    // It is the youngest lease now, so that the next worker looks at another block first.
    oldest_.splice(oldest_.end(), oldest_, it.place);
    lease(number, worker_number, now);
    ++copies_;
    blocks.push_back(grid_->block(number));
  }
}

// ---- results

void WorkBook::learn(std::int64_t number, int worker_number, double seconds) {
  if (!std::isfinite(seconds) || seconds < 0) return;
  Worker& it = worker(worker_number);
  if (const double nearby = forecast_->nearby_seconds(number); nearby > 0) {
    it.expected = it.expected * kMemory + nearby;
    it.took = it.took * kMemory + seconds;
    if (it.present) weigh(it, speed(it) * it.threads);
  }
  forecast_->learn(number, seconds * speed(it));
  left_->learned(number);
  schedule_->learned(number);
}

void WorkBook::watch(Worker& it, std::size_t held, double seconds, double now) {
  if (!std::isfinite(seconds) || seconds <= 0) return;
  const auto threads = static_cast<double>(std::min(held, static_cast<std::size_t>(it.threads)));
  elapsed_ = elapsed_ * kMemory + std::min(threads * (now - it.since), kMostStretch * seconds);
  worked_ = worked_ * kMemory + seconds;
  it.since = now;
}

bool WorkBook::finished(std::int64_t number, int worker_number, double seconds, double now) {
  expire(now);
  Worker& it = worker(worker_number);
  const std::size_t held = it.held.size();
  if (drop(number, worker_number)) watch(it, held, seconds, now);
  State& state = states_[static_cast<std::size_t>(number)];
  if (state == State::kDone) {
    ++repeated_;
    return false;
  }
  if (state == State::kFree) left_->remove(number);
  state = State::kDone;
  --missing_;
  learn(number, worker_number, seconds);
  if (const auto entry = leases_.find(number); entry != leases_.end()) {
    // Others go on with it: no message would reach them in time. It is no longer theirs all the same.
    const std::vector<int> others = entry->second.workers;
    for (const int other : others) drop(number, other);
  }
  return true;
}

}  // namespace rayshade
