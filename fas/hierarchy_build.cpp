// SPDX-License-Identifier: MIT
// Top down: a range of boxes is split in two by the surface area heuristic over bins of the boxes' centres,
// the part with the largest surface again, until there are eight; these become the lanes of a node.
#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <thread>

#include "fas/hierarchy.h"
#include "fas/page_allocator.h"

namespace fas {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kBins = 16;
/// Below this depth ranges are halved whatever the boxes look like: 2^27 boxes end nine levels further down,
/// and with seven entries a level the traversal stack holds.
constexpr int kDeepest = 40;
static_assert(7 * (kDeepest + 10) + 32 <= Hierarchy::kStackSize);
/// Runs of this few share a lane rather than get a node of their own.
constexpr std::uint32_t kRun = 3;
/// Ranges of this share of the whole are tasks of their own; more than the threads, so that none waits long.
constexpr std::uint32_t kTasks = 64, kSmallestTask = 2048;

float round_down(double x) { return std::nextafter(static_cast<float>(x), -kInfinity); }
float round_up(double x) { return std::nextafter(static_cast<float>(x), kInfinity); }

/// Fourth components are there for whole vectors.
struct Box {
  alignas(16) float lo[4] = {kInfinity, kInfinity, kInfinity, 0};
  alignas(16) float hi[4] = {-kInfinity, -kInfinity, -kInfinity, 0};
  void add(const Box& b) {
    for (int i = 0; i < 4; ++i) {
      lo[i] = b.lo[i] < lo[i] ? b.lo[i] : lo[i];
      hi[i] = b.hi[i] > hi[i] ? b.hi[i] : hi[i];
    }
  }
  float half_area() const {
    const float x = hi[0] - lo[0], y = hi[1] - lo[1], z = hi[2] - lo[2];
    const float area = x * y + y * z + z * x;
    return area >= 0 && area < kInfinity ? area : std::numeric_limits<float>::max();
  }
};

/// A box, with the number and the mask of what is in it as bits of the fourth components.
struct Item : Box {
  std::uint32_t id() const { return std::bit_cast<std::uint32_t>(lo[3]); }
  std::uint8_t mask() const { return static_cast<std::uint8_t>(std::bit_cast<std::uint32_t>(hi[3])); }
};

class Builder {
 public:
  using Node = Hierarchy::Node;
  explicit Builder(std::vector<Item>& items) : items_(items) {}

  /// Puts the items in order, and makes nodes over all of them.
  void build(int threads) {
    const auto count = static_cast<std::uint32_t>(items_.size());
    grain_ = std::max(kSmallestTask, count / kTasks);
    make_node(range(0, count), 0, top_, true);
    parts_.resize(tasks_.size());
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
      for (std::size_t i = next++; i < tasks_.size(); i = next++) {
        make_node(tasks_[i].range, tasks_[i].depth, parts_[i], false);
      }
    };
    std::vector<std::thread> others;
    for (int i = 1; i < threads && static_cast<std::size_t>(i) < tasks_.size(); ++i)
      others.emplace_back(work);
    work();
    for (std::thread& thread : others) thread.join();
  }

