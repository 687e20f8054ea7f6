// SPDX-License-Identifier: MIT
// Progress for people and for logs: on a terminal one live line; elsewhere sparse plain lines without
// carriage returns. Everything goes to the report stream, never to standard output.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>

#include "rayshade/render/renderer.h"

namespace rayshade {

/// "1:02:03" or "4.2 s".
std::string duration_text(double seconds);

class Progress {
 public:
  struct Style {
    bool silent = false;  ///< -q
    bool live = false;    ///< the stream is a terminal
    int every_rows = 0;   ///< -F: a plain line every so many rows; 0: by time and percent
    int first_row = 0;    ///< screen number of the window's first row
  };
  Progress(std::FILE* out, Style style) : out_(out), style_(style) {}

  void start(const std::string& what);
  void update(const FrameProgress& now);
  /// One line at once, whatever the style (USR1).
  void print_now(const FrameProgress& now);
  /// Removes the live line.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  std::string line(const FrameProgress& now) const;

  std::FILE* out_;
  Style style_;
  std::string what_;
  Clock::time_point started_ = Clock::now(), last_ = Clock::now();
  int last_tenth_ = 0;
  std::int64_t last_row_ = 0;
  bool live_line_ = false;
};

}  // namespace rayshade
