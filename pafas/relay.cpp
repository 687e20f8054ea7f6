// SPDX-License-Identifier: MIT
#include "pafas/relay.h"

#include <algorithm>
#include <string>

namespace pafas {

void PieceServer::ask(int rank, const Pull& pull) {
  std::erase_if(asked_, [&](const Asked& asked) { return asked.rank == rank; });
  // No number of pieces is so large that the sum would wrap.
  if (pull.first > pieces_of(~std::uint64_t{0} / 2)) return;
  asked_.push_back({rank, pull.first, pull.first + std::min(pull.count, kMostPieces)});
}

void PieceServer::serve(Transport& transport, std::string_view package, std::uint64_t present) {
  const std::uint64_t all = pieces_of(package.size());
  for (Asked& asked : asked_) {
    for (; asked.next < std::min({asked.end, present, all}); ++asked.next) {
      const std::string_view bytes =
          package.substr(static_cast<std::size_t>(asked.next * Piece::kBytes), Piece::kBytes);
      transport.send(asked.rank, pack(Piece{asked.next, std::string(bytes)}));
    }
  }
  std::erase_if(asked_, [](const Asked& asked) { return asked.next >= asked.end; });
}

}  // namespace pafas
