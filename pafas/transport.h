// SPDX-License-Identifier: MIT
// Messages between ranks. Nothing here waits: a rank that has died must not hold up another (rule 15).
#pragma once

#include <optional>
#include <string>

namespace pafas {

struct Message {
  int from = 0;
  std::string bytes;
};

class Transport {
 public:
  virtual ~Transport() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;
  /// Begins to send; the bytes are kept as long as that takes. What is sent to a dead rank is lost.
  virtual void send(int to, std::string bytes) = 0;
  /// A message that has arrived as a whole, if there is one. Messages of one rank may overtake each other.
  virtual std::optional<Message> receive() = 0;
  /// Whether all that was sent to `to` has left this rank.
  virtual bool sent(int to) = 0;
  /// Ranks have died: the end is not to be waited for long.
  virtual void note_losses() {}
};

}  // namespace pafas
