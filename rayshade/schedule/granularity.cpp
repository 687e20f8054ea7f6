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
/// Of the master, for an answer; with less work in a message than all workers' answers take, they would
/// queue.
constexpr double kAnswerSeconds = 20e-6;
/// While nothing is known of costs.
constexpr int kFirstBlocks = 4;

}  // namespace

MessageSize message_size(const MessageQuestion& q) {
  const int threads = std::max(1, q.threads);
  int most = q.most_blocks > 0 ? std::min(q.most_blocks, kMostBlocksPerMessage) : kMostBlocksPerMessage;
  if (q.seconds_left <= 0) most = std::min(most, kFirstBlocks * threads);
  most = std::max(most, std::min(threads, kMostBlocksPerMessage));
  const double part = q.share / kMessages;
  double blocks = std::ceil(static_cast<double>(q.blocks_left) * part);
  double seconds = kMostSeconds;
  if (q.seconds_left > 0 && q.blocks_left > 0) {
    const double least = std::min(kMostSeconds, kAnswerSeconds * q.workers);
    const double block_seconds = q.seconds_left / static_cast<double>(q.blocks_left) / (threads * q.speed);
    blocks = std::max(blocks, std::floor(least / block_seconds));
    seconds = std::clamp(q.seconds_left * part / (threads * q.speed), least, kMostSeconds);
  }
  MessageSize size;
  size.blocks = static_cast<int>(std::clamp(blocks, double(std::min(threads, most)), double(most)));
  size.seconds = seconds;
  return size;
}

}  // namespace rayshade
