// SPDX-License-Identifier: MIT
#include "pafas/mpi_transport.h"

#include <mpi.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <stdexcept>

namespace pafas {
namespace {

constexpr int kTag = 1;

/// Set before the alarm that ends a process whose MPI does not end.
volatile std::sig_atomic_t g_exit_code = 0;

void leave(int) { _exit(g_exit_code); }

int number_in(const char* name) {
  const char* value = std::getenv(name);
  return value ? std::atoi(value) : 0;
}

int count_ranks_here() {
  // Of Open MPI, MPICH and Slurm (whose list for several nodes begins with the number of this kind: "8(x4)").
  for (const char* name : {"OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS", "SLURM_STEP_TASKS_PER_NODE",
                           "SLURM_NTASKS_PER_NODE"})
    if (const int n = number_in(name); n > 0) return n;
  return 1;
}

}  // namespace

struct MpiTransport::Sending {
  int to = 0;
  std::string bytes;
  MPI_Request request = MPI_REQUEST_NULL;
};

struct MpiTransport::Receiving {
  Message message;
  MPI_Request request = MPI_REQUEST_NULL;
};

MpiTransport::MpiTransport(int* argc, char*** argv) {
  int provided = 0;
  MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  // An error in a message to a dead rank is not the end of this one.
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  ranks_here_ = std::clamp(count_ranks_here(), 1, size_);
}

MpiTransport::~MpiTransport() {
  g_exit_code = exit_code_;
  std::signal(SIGALRM, leave);
  alarm(patience_);
  MPI_Finalize();
  alarm(0);
}

void MpiTransport::send(int to, std::string bytes) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw std::length_error("a message of more than 2 GB");
  auto sending = std::make_unique<Sending>();
  sending->to = to;
  sending->bytes = std::move(bytes);
  const int error = MPI_Isend(sending->bytes.data(), static_cast<int>(sending->bytes.size()), MPI_BYTE, to,
                              kTag, MPI_COMM_WORLD, &sending->request);
  if (error == MPI_SUCCESS) sending_.push_back(std::move(sending));
}

void MpiTransport::clear_sent() {
  std::erase_if(sending_, [](const std::unique_ptr<Sending>& sending) {
    int done = 0;
    return MPI_Test(&sending->request, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS || done != 0;
  });
}

bool MpiTransport::sent(int to) {
  clear_sent();
  return std::none_of(sending_.begin(), sending_.end(),
                      [&](const std::unique_ptr<Sending>& sending) { return sending->to == to; });
}

std::optional<Message> MpiTransport::receive() {
  // A sender may die in the middle of a long message, so even the rest of one is not waited for.
  for (;;) {
    int arrived = 0;
    MPI_Message handle{};
    MPI_Status status{};
    if (MPI_Improbe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &arrived, &handle, &status) != MPI_SUCCESS ||
        arrived == 0)
      break;
    int size = 0;
    MPI_Get_count(&status, MPI_BYTE, &size);
    auto receiving = std::make_unique<Receiving>();
    receiving->message.from = status.MPI_SOURCE;
    receiving->message.bytes.resize(static_cast<std::size_t>(std::max(size, 0)));
    if (MPI_Imrecv(receiving->message.bytes.data(), size, MPI_BYTE, &handle, &receiving->request) ==
        MPI_SUCCESS)
      receiving_.push_back(std::move(receiving));
  }
  for (auto it = receiving_.begin(); it != receiving_.end(); ++it) {
    int done = 0;
    const bool failed = MPI_Test(&(*it)->request, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS;
    if (!failed && done == 0) continue;
    std::unique_ptr<Receiving> receiving = std::move(*it);
    receiving_.erase(it);
    if (failed) return receive();
    return std::move(receiving->message);
  }
  if (!sending_.empty()) clear_sent();
  return {};
}

}  // namespace pafas
