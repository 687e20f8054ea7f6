// SPDX-License-Identifier: MIT
#include "fas/beam_tree.h"

#include <bit>
#include <chrono>
#include <cmath>
#include <limits>
#include <new>

namespace fas {
namespace {

using Clock = std::chrono::steady_clock;

/// Cells are not halved further than this in all.
constexpr int kDeepest = 60;
constexpr int kMostStalls = 4;
/// A leaf is split when its wasted work exceeds this many times the cost of a split.
constexpr double kPatience = 16;
/// Nanoseconds to test a node, and for an exact test.
constexpr double kBoxCost = 8, kTestCost = 12;
/// Nanoseconds of a split in units of Tuner::per_candidate(): ten beams are tested against every lane.
constexpr double kSplitCandidates = 24;
/// Directions are grown by more than what computing and comparing them rounds.
constexpr double kDirectionPad = 0x1p-40;
/// Beyond this share of the budget five-dimensional trees stop growing: flat ones are worth more.
constexpr double kShare = 0.5;

constexpr std::uintptr_t kLeafTag = 2, kPairTag = 4, kTags = 15;
constexpr std::size_t kAlignment = 64;

double half_area(const Hierarchy::Node& node, int lane) {
  double size[3];
  for (int axis = 0; axis < 3; ++axis)
    size[axis] =
        static_cast<double>(node.planes[1][axis][lane]) - static_cast<double>(node.planes[0][axis][lane]);
  return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
}

}  // namespace

struct alignas(16) BeamTree::Pair {
  std::atomic<std::uintptr_t> child[2];
  std::uint8_t dimension = 0, shift = 0;
};

/// A cut in the making.
struct BeamTree::Lanes {
  static constexpr int kMost = 2 * kLanes;
  Hierarchy::Node nodes[kMost / Hierarchy::kWidth];
  int count = 0;
  std::uint8_t stalls = 0, depth = 0;
  bool final = false;

  Hierarchy::Node& node(int i) { return nodes[i / Hierarchy::kWidth]; }
  void set(int i, const Hierarchy::Node& from, int lane) {
    Hierarchy::Node& to = node(i);
    const int at = i % Hierarchy::kWidth;
    for (int axis = 0; axis < 3; ++axis) {
      to.planes[0][axis][at] = from.planes[0][axis][lane];
      to.planes[1][axis][at] = from.planes[1][axis][lane];
    }
    to.child[at] = from.child[lane];
    to.opacity[at] = from.opacity[lane];
  }
  void add(const Hierarchy::Node& from, std::uint32_t met) {
    for (; met != 0; met &= met - 1) set(count++, from, std::countr_zero(met));
  }
  /// Opens the largest subtrees while there is room for what the beam meets of them.
  void open(const Hierarchy& hierarchy, const Beam& beam) {
    for (;;) {
      int largest = -1;
      double most = -1;
      for (int i = 0; i < count; ++i) {
        const int lane = i % Hierarchy::kWidth;
        if ((node(i).child[lane] & Hierarchy::kLeafBit) != 0) continue;
        if (const double area = half_area(node(i), lane); area > most) most = area, largest = i;
      }
      if (largest < 0) return;
      const Hierarchy::Node& below = hierarchy.nodes()[node(largest).child[largest % Hierarchy::kWidth]];
      const std::uint32_t met = beam.meets(below);
      if (count - 1 + std::popcount(met) > kLanes) return;
      --count;
      if (largest != count) {
        const Hierarchy::Node last = node(count);
        set(largest, last, count % Hierarchy::kWidth);
      }
      add(below, met);
    }
  }
  bool only_primitives() {
    for (int i = 0; i < count; ++i)
      if ((node(i).child[i % Hierarchy::kWidth] & Hierarchy::kLeafBit) == 0) return false;
    return true;
  }
};

BeamTree::BeamTree(const Hierarchy& hierarchy, const Bounds& origins, double condition, Pool& pool,
                   Tuner& tuner, std::size_t number, Split split)
    : hierarchy_(hierarchy), pool_(pool), tuner_(tuner), number_(number), split_(split) {
  // As for views: origins may be 16 times as far away as anything else, 64 units of rounding for the exact
  // test and as many for the ray being moved, and a great deal more.
  double size = 0x1p-400;
  for (std::size_t i = 0; i < 3; ++i) {
    size = std::max({size, std::fabs(origins.lo[i]), std::fabs(origins.hi[i]),
                     std::fabs(hierarchy.bounds().lo[i]), std::fabs(hierarchy.bounds().hi[i])});
  }
  reach_ = 16 * size;
  slack_ = 1024 * std::numeric_limits<double>::epsilon() * condition * reach_;
  for (std::size_t i = 0; i < 3; ++i) {
    origins_.lo[i] = origins.lo[i] - slack_;
    origins_.hi[i] = origins.hi[i] + slack_;
    const double extent = origins_.hi[i] - origins_.lo[i];
    // Halving what is hardly more than the slack would tell nothing apart.
    const bool flat = !(extent > 1024 * slack_);
    unit_[i] = flat ? 0 : std::ldexp(extent, -kBits);
    scale_[i] = flat ? 0 : std::ldexp(1 / extent, kBits);
  }
  for (std::size_t face = 0; face < 6; ++face)
    roots_[face].store(reinterpret_cast<std::uintptr_t>(&whole_[face]) | kLeafTag, std::memory_order_relaxed);
}

bool BeamTree::place(const double* origin, const double* direction, Query& out) const {
  constexpr double kUnits = static_cast<double>(1u << kBits);
  out.face = face_of(direction);
  const auto k = static_cast<std::size_t>(out.face >> 1), i = k == 2 ? 0 : k + 1, j = i == 2 ? 0 : i + 1;
  const double inverse = 1 / std::fabs(direction[k]);
  const auto coordinate = [](double x) {
    return x < kUnits - 1 ? (x > 0 ? static_cast<std::uint32_t>(x) : 0u) : (1u << kBits) - 1;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(origin[axis] >= origins_.lo[axis] && origin[axis] <= origins_.hi[axis])) return false;
    out.at[axis] = coordinate((origin[axis] - origins_.lo[axis]) * scale_[axis]);
  }
  const double u = direction[i] * inverse, v = direction[j] * inverse;
  if (!(std::fabs(u) <= 1 + 0x1p-40 && std::fabs(v) <= 1 + 0x1p-40)) return false;  // no direction at all
  out.at[3] = coordinate((u + 1) * (kUnits / 2));
  out.at[4] = coordinate((v + 1) * (kUnits / 2));
  return true;
}

