// SPDX-License-Identifier: MIT
// How long a job would take on many machines: recorded block costs, replayed event by event with the work
// book that the master uses.
//
// The model. Rank 0 is the master: a server that handles one message after the other, each in a fixed time
// and a time by its bytes. Every other rank starts, gets the scene from the one above it in the tree of
// relay.h, as soon as that one has all of it, over a link that sends to one rank after the other, compiles
// it, builds what every process builds, and asks for work. Messages take a latency and a time by their bytes.
// A worker asks again when no block waits for it (granularity.h). A block takes its recorded seconds divided
// by the worker's speed, without the part that went into trees; that part, for each region of the picture (32
// x 32 of them) that the block touches, is spent by every worker that comes there first. If the master
// renders, it does so without messages and beside its service. Ranks have one thread each.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rayshade/cli/options.h"
#include "rayshade/schedule/block_costs.h"
#include "rayshade/schedule/work_book.h"

namespace pafas {

struct SimulatorOptions {
  int ranks = 1;
  std::string schedule = "auto", starts;
  int granularity = 0;
  int block_side = 0;             ///< 0: chosen for the number of ranks
  bool dedicated_master = false;  ///< rank 0 renders nothing; with one rank it renders all the same
  int most_copies = 2;
  std::vector<double> speeds;  ///< of the ranks, used in turn; empty: equal to the recorded one, or by spread
  double speed_spread = 0;     ///< speeds are even random numbers from 1 - spread to 1 + spread, below 1
  double latency_seconds = 50e-6;  ///< of a message
  double bytes_per_second = 1e9;   ///< of every link
  double start_seconds = 0;        ///< from the start of the job until a slave can receive
  std::optional<double>
      compile_seconds;              ///< from the scene's arrival until it can render; unset: as recorded
  double service_seconds = 10e-6;   ///< of the master, per message
  double service_per_byte = .2e-9;  ///< and per byte: unpacking into the picture
  double killed = 0;                ///< part of the slaves that die at a random time of the run
  double silence_seconds = 5;       ///< until the master takes a dead slave for lost
  std::uint64_t seed = 1;           ///< of random speeds and deaths
};

struct SimulatorReport {
  std::string schedule;
  int ranks = 0, workers = 0;  ///< workers: ranks that render
  int block_width = 0, block_height = 0;
  std::int64_t blocks = 0;
  double work_seconds = 0;      ///< sum of the blocks' recorded costs
  double makespan_seconds = 0;  ///< from the start of the job until the master has the last block
  double speed_up = 0;          ///< work_seconds / makespan_seconds
  double efficiency = 0;        ///< work_seconds / (sum of the workers' speeds * makespan_seconds)
  double idle_seconds = 0;      ///< workers' time without work, from the start to the end, their sum
  double start_seconds = 0;     ///< part of it: before a worker has the scene
  double tree_seconds = 0;      ///< all workers' time for building trees
  double wasted_seconds = 0;    ///< for blocks that had a result already, or were lost with their worker
  double master_busy = 0;       ///< part of the makespan in which the master served
  std::int64_t messages = 0;    ///< in both directions, of work and results
  std::uint64_t bytes = 0;      ///< of these and of the scene
  std::int64_t copies = 0, repeated = 0, lost_workers = 0;
};

/// Throws std::invalid_argument for options that make no sense.
SimulatorReport simulate(const rayshade::BlockCosts& costs, const SimulatorOptions& options);

std::string report_text(const SimulatorReport& report);
std::string report_json(const SimulatorReport& report);

/// What the program's options say; `assume`: words KEY=VALUE (latency, bandwidth, start, compile, service,
/// spread, deaths, silence, seed). Throws rayshade::UsageError.
SimulatorOptions simulator_options(const rayshade::Options& options, int ranks);

/// Reads the costs, simulates, and returns the report as text or JSON. Throws BlockCostsError and
/// std::invalid_argument.
std::string run_simulator(const std::string& costs_path, const SimulatorOptions& options, bool json);

}  // namespace pafas
