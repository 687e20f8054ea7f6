// SPDX-License-Identifier: MIT
// Messages by MPI, point to point, from the main thread only.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "pafas/transport.h"

namespace pafas {

/// MPI from its start to its end; one object per process.
class MpiTransport final : public Transport {
 public:
  /// Starts MPI.
  MpiTransport(int* argc, char*** argv);
  /// Ends MPI. Where ranks have died that may take for ever: after `kPatience` seconds the process leaves
  /// with the code of set_exit_code().
  ~MpiTransport() override;

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  void send(int to, std::string bytes) override;
  std::optional<Message> receive() override;
  bool sent(int to) override;
  void note_losses() override { patience_ = 1; }
  void set_exit_code(int code) { exit_code_ = code; }
  /// Ranks of this job on this machine, this one included, as the starter tells.
  int ranks_here() const { return ranks_here_; }

 private:
  struct Sending;
  struct Receiving;
  void clear_sent();

  unsigned patience_ = 10;  ///< seconds for the end of MPI
  int rank_ = 0, size_ = 1, ranks_here_ = 1, exit_code_ = 0;
  std::deque<std::unique_ptr<Sending>> sending_;
  std::deque<std::unique_ptr<Receiving>> receiving_;
};

}  // namespace pafas
