// SPDX-License-Identifier: MIT
// Ranks as threads of one process: messages by queues, with losses, repetitions and deaths to order.
#pragma once

#include <atomic>
#include <deque>
#include <mutex>
#include <random>
#include <vector>

#include "pafas/message.h"
#include "pafas/transport.h"

namespace pafas::test {

class Network {
 public:
  struct Faults {
    double loss = 0, repetition = 0;  ///< shares of all messages
    unsigned seed = 1;
  };
  Network(int size, Faults faults)
      : boxes_(static_cast<std::size_t>(size)), faults_(faults), random_(faults.seed) {}
  explicit Network(int size) : Network(size, Faults{}) {}

  /// From now on the rank neither hears nor is heard.
  void kill(int rank) {
    const std::lock_guard lock(mutex_);
    boxes_[static_cast<std::size_t>(rank)].dead = true;
  }
  void revive(int rank) {
    const std::lock_guard lock(mutex_);
    boxes_[static_cast<std::size_t>(rank)].dead = false;
  }
  std::size_t messages() const { return messages_; }
  std::size_t largest_from_master() const { return largest_from_master_; }
  /// Pieces of the package that a rank has sent, lost ones included.
  std::size_t pieces_from(int rank) {
    const std::lock_guard lock(mutex_);
    return boxes_[static_cast<std::size_t>(rank)].pieces_sent;
  }

 private:
  friend class Loopback;
  struct Box {
    std::deque<Message> messages;
    bool dead = false;
    std::size_t pieces_sent = 0;
  };
  void send(int from, int to, std::string bytes) {
    const std::lock_guard lock(mutex_);
    if (boxes_[static_cast<std::size_t>(from)].dead || boxes_[static_cast<std::size_t>(to)].dead) return;
    ++messages_;
    if (kind_of(bytes) == Kind::kPiece) ++boxes_[static_cast<std::size_t>(from)].pieces_sent;
    if (from == 0) largest_from_master_ = std::max(largest_from_master_.load(), bytes.size());
    std::uniform_real_distribution<> draw(0, 1);
    if (draw(random_) < faults_.loss) return;
    std::deque<Message>& box = boxes_[static_cast<std::size_t>(to)].messages;
    if (draw(random_) < faults_.repetition) box.push_back({from, bytes});
    box.push_back({from, std::move(bytes)});
  }
  std::optional<Message> receive(int rank) {
    const std::lock_guard lock(mutex_);
    Box& box = boxes_[static_cast<std::size_t>(rank)];
    if (box.dead || box.messages.empty()) return {};
    Message message = std::move(box.messages.front());
    box.messages.pop_front();
    return message;
  }

  std::mutex mutex_;
  std::vector<Box> boxes_;
  Faults faults_;
  std::mt19937 random_;
  std::atomic<std::size_t> messages_{0}, largest_from_master_{0};
};

class Loopback final : public Transport {
 public:
  Loopback(Network& network, int rank) : network_(network), rank_(rank) {}
  int rank() const override { return rank_; }
  int size() const override { return static_cast<int>(network_.boxes_.size()); }
  void send(int to, std::string bytes) override { network_.send(rank_, to, std::move(bytes)); }
  std::optional<Message> receive() override { return network_.receive(rank_); }
  bool sent(int) override { return true; }

 private:
  Network& network_;
  int rank_;
};

}  // namespace pafas::test
