// SPDX-License-Identifier: MIT
// Signals as requests that the rendering polls: INT and TERM stop (a second INT leaves at once), HUP asks for
// the partial picture, USR1 for a progress line and the partial picture.
#pragma once

#include <atomic>

namespace rayshade {

class SignalRequests {
 public:
  /// Installs the handlers; one object at a time. The destructor restores what was there.
  SignalRequests();
  ~SignalRequests();
  SignalRequests(const SignalRequests&) = delete;
  SignalRequests& operator=(const SignalRequests&) = delete;

  const std::atomic<bool>& stop() const;
  /// True once per request.
  bool take_save();
  bool take_progress();
};

}  // namespace rayshade
