// SPDX-License-Identifier: MIT
// Starts jobs of the built pafas under the mpirun of its MPI, and kills parts of them.
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/program/run.h"

namespace pafas::test {

using rayshade::testing_tools::Folder;
using rayshade::testing_tools::kTimeFactor;
using rayshade::testing_tools::Outcome;
using rayshade::testing_tools::read_file;
using rayshade::testing_tools::write_file;

inline std::string pafas_program() {
  const char* other = std::getenv("PAFAS_PROGRAM");
  return other ? other : std::string(BINARY_DIR) + "/bin/pafas";
}

/// A job that has been started; it is killed with the object if it still runs.
class Job {
 public:
  /// Runs `mpirun MPI_OPTIONS pafas ARGUMENTS` (words as a shell reads them) in `folder`.
  Job(const std::filesystem::path& folder, const std::string& mpi_options, const std::string& arguments)
      : folder_(folder) {
    const std::string command = "cd '" + folder.string() + "' && exec " + MPIRUN + " " + mpi_options + " '" +
                                pafas_program() + "' " + arguments + " </dev/null >.stdout 2>.stderr";
    process_ = fork();
    if (process_ == 0) {
      setpgid(0, 0);
      execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      _exit(127);
    }
  }
  ~Job() {
    if (!ended_) {
      for (const pid_t rank : ranks()) ::kill(rank, SIGKILL);
      ::kill(-process_, SIGKILL);
      waitpid(process_, nullptr, 0);
    }
  }
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  /// The processes of pafas, descendants of mpirun, that are alive, by rank.
  std::vector<pid_t> ranks() const {
    std::vector<pid_t> found = processes();
    std::sort(found.begin(), found.end(), [](pid_t a, pid_t b) { return rank_of(a) < rank_of(b); });
    return found;
  }
  /// Waits until so many ranks run. Returns them.
  std::vector<pid_t> wait_for_ranks(std::size_t count) const {
    for (int i = 0; i < 30'000 * kTimeFactor; ++i) {
      if (const auto found = ranks(); found.size() >= count) return found;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return {};
  }
  void signal(int number) const { ::kill(process_, number); }
  bool running() {
    if (!ended_) ended_ = waitpid(process_, &status_, WNOHANG) == process_;
    return !ended_;
  }
  /// Waits for the end; a job that takes longer than `seconds` times kTimeFactor is killed (status 137).
  Outcome wait(int seconds = 60) {
    for (int i = 0; i < seconds * kTimeFactor * 200 && running(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (running()) {
      for (const pid_t rank : ranks()) ::kill(rank, SIGKILL);
      ::kill(-process_, SIGKILL);
      waitpid(process_, &status_, 0);
      ended_ = true;
    }
    Outcome out;
    out.status = WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
    out.out = read_file(folder_ / ".stdout");
    out.err = read_file(folder_ / ".stderr");
    return out;
  }

 private:
  std::vector<pid_t> processes() const {
    std::vector<pid_t> found;
    for (const pid_t child : children_of(process_)) {
      if (is_pafas(child))
        found.push_back(child);
      else
        for (const pid_t grandchild : children_of(child))
          if (is_pafas(grandchild)) found.push_back(grandchild);
    }
    return found;
  }
  static int rank_of(pid_t process) {
    std::ifstream in("/proc/" + std::to_string(process) + "/environ");
    for (std::string word; std::getline(in, word, '\0');)
      for (const std::string name : {"OMPI_COMM_WORLD_RANK=", "PMI_RANK="})
        if (word.starts_with(name)) return std::atoi(word.c_str() + name.size());
    return 1 << 30;
  }
  static std::vector<pid_t> children_of(pid_t process) {
    std::ifstream in("/proc/" + std::to_string(process) + "/task/" + std::to_string(process) + "/children");
    std::vector<pid_t> out;
    for (pid_t child = 0; in >> child;) out.push_back(child);
    return out;
  }
  static bool is_pafas(pid_t process) {
    std::ifstream in("/proc/" + std::to_string(process) + "/comm");
    std::string name;
    return static_cast<bool>(std::getline(in, name)) && name == "pafas";
  }

  std::filesystem::path folder_;
  pid_t process_ = 0;
  int status_ = 0;
  bool ended_ = false;
};

/// Options for so many ranks on this machine.
inline std::string on_ranks(int ranks, const std::string& more = {}) {
  return std::string(MPI_OPTIONS) + " " + more + " -n " + std::to_string(ranks);
}

}  // namespace pafas::test
