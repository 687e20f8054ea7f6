// SPDX-License-Identifier: MIT
// How much work a message holds, and when a worker asks for more.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rayshade {

/// What one message of the protocol holds and is still small enough to be sent at once.
inline constexpr int kMostBlocksPerMessage = 150;

/// So many blocks at most, and no more than go on being expected to take so many seconds of the worker; one
/// block for each of its threads always.
struct MessageSize {
  int blocks = 1;
  double seconds = 0;
};

struct MessageQuestion {
  std::int64_t blocks_left = 0;  ///< not yet given to anybody
  double seconds_left = 0;       ///< expected for them on a thread of speed 1; 0: nothing is known
  double share = 1;              ///< of the worker's speed in that of all
  int threads = 1;               ///< of the worker
  double speed = 1;              ///< of one of them
  int workers = 1;               ///< in all
  int most_blocks = 0;           ///< the user's limit; 0: none
};

/// A part of the worker's share of all that is left: many blocks in the beginning, fewer toward the end; but
/// as far as is known enough for as long as the master needs to answer all the others once.
MessageSize message_size(const MessageQuestion& question);

/// Whether a worker returns its results and asks for more: as soon as no block waits for one of its threads,
/// so that more work arrives while the last blocks are rendered.
constexpr bool asks_for_more(std::size_t unfinished, std::size_t threads) { return unfinished <= threads; }

}  // namespace rayshade
