// SPDX-License-Identifier: MIT
#include "rayshade/schedule/granularity.h"

#include <algorithm>
#include <cmath>

namespace rayshade {
namespace {

/// Messages in which a worker would get its share if all went on as it is.
constexpr double kMessages = 4;
/// Longer messages save nothing, and are lost with the worker.
constexpr double kMostSeconds = 2;
/// What one message of the protocol holds.
constexpr int kMostBlocks = 150;
/// While nothing is known of costs.
constexpr int kFirstBlocks = 4;

}  // namespace

MessageSize message_size(const MessageQuestion& q) {
  const int threads = std::max(1, q.threads);
  int most = q.most_blocks > 0 ? std::min(q.most_blocks, kMostBlocks) : kMostBlocks;
  if (q.seconds_left <= 0) most = std::min(most, kFirstBlocks * threads);
  most = std::max(most, std::min(threads, kMostBlocks));
  const double part = q.share / kMessages;
  const double blocks = std::ceil(static_cast<double>(q.blocks_left) * part);
  MessageSize size;
  size.blocks = std::clamp(blocks < kMostBlocks ? static_cast<int>(blocks) : kMostBlocks,
                           std::min(threads, most), most);
  size.seconds =
      q.seconds_left > 0 ? std::min(kMostSeconds, q.seconds_left * part / (threads * q.speed)) : kMostSeconds;
  return size;
}

}  // namespace rayshade
