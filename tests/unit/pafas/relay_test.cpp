// SPDX-License-Identifier: MIT
// The tree that passes the package on, and the answers to those who pull.
#include "pafas/relay.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/unit/pafas/loopback.h"

namespace pafas::test {
namespace {

TEST(RelayTest, TheTreeIsShallowAndNarrow) {
  std::map<int, int> below;
  for (int place = 0; place < 100'000; ++place) {
    ASSERT_LT(place_above(place), place);
    ++below[place_above(place)];
    int depth = 0;
    for (int at = place; at >= 0; at = place_above(at)) ++depth;
    ASSERT_LE(depth, 9) << place;
  }
  for (const auto& [place, count] : below) {
    EXPECT_GE(place, -1);
    EXPECT_LE(count, kFanOut) << place;
  }
}

std::vector<std::uint64_t> received(Loopback& transport, const std::string& package) {
  std::vector<std::uint64_t> numbers;
  while (const std::optional<Message> message = transport.receive()) {
    const auto piece = unpack<Piece>(message->bytes);
    EXPECT_EQ(piece.bytes, package.substr(piece.number * Piece::kBytes, Piece::kBytes));
    numbers.push_back(piece.number);
  }
  return numbers;
}

TEST(RelayTest, PiecesComeAsTheyAreThere) {
  Network network(3);
  Loopback source(network, 0), one(network, 1), two(network, 2);
  std::string package;
  for (std::size_t i = 0; i < 5 * Piece::kBytes + 7; ++i) package += static_cast<char>(i * i % 251);
  ASSERT_EQ(pieces_of(package.size()), 6u);
  using Numbers = std::vector<std::uint64_t>;
  PieceServer server;
  server.ask(1, {0, 4});
  server.ask(2, {2, 100});
  server.serve(source, package, 0);
  EXPECT_EQ(received(one, package), Numbers{});
  server.serve(source, package, 3);
  EXPECT_EQ(received(one, package), (Numbers{0, 1, 2}));
  EXPECT_EQ(received(two, package), (Numbers{2}));
  EXPECT_TRUE(server.waits());
  server.serve(source, package, 6);
  EXPECT_EQ(received(one, package), (Numbers{3}));
  EXPECT_EQ(received(two, package), (Numbers{3, 4, 5}));
  // Once more from where it was lost.
  server.ask(2, {4, 1});
  server.serve(source, package, 6);
  EXPECT_EQ(received(two, package), (Numbers{4}));
}

TEST(RelayTest, AbsurdPullsDoNoHarm) {
  Network network(2);
  Loopback source(network, 0), one(network, 1);
  const std::string package(10, 'x');
  PieceServer server;
  for (const Pull& pull : {Pull{~std::uint64_t{0}, 5}, Pull{~std::uint64_t{0} - 3, ~std::uint64_t{0}},
                           Pull{1, 5}, Pull{0, ~std::uint64_t{0}}}) {
    server.ask(1, pull);
    server.serve(source, package, 1);
  }
  EXPECT_EQ(received(one, package), std::vector<std::uint64_t>{0});
}

}  // namespace
}  // namespace pafas::test
