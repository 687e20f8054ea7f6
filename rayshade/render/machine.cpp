// SPDX-License-Identifier: MIT
// What this machine and this job allow.
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <string>
#include <thread>

#include "rayshade/render/renderer.h"

namespace rayshade {
namespace {

constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

/// The first number of a file; kUnlimited where there is none ("max", or no such file).
std::uint64_t number_in(const std::string& path) {
  std::ifstream in(path);
  std::uint64_t value = 0;
  return in >> value ? value : kUnlimited;
}

std::uint64_t memory_available() {
  std::ifstream in("/proc/meminfo");
  std::string key, unit;
  std::uint64_t kilobytes = 0;
  while (in >> key >> kilobytes) {
    std::getline(in, unit);
    if (key == "MemAvailable:") return kilobytes * 1024;
  }
  return kUnlimited;
}

/// CPUs granted by the quota of control group 2; 0 where there is none.
int quota_cpus() {
  std::ifstream in("/sys/fs/cgroup/cpu.max");
  std::string quota;
  double period = 0;
  if (!(in >> quota >> period) || quota == "max" || period <= 0) return 0;
  return std::max(1, static_cast<int>(std::lround(std::atof(quota.c_str()) / period)));
}

}  // namespace

std::uint64_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

std::uint64_t available_memory() {
  std::uint64_t bytes = memory_available();
  const std::uint64_t limit = number_in("/sys/fs/cgroup/memory.max");
  if (limit != kUnlimited) {
    const std::uint64_t used = number_in("/sys/fs/cgroup/memory.current");
    bytes = std::min(bytes, used != kUnlimited && used < limit ? limit - used : limit);
  }
  rlimit address{};
  if (getrlimit(RLIMIT_AS, &address) == 0 && address.rlim_cur != RLIM_INFINITY) {
    bytes = std::min<std::uint64_t>(bytes, address.rlim_cur);
  }
  return bytes;
}

int available_threads(int share) {
  int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) == 0) threads = std::max(1, CPU_COUNT(&set));
  // A process that is bound to some processors has them for itself; if it may use all, so may the others.
  const long online = sysconf(_SC_NPROCESSORS_ONLN);
  if (threads >= online) threads = std::max(1, threads / share);
  if (const int quota = quota_cpus(); quota > 0) threads = std::min(threads, std::max(1, quota / share));
  if (const char* slurm = std::getenv("SLURM_CPUS_PER_TASK")) {
    if (const int granted = std::atoi(slurm); granted > 0) threads = std::min(threads, granted);
  }
  return threads;
}

std::uint64_t estimate_picture_bytes(const RenderSettings& settings, std::size_t bytes_per_pixel) {
  return static_cast<std::uint64_t>(settings.window_width()) *
         static_cast<std::uint64_t>(settings.window_height()) * bytes_per_pixel;
}

}  // namespace rayshade
