// SPDX-License-Identifier: MIT
#include "rayshade/cli/signals.h"

#include <unistd.h>

#include <csignal>

#include "rayshade/cli/program.h"

namespace rayshade {
namespace {

// Signal handlers have no argument of ours: this is the one place where a process has such a thing.
std::atomic<bool> g_stop{false};
std::atomic<bool> g_save{false};
std::atomic<bool> g_progress{false};
static_assert(std::atomic<bool>::is_always_lock_free);

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP, SIGUSR1};
struct sigaction g_previous[4];

void handle(int signal) {
  switch (signal) {
    case SIGINT:
    case SIGTERM:
      if (g_stop.exchange(true) && signal == SIGINT) _exit(kStopped);
      break;
    case SIGHUP:
      g_save = true;
      break;
    case SIGUSR1:
      g_progress = true;
      g_save = true;
      break;
    default:
      break;
  }
}

}  // namespace

SignalRequests::SignalRequests() {
  g_stop = g_save = g_progress = false;
  struct sigaction action {};
  action.sa_handler = handle;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (int i = 0; i < 4; ++i) sigaction(kSignals[i], &action, &g_previous[i]);
}

SignalRequests::~SignalRequests() {
  for (int i = 0; i < 4; ++i) sigaction(kSignals[i], &g_previous[i], nullptr);
}

const std::atomic<bool>& SignalRequests::stop() const { return g_stop; }
bool SignalRequests::take_save() { return g_save.exchange(false); }
bool SignalRequests::take_progress() { return g_progress.exchange(false); }

}  // namespace rayshade
