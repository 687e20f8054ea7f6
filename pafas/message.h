// SPDX-License-Identifier: MIT
// What ranks say to each other: every kind of message, and what it holds.
//
//   slave                              master
//   Hello: who I am             ->
//                               <-     Plan: the command line and how long the package of files is (or:
//                               leave)
//   Pull: pieces from..to       ->
//                               <-     Piece, one after the other, small enough to be sent at once
//   (to and from another slave where the plan names one: relay.h)
//   Ready: I have compiled it   ->
//                               <-     Work: blocks of a frame
//   Results: blocks, and whether
//       more are wanted         ->
//   Alive, every second         ->
//                               <-     Heard
//                               <-     Leave: the picture is there, or never will be
//   Report: what I did          ->
//   Failed, at any time: why    ->
//
// The master, like a slave that passes the package on, only ever answers, and answers with little, so that a
// slave that has died leaves nothing behind that would have to be waited for. Every message may be lost or
// come twice without harm: blocks are leased, pieces are asked for again, and the first result of a block
// counts.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pafas/archive.h"
#include "pafas/rank_report.h"
#include "rayshade/render/frame_crew.h"
#include "rayshade/schedule/block_grid.h"

namespace pafas {

/// Changes whenever a message does.
inline constexpr std::uint32_t kProtocol = 2;

enum class Kind : std::uint8_t {
  kHello,
  kPlan,
  kPull,
  kPiece,
  kReady,
  kWork,
  kResults,
  kAlive,
  kHeard,
  kLeave,
  kReport,
  kFailed
};

struct Hello {
  static constexpr Kind kKind = Kind::kHello;
  std::uint32_t protocol = kProtocol;
  std::string version;  ///< of the program
  std::string host;
  std::int64_t process = 0;
};

struct Plan {
  static constexpr Kind kKind = Kind::kPlan;
  std::string refusal;  ///< not empty: why this slave cannot take part
  std::vector<std::string> arguments;
  std::string scene_hash;
  rayshade::PictureFormat format;
  std::uint64_t package_bytes = 0;  ///< compressed files: Package
  std::int32_t source = 0;          ///< the rank to pull it from
};

struct Pull {
  static constexpr Kind kKind = Kind::kPull;
  std::uint64_t first = 0, count = 0;  ///< pieces
};

struct Piece {
  static constexpr Kind kKind = Kind::kPiece;
  /// Together with its head within what every transport of Open MPI and MPICH sends at once.
  static constexpr std::uint64_t kBytes = 3900;
  std::uint64_t number = 0;
  std::string bytes;
};

struct Ready {
  static constexpr Kind kKind = Kind::kReady;
  std::string scene_hash;
  std::uint32_t threads = 1;
  double seconds = 0;  ///< to read and compile the scene
};

struct Work {
  static constexpr Kind kKind = Kind::kWork;
  std::int32_t frame = 0;
  std::vector<rayshade::Block> blocks;  ///< at most rayshade::kMostBlocksPerMessage
};

struct Result {
  std::int64_t number = 0;  ///< of the block
  double begin = 0;         ///< seconds on the slave's clock
  double end = 0;
  double cpu_seconds = 0;
  std::string record;  ///< frame and pixels, as a journal has them: rayshade/image/block_record.h
};

struct Results {
  static constexpr Kind kKind = Kind::kResults;
  std::int32_t frame = 0;
  bool wants_work = false;
  double sent = 0;  ///< seconds on the slave's clock
  std::vector<Result> results;
};

struct Alive {
  static constexpr Kind kKind = Kind::kAlive;
  double sent = 0;
};

struct Heard {
  static constexpr Kind kKind = Kind::kHeard;
};

struct Leave {
  static constexpr Kind kKind = Kind::kLeave;
  bool losses = false;  ///< ranks have died: MPI may not end by itself
};

struct Report {
  static constexpr Kind kKind = Kind::kReport;
  RankReport report;
};

struct Failed {
  static constexpr Kind kKind = Kind::kFailed;
  std::string text;
};

template <class Archive>
void fields(Archive& a, Hello& m) {
  a(m.protocol, m.version, m.host, m.process);
}
template <class Archive>
void fields(Archive& a, Plan& m) {
  a(m.refusal, m.arguments, m.scene_hash, m.format.storage, m.format.encoding.gamma, m.format.encoding.srgb,
    m.format.layers, m.package_bytes, m.source);
}
template <class Archive>
void fields(Archive& a, Pull& m) {
  a(m.first, m.count);
}
template <class Archive>
void fields(Archive& a, Piece& m) {
  a(m.number, m.bytes);
}
template <class Archive>
void fields(Archive& a, Ready& m) {
  a(m.scene_hash, m.threads, m.seconds);
}
template <class Archive>
void fields(Archive& a, Work& m) {
  a(m.frame, m.blocks);
}
template <class Archive>
void fields(Archive& a, Result& m) {
  a(m.number, m.begin, m.end, m.cpu_seconds, m.record);
}
template <class Archive>
void fields(Archive& a, Results& m) {
  a(m.frame, m.wants_work, m.sent, m.results);
}
template <class Archive>
void fields(Archive& a, Alive& m) {
  a(m.sent);
}
template <class Archive>
void fields(Archive&, Heard&) {}
template <class Archive>
void fields(Archive& a, Leave& m) {
  a(m.losses);
}
template <class Archive>
void fields(Archive& a, Report& m) {
  a(m.report);
}
template <class Archive>
void fields(Archive& a, Failed& m) {
  a(m.text);
}

/// The bytes of a message: its kind, then its fields.
template <class M>
std::string pack(const M& message) {
  ArchiveWriter writer;
  writer(M::kKind, message);
  return writer.take();
}

/// The kind of a message. Throws ArchiveError for none.
inline Kind kind_of(std::string_view bytes) {
  if (bytes.empty() || static_cast<std::uint8_t>(bytes[0]) > static_cast<std::uint8_t>(Kind::kFailed))
    throw ArchiveError("a message of an unknown kind");
  return static_cast<Kind>(bytes[0]);
}

/// The fields of a message whose kind is known. Throws ArchiveError.
template <class M>
M unpack(std::string_view bytes) {
  return from_bytes<M>(bytes.substr(1));
}

}  // namespace pafas

namespace rayshade {

template <class Archive>
void fields(Archive& a, Block& b) {
  a(b.number, b.x, b.y, b.width, b.height);
}

}  // namespace rayshade
