// SPDX-License-Identifier: MIT
// One program for all ranks: rank 0 is the master, the others are slaves.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <initializer_list>
#include <string>
#include <vector>

#include "pafas/master.h"
#include "pafas/mpi_transport.h"
#include "pafas/worker.h"
#include "rayshade/cli/program.h"
#include "rayshade/cli/signals.h"

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

/// Where nobody has started MPI, what needs none does without.
bool only_tells_about_itself(const std::vector<std::string>& arguments) {
  if (any_of({"OMPI_COMM_WORLD_SIZE", "PMI_RANK", "PMIX_RANK", "SLURM_PROCID"})) return false;
  try {
    using rayshade::Action;
    const Action action = rayshade::parse_options(arguments, rayshade::Program::kPafas).action;
    return action == Action::kHelp || action == Action::kVersion || action == Action::kManOptions ||
           action == Action::kCompletion;
  } catch (const rayshade::UsageError&) {
    return true;
  }
}

class InformationEngine final : public rayshade::LocalEngine {
 public:
  rayshade::Program kind() const override { return rayshade::Program::kPafas; }
};

}  // namespace

int main(int argc, char** argv) {
  if (const std::vector<std::string> words(argv + 1, argv + argc); only_tells_about_itself(words)) {
    InformationEngine engine;
    return rayshade::run_program(words, engine);
  }
  if (const int meant = tasks_without_mpi(); meant > 1) return refuse(meant);
  pafas::MpiTransport transport(&argc, &argv);
  const std::vector<std::string> arguments(argv + 1, argv + argc);
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
