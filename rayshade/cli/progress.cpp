// SPDX-License-Identifier: MIT
#include "rayshade/cli/progress.h"

#include <fmt/format.h>

#include <cmath>

namespace rayshade {
namespace {

double seconds_between(std::chrono::steady_clock::time_point a, std::chrono::steady_clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

}  // namespace

std::string duration_text(double seconds) {
  if (seconds < 60) return fmt::format("{:.1f} s", seconds);
  const auto whole = std::llround(seconds);
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

void Progress::start(const std::string& what) {
  what_ = what;
  started_ = last_ = Clock::now();
  last_tenth_ = 0;
  last_row_ = 0;
}

std::string Progress::line(const FrameProgress& now) const {
  const double elapsed = seconds_between(started_, Clock::now());
  const double done = static_cast<double>(now.pixels_done), all = static_cast<double>(now.pixels);
  // What was there before counts as done, but says nothing of how fast this run is.
  const double rendered = static_cast<double>(now.pixels_done - now.pixels_before);
  std::string out =
      fmt::format("{}: {:3.0f} %, {}", what_, all > 0 ? 100 * done / all : 100, duration_text(elapsed));
  if (rendered > 0) out += fmt::format(", {:.3g} kpixel/s", rendered / elapsed / 1000);
  // A guess from the first blocks would be a lie.
  if (rendered > 0.02 * (all - static_cast<double>(now.pixels_before)) && done < all)
    out += fmt::format(", {} left", duration_text(elapsed * (all - done) / rendered));
  return out;
}

void Progress::update(const FrameProgress& now) {
  if (style_.silent) return;
  const Clock::time_point time = Clock::now();
  if (style_.every_rows > 0) {
    // Lines for the rows whose screen number is a multiple, as far as the picture is complete from the top.
    for (; last_row_ < now.rows_done; ++last_row_) {
      const std::int64_t row = style_.first_row + last_row_;
      if (row % style_.every_rows == 0) {
        fmt::print(out_, "Finished line {} ({:.1f} s)\n", row, seconds_between(started_, time));
      }
    }
    std::fflush(out_);
    return;
  }
  if (style_.live) {
    // The longer the job, the rarer the refresh.
    const double pause = std::min(5.0, 0.2 + 0.01 * seconds_between(started_, time));
    if (seconds_between(last_, time) < pause) return;
    last_ = time;
    fmt::print(out_, "\r{}\033[K", line(now));
    std::fflush(out_);
    live_line_ = true;
    return;
  }
  const int tenth = now.pixels > 0 ? static_cast<int>(10 * now.pixels_done / now.pixels) : 10;
  const bool short_job = seconds_between(started_, time) < 2;
  if ((tenth > last_tenth_ && !short_job && seconds_between(last_, time) > 1) ||
      seconds_between(last_, time) >= 60) {
    last_tenth_ = tenth;
    last_ = time;
    print_now(now);
  }
}

void Progress::print_now(const FrameProgress& now) {
  finish();
  fmt::print(out_, "{}\n", line(now));
  std::fflush(out_);
}

void Progress::finish() {
  if (live_line_) fmt::print(out_, "\r\033[K");
  live_line_ = false;
  std::fflush(out_);
}

}  // namespace rayshade
