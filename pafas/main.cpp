// SPDX-License-Identifier: MIT
// One program for all ranks: rank 0 is the master, the others are slaves.
#include <fmt/format.h>

#include <cstdlib>
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

/// A starter that does not speak this MPI's language starts as many single processes, each of which would
/// render the whole picture. How many it meant to start; 0: this is no such process.
int mistaken_singletons(int size) {
  if (size > 1) return 0;
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"})
    if (const int meant = number_in(name); meant > 1) return meant;
  // In a batch script, outside of srun, Slurm's number is that of the whole job.
  if (std::getenv("SLURM_STEP_ID") && number_in("SLURM_NTASKS") > 1) return number_in("SLURM_NTASKS");
  return 0;
}

/// Where nobody has started MPI, what needs none does without.
bool only_tells_about_itself(const std::vector<std::string>& arguments) {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_RANK", "PMIX_RANK", "SLURM_PROCID"})
    if (std::getenv(name)) return false;
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
  pafas::MpiTransport transport(&argc, &argv);
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  int code = rayshade::kUsage;
  if (const int meant = mistaken_singletons(transport.size()); meant > 1) {
    fmt::print(stderr,
               "pafas: started as one of {} processes, but MPI knows of this one only: each would render the "
               "whole picture.\nStart it with the mpirun of its MPI, or with srun --mpi=pmix or --mpi=pmi2, "
               "whichever that MPI was built for.\n",
               meant);
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