  /// The nodes in one piece. Items are no longer needed.
  std::vector<Node> take_nodes() {
    std::size_t total = top_.size();
    for (const Part& part : parts_) total += part.size();
    std::vector<Node> nodes;
    nodes.reserve(total);
    nodes.assign(top_.begin(), top_.end());
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      const auto offset = static_cast<std::uint32_t>(nodes.size());
      nodes[tasks_[i].node].child[tasks_[i].lane] = offset;
      for (Node& node : parts_[i]) {
        for (std::uint32_t& child : node.child)
          if ((child & Hierarchy::kLeafBit) == 0) child += offset;
      }
      nodes.insert(nodes.end(), parts_[i].begin(), parts_[i].end());
      Part().swap(parts_[i]);
    }
    return nodes;
  }

 private:
  struct Range {
    std::uint32_t first = 0, last = 0;
    Box box;
    std::uint32_t size() const { return last - first; }
  };
  struct Task {
    Range range;
    int depth;
    std::uint32_t node;
    int lane;
  };

  Range range(std::uint32_t first, std::uint32_t last) const {
    Range r{first, last, {}};
    for (std::uint32_t i = first; i < last; ++i) r.box.add(items_[i]);
    return r;
  }

  /// Parts and the whole they end in would otherwise count twice.
  using Part = std::vector<Node, PageAllocator<Node>>;

  std::uint32_t make_node(const Range& whole, int depth, Part& out, bool defer) {
    const auto index = static_cast<std::uint32_t>(out.size());
    out.emplace_back();
    Range parts[Hierarchy::kWidth] = {whole};
    int count = 1;
    const bool halve = depth >= kDeepest;
    while (count < Hierarchy::kWidth) {
      int widest = -1;
      float most = -1;
      for (int i = 0; i < count; ++i) {
        if (parts[i].size() < 2) continue;
        const float weight = halve ? static_cast<float>(parts[i].size()) : parts[i].box.half_area();
        if (weight > most) most = weight, widest = i;
      }
      if (widest < 0) break;
      Range left, right;
      split(parts[widest], halve, left, right);
      parts[widest] = left;
      parts[count++] = right;
    }
    Node node{};
    for (int lane = 0; lane < Hierarchy::kWidth; ++lane) {
      const Box& box = lane < count ? parts[lane].box : Box{};
      for (int axis = 0; axis < 3; ++axis) {
        node.planes[0][axis][lane] = box.lo[axis];
        node.planes[1][axis][lane] = box.hi[axis];
      }
      node.child[lane] = Hierarchy::kLeafBit;
      if (lane >= count) continue;
      const Range& part = parts[lane];
      for (std::uint32_t i = part.first; i < part.last; ++i) node.opacity[lane] |= items_[i].mask();
      if (part.size() <= kRun) {
        node.child[lane] = Hierarchy::kLeafBit | (part.size() - 1) << Hierarchy::kCountShift | part.first;
      } else if (defer && part.size() <= grain_) {
        tasks_.push_back({part, depth + 1, index, lane});
      } else {
        node.child[lane] = make_node(part, depth + 1, out, defer);
      }
    }
    out[index] = node;
    return index;
  }

  void split(const Range& whole, bool halve, Range& left, Range& right) {
    Item* const begin = items_.data() + whole.first;
    Item* const end = items_.data() + whole.last;
    if (whole.size() == 2 || halve || !partition(whole, begin, end, left, right)) {
      const std::uint32_t middle = whole.first + whole.size() / 2;
      left = range(whole.first, middle);
      right = range(middle, whole.last);
    }
  }

  /// False where all centres are the same, as far as bins can tell.
  static bool partition(const Range& whole, Item* begin, Item* end, Range& left, Range& right) {
    // Twice the centres.
    float lo[4] = {kInfinity, kInfinity, kInfinity, 0}, hi[4] = {-kInfinity, -kInfinity, -kInfinity, 0};
    for (const Item* it = begin; it != end; ++it) {
      for (int axis = 0; axis < 3; ++axis) {
        const float center = it->lo[axis] + it->hi[axis];
        lo[axis] = center < lo[axis] ? center : lo[axis];
        hi[axis] = center > hi[axis] ? center : hi[axis];
      }
    }
    float factor[3];
    bool flat[3];
    for (int axis = 0; axis < 3; ++axis) {
      factor[axis] = kBins / (hi[axis] - lo[axis]);
      flat[axis] = !(hi[axis] > lo[axis]) || !(factor[axis] < kInfinity) || !(factor[axis] > 0);
      if (flat[axis]) factor[axis] = 0;
    }
    const auto bin_of = [&](const Item& item, int axis) {
      const float at = (item.lo[axis] + item.hi[axis] - lo[axis]) * factor[axis];
      return at < kBins - 1 ? static_cast<int>(at) : kBins - 1;
    };
    Box bins[3][kBins];
    std::uint32_t counts[3][kBins] = {};
    for (const Item* it = begin; it != end; ++it) {
      for (int axis = 0; axis < 3; ++axis) {
        const int bin = bin_of(*it, axis);
        bins[axis][bin].add(*it);
        ++counts[axis][bin];
      }
    }
    float best = kInfinity;
    int best_axis = -1, best_bin = 0;
    Box best_left, best_right;
    for (int axis = 0; axis < 3; ++axis) {
      if (flat[axis]) continue;
      Box rights[kBins];
      std::uint32_t right_count[kBins];
      Box sum;
      std::uint32_t total = 0;
      for (int bin = kBins - 1; bin > 0; --bin) {
        sum.add(bins[axis][bin]);
        total += counts[axis][bin];
        rights[bin] = sum;
        right_count[bin] = total;
      }
      sum = {};
      total = 0;
      for (int bin = 1; bin < kBins; ++bin) {
        sum.add(bins[axis][bin - 1]);
        total += counts[axis][bin - 1];
        if (total == 0 || right_count[bin] == 0) continue;
        const float cost = sum.half_area() * static_cast<float>(total) +
                           rights[bin].half_area() * static_cast<float>(right_count[bin]);
        if (cost < best) {
          best = cost;
          best_axis = axis;
          best_bin = bin;
          best_left = sum;
          best_right = rights[bin];
        }
      }
    }
    if (best_axis < 0) return false;
    Item* const middle =
        std::partition(begin, end, [&](const Item& item) { return bin_of(item, best_axis) < best_bin; });
    const std::uint32_t at = whole.first + static_cast<std::uint32_t>(middle - begin);
    left = {whole.first, at, best_left};
    right = {at, whole.last, best_right};
    return true;
  }

  std::vector<Item>& items_;
  std::uint32_t grain_ = 0;
  std::vector<Task> tasks_;
  Part top_;
  std::vector<Part> parts_;  ///< of the tasks
};

}  // namespace

Hierarchy::Hierarchy(std::vector<Bounds> boxes, std::span<const std::uint8_t> masks, int threads,
                     std::vector<std::uint32_t>& order) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  bounds_ = {{kInf, kInf, kInf}, {-kInf, -kInf, -kInf}};
  for (const Bounds& box : boxes) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bounds_.lo[axis] = std::min(bounds_.lo[axis], box.lo[axis]);
      bounds_.hi[axis] = std::max(bounds_.hi[axis], box.hi[axis]);
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) center_[axis] = 0.5 * (bounds_.lo[axis] + bounds_.hi[axis]);
  clip_box_ = ClipBox(bounds_);
  std::vector<Item> items(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      items[i].lo[axis] = round_down(boxes[i].lo[axis] - center_[axis]);
      items[i].hi[axis] = round_up(boxes[i].hi[axis] - center_[axis]);
    }
    items[i].lo[3] = std::bit_cast<float>(static_cast<std::uint32_t>(i));
    items[i].hi[3] = std::bit_cast<float>(static_cast<std::uint32_t>(masks[i]));
  }
  std::vector<Bounds>().swap(boxes);  // a million of them weigh as much as the result
  Builder builder(items);
  builder.build(threads);
  order.resize(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) order[i] = items[i].id();
  std::vector<Item>().swap(items);
  nodes_ = builder.take_nodes();
}

}  // namespace fas
