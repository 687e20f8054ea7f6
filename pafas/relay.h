// SPDX-License-Identifier: MIT
// How the scene gets to many ranks: each passes its package on to some others.
//
// Slaves stand in a tree, in the order in which the master greets them; the first kFanOut pull the package
// from the master, every other from the one above it, piece by piece, while that one still pulls it from
// above. So the time grows with the depth of the tree and not with the number of ranks. Everybody pulls:
// nothing is sent that nobody asked for, and pieces are small enough to be sent at once, so that neither a
// dead child nor a dead parent leaves anything behind that would have to be waited for. Who gets nothing from
// above for a while (Timing::relay: the one above is dead, hangs, or has let the package go) pulls the rest
// from the master, as does who has to be greeted twice. At worst all do, and the scene takes as long as if
// there were no tree.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "pafas/message.h"
#include "pafas/transport.h"

namespace pafas {

/// Ranks that pull from one.
inline constexpr int kFanOut = 4;

/// The place in the tree above `place` (from 0, in the order of greeting); negative: the master.
constexpr int place_above(int place) { return place / kFanOut - 1; }

/// Pieces of a package of so many bytes.
constexpr std::uint64_t pieces_of(std::uint64_t bytes) { return (bytes + Piece::kBytes - 1) / Piece::kBytes; }

/// Answers those who pull: with the pieces that are there, and later with those that were still to come.
class PieceServer {
 public:
  /// `rank` asks; what it asked for before no longer counts.
  void ask(int rank, const Pull& pull);
  /// Sends the pieces that somebody waits for and that are there: `package` has those below `present`.
  void serve(Transport& transport, std::string_view package, std::uint64_t present);
  bool waits() const { return !asked_.empty(); }

 private:
  /// At most so many pieces are sent for one pull.
  static constexpr std::uint64_t kMostPieces = 1024;
  struct Asked {
    int rank;
    std::uint64_t next, end;
  };
  std::vector<Asked> asked_;
};

}  // namespace pafas
