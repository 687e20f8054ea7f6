// SPDX-License-Identifier: MIT
// The order in which blocks are given to workers for the first time. What became of blocks that were given is
// the work book's concern (work_book.h): a schedule gives every block once.
//
// A worker is a number from 0; more may come than were announced.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "rayshade/schedule/block_grid.h"

namespace rayshade {

class CostForecast;

class Schedule {
 public:
  virtual ~Schedule() = default;
  /// The number of the block that comes next for a worker; from now on it is given. -1: there is none for it
  /// now. Unless all are given, a call by some worker returns one, once those that have blocks of their own
  /// waiting and do not fetch them are at rest().
  virtual std::int64_t next(int worker) = 0;
  /// Told when a worker comes to have no block in hand (none given, or all it was given are done, or it is
  /// lost), and when it has some again. All are at rest in the beginning. A schedule that binds blocks to
  /// workers lets others have those of workers at rest.
  virtual void rest(int /*worker*/, bool /*at_rest*/) {}
  /// Told after the forecast has learned what a block took.
  virtual void learned(std::int64_t /*number*/) {}
};

struct ScheduleOptions {
  std::string name;    ///< "roundrobin", "bands", "blocks", "cost"; "auto" or empty: the best
  std::string starts;  ///< of the blocks schedule: "third", "half", "two-circles" or empty
  int workers = 1;     ///< that are expected
  int block_side = 0;  ///< pixels; 0: chosen
};

/// What "auto" stands for.
std::string resolve_schedule(const std::string& name);

/// How the picture is cut for a schedule: into squares, or for round robin and bands into scan lines.
BlockGrid schedule_grid(int width, int height, const ScheduleOptions& options);

/// The schedule of a name. `forecast` outlives it. Throws std::invalid_argument for unknown names.
std::unique_ptr<Schedule> make_schedule(const ScheduleOptions& options, const BlockGrid& grid,
                                        const CostForecast& forecast);

}  // namespace rayshade