bool BeamTree::enter(const double* origin, const double* direction, Query& out) const {
  double entry = 0, exit = std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(std::fabs(origin[axis]) <= reach_)) return false;
    // A quarter of the slack inside, so that rounding leaves the point within.
    const double a = origins_.lo[axis] + 0.25 * slack_ - origin[axis],
                 b = origins_.hi[axis] - 0.25 * slack_ - origin[axis];
    const double d = direction[axis];
    if (a <= 0 && b >= 0) {
      if (d == 0) continue;
    } else if (!(std::fabs(d) > 0)) {
      return false;
    }
    const double inverse = 1 / d;
    entry = std::max(entry, (d > 0 ? a : b) * inverse);
    exit = std::min(exit, (d > 0 ? b : a) * inverse);
  }
  if (!(entry <= exit)) return false;
  if (entry == 0) return place(origin, direction, out);
  const double start[3] = {origin[0] + entry * direction[0], origin[1] + entry * direction[1],
                           origin[2] + entry * direction[2]};
  return place(start, direction, out);
}

Beam BeamTree::beam_of(int face, const Cell& cell) const {
  Beam beam;
  beam.face = face;
  // A coordinate is cut off to whole units, and has errors far below one.
  constexpr double kPad = 0x1p-10;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double lo = origins_.lo[axis] - hierarchy_.center()[axis], unit = unit_[axis];
    if (unit == 0) {
      beam.origins.lo[axis] = lo - slack_;
      beam.origins.hi[axis] = origins_.hi[axis] - hierarchy_.center()[axis] + slack_;
      continue;
    }
    const double size = std::ldexp(unit, kBits - cell.bits[axis]);
    beam.origins.lo[axis] = lo + (cell.at[axis] - kPad) * unit - slack_;
    beam.origins.hi[axis] = lo + (cell.at[axis] + kPad) * unit + size + slack_;
  }
  const auto direction = [&](std::size_t dimension, double& least, double& most) {
    least = std::ldexp(static_cast<double>(cell.at[dimension]), 1 - kBits) - 1 - kDirectionPad;
    most = least + std::ldexp(2.0, -cell.bits[dimension]) + 4 * kDirectionPad;
  };
  direction(3, beam.u0, beam.u1);
  direction(4, beam.v0, beam.v1);
  return beam;
}

