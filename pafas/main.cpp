// SPDX-License-Identifier: MIT
// One program for all ranks: rank 0 is the master, the others are slaves.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "pafas/estimate.h"
#include "pafas/master.h"
#include "pafas/mpi_transport.h"
#include "pafas/package.h"
#include "pafas/simulator.h"
#include "pafas/worker.h"
#include "rayshade/cli/program.h"
#include "rayshade/cli/signals.h"
#include "rayshade/image/output_file.h"
#include "rayshade/schedule/block_costs.h"

namespace {

int number_in(const char* name) {
  const char* value = std::getenv(name);
  return value ? std::atoi(value) : 0;
}

bool any_of(std::initializer_list<const char*> names) {
  return std::any_of(names.begin(), names.end(),
                     [](const char* name) { return std::getenv(name) != nullptr; });
}

/// A starter that does not speak this MPI's language starts as many single processes, each of which would
/// render the whole picture. How many srun means to start without a word to any MPI; 0: it is not so.
int tasks_without_mpi() {
  if (!any_of({"SLURM_STEP_ID"}) || any_of({"PMIX_RANK", "PMI_RANK", "PMI_FD", "OMPI_COMM_WORLD_SIZE"}))
    return 0;
  const int step = number_in("SLURM_STEP_NUM_TASKS");
  return step > 0 ? step : number_in("SLURM_NTASKS");
}

/// The same, once MPI has said that this process is alone.
int meant_by_starter() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"})
    if (const int meant = number_in(name); meant > 1) return meant;
  return 0;
}

int refuse(int meant) {
  fmt::print(
      stderr,
      "pafas: started as one of {} processes, but MPI knows of this one only: each would render the whole "
      "picture.\nStart it with the mpirun of its MPI, or with srun --mpi=pmix or --mpi=pmi2, whichever "
      "that MPI was built for.\n",
      meant);
  return rayshade::kUsage;
}

/// What needs no MPI does without where nobody has started it: information, simulation and estimate.
class SingleEngine final : public rayshade::LocalEngine {
 public:
  rayshade::Program kind() const override { return rayshade::Program::kPafas; }
  rayshade::Provider& provider() override { return files_; }
  std::uint64_t scene_bytes() const override { return files_.package().size(); }
  int estimate(const rayshade::EnginePlan& plan) override { return pafas::run_estimate(plan, scene_bytes()); }

 private:
  pafas::RecordingProvider files_;
};

bool needs_no_mpi(const rayshade::Options& options) {
  using rayshade::Action;
  switch (options.action) {
    case Action::kHelp:
    case Action::kVersion:
    case Action::kManOptions:
    case Action::kCompletion:
      return true;
    default:
      return options.cluster.estimate > 0;
  }
}

int simulate(const rayshade::Options& options) {
  if (!options.cluster.costs) throw rayshade::UsageError("--simulate needs block costs: --costs FILE");
  const pafas::SimulatorReport report =
      pafas::simulate(rayshade::read_block_costs(*options.cluster.costs),
                      pafas::simulator_options(options, options.cluster.simulate));
  fmt::print("{}", pafas::report_text(report));
  if (options.stats_file) {
    rayshade::OutputFile file(*options.stats_file);
    file.write(pafas::report_json(report));
    file.commit();
  }
  return rayshade::kComplete;
}

/// The exit code where MPI is not needed; empty where it is.
std::optional<int> run_without_mpi(const std::vector<std::string>& arguments) {
  if (any_of({"OMPI_COMM_WORLD_SIZE", "PMI_RANK", "PMIX_RANK", "SLURM_PROCID"})) return {};
  try {
    const rayshade::Options options = rayshade::parse_options(arguments, rayshade::Program::kPafas);
    if (options.cluster.simulate > 0) return simulate(options);
    if (!needs_no_mpi(options)) return {};
  } catch (const rayshade::BlockCostsError& error) {
    fmt::print(stderr, "pafas: {}\n", error.what());
    return rayshade::kFailed;
  } catch (const rayshade::WriteError& error) {
    fmt::print(stderr, "pafas: {}\n", error.what());
    return rayshade::kFailed;
  } catch (const rayshade::UsageError& error) {
    fmt::print(stderr, "pafas: {}\nTry 'pafas --help'.\n", error.what());
    return rayshade::kUsage;
  }
  SingleEngine engine;
  return rayshade::run_program(arguments, engine);
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (const std::optional<int> code = run_without_mpi(arguments)) return *code;
  if (const int meant = tasks_without_mpi(); meant > 1) return refuse(meant);
  pafas::MpiTransport transport(&argc, &argv);
  int code = rayshade::kUsage;
  if (const int meant = meant_by_starter(); transport.size() == 1 && meant > 1) {
    code = refuse(meant);
  } else if (transport.rank() == 0) {
    pafas::Master master(transport, {RAYSHADE_VERSION, arguments, transport.ranks_here()});
    code = rayshade::run_program(arguments, master);
  } else {
    const rayshade::SignalRequests signals;  // a slave goes on until the master says otherwise
    pafas::Worker worker(transport, {RAYSHADE_VERSION, transport.ranks_here()});
    code = worker.run();
  }
  transport.set_exit_code(code);
  return code;
}
