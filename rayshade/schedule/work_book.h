// SPDX-License-Identifier: MIT
// The book of a picture's blocks: which are still to be given, who has which, which are done.
//
// A schedule says which block a worker gets next; the book adds what makes a job end well whatever becomes of
// its workers. A block that is given is leased. A result counts whoever brings it, once; others of the same
// block are counted and ignored. Blocks of a worker that is lost are given first. A lease of which nothing is
// heard for many times as long as expected ends, and the block goes to another. When nothing else is left,
// workers without work get copies of blocks that are overdue elsewhere, the oldest leases first. What is
// expected is processor time; how much longer it takes by the clock, on processors that others use too, is
// learnt from the blocks that come back: where all are late none is overdue.
//
// Pure: the time is a number that callers give, in seconds, and never goes back. So the master of a cluster,
// the simulator and the tests use the same book. As long as somebody asks for work, the job ends.
#pragma once

#include <cstdint>
#include <deque>
#include <list>
#include <memory>
#include <queue>
#include <string>
#include <unordered_map>
#include <vector>

#include "rayshade/schedule/block_grid.h"
#include "rayshade/schedule/cost_forecast.h"
#include "rayshade/schedule/remaining_work.h"
#include "rayshade/schedule/schedule.h"

namespace rayshade {

struct WorkBookOptions {
  std::string schedule;         ///< as ScheduleOptions::name
  std::string starts;           ///< as ScheduleOptions::starts
  int granularity = 0;          ///< blocks per message at most; 0: chosen
  int workers = 1;              ///< that are expected
  int block_side = 0;           ///< pixels; 0: chosen
  int most_copies = 2;          ///< leases of one block at a time; 1: no copies are given
  double lease_seconds = 10;    ///< a lease holds at least so long
  double lease_factor = 8;      ///< and so many times as long as it is expected to take
  double overdue_factor = 1.5;  ///< a block may be given twice after so many times the expected time
};

class WorkBook {
 public:
  /// Throws std::invalid_argument for an unknown schedule or scheme of starting blocks.
  WorkBook(int width, int height, const WorkBookOptions& options);
  ~WorkBook();
  WorkBook(WorkBook&&) noexcept;
  WorkBook& operator=(WorkBook&&) noexcept;

  /// The schedule in use; never "auto".
  const std::string& schedule_name() const { return name_; }
  const BlockGrid& grid() const { return *grid_; }
  std::int64_t count() const { return grid_->count(); }
  Block block(std::int64_t number) const { return grid_->block(number); }

  /// A block is there already. Before anything is taken.
  void skip(std::int64_t number);
  /// What a block is expected to cost, on a worker of speed 1: from an earlier frame, or an estimate.
  void expect(std::int64_t number, double seconds);

  /// The next blocks for a worker of so many threads, in the order in which they should be rendered. Empty:
  /// none for it now, but perhaps later, unless the picture is complete.
  std::vector<Block> take(int worker, int threads, double now);
  /// A worker has rendered a block in so many seconds of one thread's processor time. Whether it is the first
  /// result of the block.
  bool finished(std::int64_t number, int worker, double seconds, double now);
  /// Nothing more is expected of a worker; its blocks go to others. It may come back, and late results count.
  void lost(int worker);

  std::int64_t missing() const { return missing_; }            ///< blocks without a result
  std::int64_t unassigned() const { return left_->blocks(); }  ///< never given to anybody
  std::int64_t leased() const { return leased_; }  ///< blocks in the hands of workers; copies count
  bool complete() const { return missing_ == 0; }
  std::int64_t repeated() const { return repeated_; }  ///< results of blocks that had one
  std::int64_t copies() const { return copies_; }      ///< leases of blocks that another worker had too
  std::int64_t expired() const { return expired_; }    ///< leases that ended by time

 private:
  enum class State : std::uint8_t { kFree, kGiven, kReturned, kDone };
  struct Lease {
    std::vector<int> workers;
    double due = 0;                           ///< when the latest of them should have it
    std::list<std::int64_t>::iterator place;  ///< in oldest_
  };
  struct Deadline {
    double time = 0;
    std::int64_t number = 0;
    int worker = 0;
    std::uint64_t serial = 0;  ///< of the worker's lease
    bool operator<(const Deadline& other) const { return time > other.time; }
  };
  struct Held {
    std::int64_t number = 0;
    std::uint64_t serial = 0;
  };
  struct Worker {
    bool present = false, lost = false;
    int threads = 1;
    double expected = 0, took = 0;  ///< seconds of finished blocks, by forecast and in truth; old ones fade
    double busy_until = 0;          ///< by the clock
    double since = 0;               ///< when it began with the block that will be its next result
    double weight = 0;              ///< its part of speed_
    std::vector<Held> held;
  };

  Worker& worker(int number);
  double speed(const Worker& worker) const;
  double stretch() const;
  void weigh(Worker& worker, double weight);
  std::int64_t next_block(int worker);
  void lease(std::int64_t number, int worker, double now);
  bool drop(std::int64_t number, int worker);
  void give_back(std::int64_t number, int worker, bool first);
  void expire(double now);
  void give_copies(int worker, std::vector<Block>& blocks, double now);
  void learn(std::int64_t number, int worker, double seconds);
  void watch(Worker& worker, std::size_t held, double seconds, double now);

  WorkBookOptions options_;
  std::string name_;
  std::unique_ptr<BlockGrid> grid_;
  std::unique_ptr<CostForecast> forecast_;
  std::unique_ptr<RemainingWork> left_;
  std::unique_ptr<Schedule> schedule_;
  std::vector<State> states_;
  std::unordered_map<std::int64_t, Lease> leases_;
  std::list<std::int64_t> oldest_;  ///< leased blocks by age
  std::priority_queue<Deadline> deadlines_;
  std::deque<std::int64_t> returned_;  ///< to be given before all others, if they are still State::kReturned
  std::unordered_map<int, Worker> workers_;
  double speed_ = 0;  ///< threads times speed of all that are present
  double elapsed_ = 0,
         worked_ = 0;  ///< seconds of threads by the clock, and of their processors; old ones fade
  int present_ = 0, lost_ = 0;
  std::uint64_t serial_ = 0;
  std::int64_t missing_ = 0, leased_ = 0, repeated_ = 0, copies_ = 0, expired_ = 0;
};

}  // namespace rayshade