const BeamLeaf& BeamTree::find(const Query& query, BeamCache& cache) const {
  ++cache.counts.rays;
  if (cache.face == query.face) {
    std::uint32_t apart = 0;
    for (std::size_t i = 0; i < kDimensions; ++i) apart |= (query.at[i] ^ cache.at[i]) >> cache.shift[i];
    if (apart == 0) {
      ++cache.counts.cached_leaf;
      return *cache.leaf;
    }
  }
  std::uintptr_t now = roots_[static_cast<std::size_t>(query.face)].load(std::memory_order_acquire);
  cache.shift.fill(kBits);
  while ((now & kTags) == kPairTag) {
    const auto* pair = reinterpret_cast<const Pair*>(now & ~kTags);
    cache.shift[pair->dimension] = pair->shift;
    now = pair->child[query.at[pair->dimension] >> pair->shift & 1].load(std::memory_order_acquire);
  }
  cache.leaf = reinterpret_cast<const BeamLeaf*>(now & ~kTags);
  cache.face = query.face;
  cache.at = query.at;
  return *cache.leaf;
}

void BeamTree::charge(const Query& query, ThreadState& state, BeamCache& cache, const BeamLeaf& leaf,
                      std::uint32_t box_tests, std::uint32_t tests, bool hit) {
  cache.counts.blocks += box_tests;
  cache.counts.tests += tests;
  cache.counts.hits += hit;
  if (leaf.final) return;
  const double wasted =
      kBoxCost * box_tests + kTestCost * (tests - std::min<std::uint32_t>(tests, hit)) - kBoxCost;
  auto& mutable_leaf = const_cast<BeamLeaf&>(leaf);  // two members of it are
  const float sum =
      mutable_leaf.work.load(std::memory_order_relaxed) + static_cast<float>(std::max(0.0, wasted));
  mutable_leaf.work.store(sum, std::memory_order_relaxed);
  const double price = kPatience * kSplitCandidates * tuner_.per_candidate() * (1 << leaf.stalls);
  if (split_ != Split::kAlways && !(static_cast<double>(sum) > price)) return;
  if (pool_.exhausted() || static_cast<double>(pool_.used()) > kShare * static_cast<double>(pool_.budget()))
    return;
  if (mutable_leaf.splitting.exchange(1, std::memory_order_acq_rel) != 0) return;

  // The way to the leaf, and its cell.
  std::atomic<std::uintptr_t>* link = &roots_[static_cast<std::size_t>(query.face)];
  Cell cell;
  for (;;) {
    const std::uintptr_t now = link->load(std::memory_order_acquire);
    if ((now & kTags) == kLeafTag) {
      if (reinterpret_cast<const BeamLeaf*>(now & ~kTags) != &leaf) return;
      break;
    }
    auto* pair = reinterpret_cast<Pair*>(now & ~kTags);
    const std::uint32_t bit = query.at[pair->dimension] >> pair->shift & 1;
    cell.at[pair->dimension] |= bit << pair->shift;
    ++cell.bits[pair->dimension];
    link = &pair->child[bit];
  }
  const Clock::time_point start = Clock::now();
  const std::uintptr_t pair = split(leaf, query.face, cell, state, cache.counts);
  cache.counts.nanoseconds += static_cast<std::uint64_t>((Clock::now() - start).count());
  if (pair == 0) return;
  ++cache.counts.splits;
  link->store(pair, std::memory_order_release);
  cache.face = -1;
}

/// Halves a cell where that thins out its cut most. Nothing (0) where no half would be thinner, or memory is
/// spent.
std::uintptr_t BeamTree::split(const BeamLeaf& leaf, int face, const Cell& cell, ThreadState& state,
                               TreeCounts& counts) {
  const Hierarchy::Node* cut = leaf.cut.whole() ? hierarchy_.nodes().data() : leaf.cut.nodes;
  const std::uint32_t nodes = leaf.cut.whole() ? 1 : leaf.cut.count;
  int lanes = 0;
  for (std::uint32_t n = 0; n < nodes; ++n)
    for (const std::uint8_t opacity : cut[n].opacity) lanes += opacity != 0;
  int best = -1, fewest = std::numeric_limits<int>::max();
  for (std::size_t dimension = 0; dimension < kDimensions; ++dimension) {
    if (dimension < 3 && unit_[dimension] == 0) continue;
    if (cell.bits[dimension] >= kBits - 4) continue;
    // Whichever has been halved less goes first where it makes no difference.
    int total = cell.bits[dimension];
    Cell half = cell;
    ++half.bits[dimension];
    for (int side = 0; side < 2; ++side) {
      half.at[dimension] = cell.at[dimension] | static_cast<std::uint32_t>(side)
                                                    << (kBits - half.bits[dimension]);
      const Beam beam = beam_of(face, half);
      for (std::uint32_t n = 0; n < nodes; ++n) total += 64 * std::popcount(beam.meets(cut[n]));
    }
    if (total < fewest) fewest = total, best = static_cast<int>(dimension);
  }
  if (best < 0) return 0;
  const auto dimension = static_cast<std::size_t>(best);
  std::byte* memory = state.arena.take(sizeof(Pair));
  if (!memory) return 0;
  auto* pair = new (memory) Pair;
  pair->dimension = static_cast<std::uint8_t>(best);
  pair->shift = static_cast<std::uint8_t>(kBits - cell.bits[dimension] - 1);
  counts.bytes += sizeof(Pair);
  const bool hardly = fewest / 64 > 2 * lanes - lanes / 4;
  for (std::uint32_t side = 0; side < 2; ++side) {
    Cell half = cell;
    ++half.bits[dimension];
    half.at[dimension] |= side << pair->shift;
    const Beam beam = beam_of(face, half);
    Lanes out;
    for (std::uint32_t n = 0; n < nodes; ++n) out.add(cut[n], beam.meets(cut[n]));
    out.open(hierarchy_, beam);
    out.depth = static_cast<std::uint8_t>(leaf.depth + 1);
    out.stalls = static_cast<std::uint8_t>(hardly ? leaf.stalls + 1 : 0);
    out.final = out.depth >= kDeepest || out.count == 0 ||
                (out.count <= Hierarchy::kWidth && out.only_primitives()) || out.stalls >= kMostStalls;
    BeamLeaf* child = make_leaf(out, state, counts);
    if (!child) return 0;
    pair->child[side].store(reinterpret_cast<std::uintptr_t>(child) | kLeafTag, std::memory_order_relaxed);
  }
  counts.nodes += 2;
  return reinterpret_cast<std::uintptr_t>(pair) | kPairTag;
}

BeamLeaf* BeamTree::make_leaf(const Lanes& lanes, ThreadState& state, TreeCounts& counts) const {
  const auto nodes = static_cast<std::size_t>((lanes.count + Hierarchy::kWidth - 1) / Hierarchy::kWidth);
  const std::size_t bytes = sizeof(BeamLeaf) + kAlignment + nodes * sizeof(Hierarchy::Node);
  std::byte* memory = state.arena.take(bytes);
  if (!memory) return nullptr;
  auto* leaf = new (memory) BeamLeaf;
  const auto start =
      (reinterpret_cast<std::uintptr_t>(memory) + sizeof(BeamLeaf) + kAlignment - 1) & ~(kAlignment - 1);
  auto* cut = reinterpret_cast<Hierarchy::Node*>(start);
  for (std::size_t n = 0; n < nodes; ++n) {
    new (cut + n) Hierarchy::Node(lanes.nodes[n]);
    for (int lane = 0; lane < Hierarchy::kWidth; ++lane) {
      if (static_cast<int>(n) * Hierarchy::kWidth + lane < lanes.count) continue;
      for (int axis = 0; axis < 3; ++axis) {
        cut[n].planes[0][axis][lane] = std::numeric_limits<float>::infinity();
        cut[n].planes[1][axis][lane] = -std::numeric_limits<float>::infinity();
      }
      cut[n].child[lane] = Hierarchy::kLeafBit;
      cut[n].opacity[lane] = 0;
    }
  }
  leaf->cut = {cut, static_cast<std::uint32_t>(nodes)};
  leaf->lanes = static_cast<std::uint8_t>(lanes.count);
  leaf->final = lanes.final;
  leaf->stalls = lanes.stalls;
  leaf->depth = lanes.depth;
  ++counts.leaves;
  counts.candidates += static_cast<std::uint64_t>(lanes.count);
  counts.bytes += bytes;
  return leaf;
}

}  // namespace fas
