// SPDX-License-Identifier: MIT
#include "rayshade/geometry/hierarchy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace rayshade {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kBins = 16;
/// Below this depth ranges are halved whatever the boxes look like, so that the depth is bounded.
constexpr int kDeepest = 48;
/// Runs of this few become leaves, except to fill lanes that would be empty.
constexpr std::uint32_t kSmallRun = 3;
/// Components of a direction below this share of the largest are taken for it: over the extent of a group the
/// difference is far below the slack.
constexpr double kLeastComponent = 1e-18;

float round_down(double x) { return std::nextafter(static_cast<float>(x), -kInfinity); }
float round_up(double x) { return std::nextafter(static_cast<float>(x), kInfinity); }

struct BoxF {
  float lo[3] = {kInfinity, kInfinity, kInfinity};
  float hi[3] = {-kInfinity, -kInfinity, -kInfinity};
  void add(const BoxF& b) {
    for (int i = 0; i < 3; ++i) {
      lo[i] = std::min(lo[i], b.lo[i]);
      hi[i] = std::max(hi[i], b.hi[i]);
    }
  }
  float half_area() const {
    const float x = hi[0] - lo[0], y = hi[1] - lo[1], z = hi[2] - lo[2];
    const float area = x * y + y * z + z * x;
    return area >= 0 && area < kInfinity ? area : std::numeric_limits<float>::max();
  }
  float center(int axis) const { return 0.5f * lo[axis] + 0.5f * hi[axis]; }
};

/// The slab test in double precision. `slack` widens the box; gives the stay within (lo, hi).
bool clip(const Bounds3& box, double slack, const Ray& ray, double lo, double hi, double& entry,
          double& exit) {
  entry = lo;
  exit = hi;
  for (int axis = 0; axis < 3; ++axis) {
    const double o = ray.origin[axis], d = ray.direction[axis];
    const double a = box.lo[axis] - slack - o, b = box.hi[axis] + slack - o;
    if (d == 0) {
      if (a > 0 || b < 0) return false;
      continue;
    }
    const double inverse = 1 / d;
    const double in = (d > 0 ? a : b) * inverse, out = (d > 0 ? b : a) * inverse;
    if (in > entry) entry = in;
    if (out < exit) exit = out;
  }
  return entry <= exit + 8 * std::numeric_limits<double>::epsilon() * std::fabs(exit);
}

/// What exact tests may be off by: rounding of the origin taken into the space of a leaf and back.
double exact_slack(const Bounds3& box, double condition, const Ray& ray) {
  constexpr double kUnit = 64 * std::numeric_limits<double>::epsilon();
  return kUnit * condition * (max_abs(ray.origin) + max_abs(box.lo) + max_abs(box.hi));
}

}  // namespace

bool clip_to_box(const Bounds3& box, double condition, const Ray& ray, double lo, double hi) {
  if (box.empty()) return false;
  double entry = 0, exit = 0;
  return clip(box, exact_slack(box, condition, ray), ray, lo, hi, entry, exit);
}

bool make_probe(const Bounds3& box, double condition, const Ray& ray, double lo, double hi, BoxProbe& probe) {
  if (box.empty()) return false;
  const double exact = exact_slack(box, condition, ray);
  double exit = 0;
  if (!clip(box, exact, ray, lo, hi, probe.entry, exit)) return false;
  const double largest = max_abs(ray.direction);
  const Vec3 center = box.center();
  const Vec3 origin = ray.at(probe.entry) - center;
  const double slack = 0x1p-21 * (max_abs(origin) + max_abs(box.extent())) + exact +
                       64 * std::numeric_limits<double>::epsilon() * std::fabs(probe.entry) * largest;
  probe.usable = largest > 0 && largest < 1e300 && slack < 1e30 && max_abs(origin) < 1e30;
  if (!probe.usable) return true;
  probe.scale = largest;
  probe.slack = static_cast<float>(2 * slack);
  for (int axis = 0; axis < 3; ++axis) {
    double d = ray.direction[axis] / largest;
    const bool forward = d >= 0;
    if (std::fabs(d) < kLeastComponent) d = forward ? kLeastComponent : -kLeastComponent;
    probe.near_side[axis] = forward ? 0 : 1;
    const double toward = forward ? slack : -slack;
    const float n = static_cast<float>(origin[axis] + toward), f = static_cast<float>(origin[axis] - toward);
    const float inverse = static_cast<float>(1 / d);
    for (int lane = 0; lane < 4; ++lane) {
      probe.near_origin[axis][lane] = n;
      probe.far_origin[axis][lane] = f;
      probe.inverse[axis][lane] = inverse;
    }
  }
  return true;
}

/// Splits top down, up to four ways per node, by the surface area heuristic over bins of the boxes' centres.
struct Hierarchy::Builder {
  Hierarchy& out;
  std::span<const std::uint8_t> opacities;
  std::vector<BoxF> boxes;

  struct Range {
    std::uint32_t first, last;
    BoxF box;
    std::uint32_t size() const { return last - first; }
  };

  Range range(std::uint32_t first, std::uint32_t last) const {
    Range r{first, last, {}};
    for (std::uint32_t i = first; i < last; ++i) r.box.add(boxes[out.order_[i]]);
    return r;
  }

  void split(const Range& whole, bool halve, Range& left, Range& right) {
    const std::uint32_t n = whole.size();
    const auto begin = out.order_.begin() + whole.first, end = out.order_.begin() + whole.last;
    std::uint32_t middle = n / 2;
    if (!halve) {
      float lo[3] = {kInfinity, kInfinity, kInfinity}, hi[3] = {-kInfinity, -kInfinity, -kInfinity};
      for (auto it = begin; it != end; ++it) {
        for (int axis = 0; axis < 3; ++axis) {
          lo[axis] = std::min(lo[axis], boxes[*it].center(axis));
          hi[axis] = std::max(hi[axis], boxes[*it].center(axis));
        }
      }
      float best = kInfinity;
      int best_axis = -1, best_bin = 0;
      const auto bin_of = [&](const BoxF& box, int axis, float factor) {
        return std::clamp(static_cast<int>((box.center(axis) - lo[axis]) * factor), 0, kBins - 1);
      };
      const auto factor_of = [&](int axis) { return kBins / (hi[axis] - lo[axis]); };
      for (int axis = 0; axis < 3; ++axis) {
        const float factor = factor_of(axis);
        if (!(hi[axis] > lo[axis]) || !(factor < kInfinity) || !(factor > 0)) continue;
        BoxF bins[kBins];
        std::uint32_t counts[kBins] = {};
        for (auto it = begin; it != end; ++it) {
          const int bin = bin_of(boxes[*it], axis, factor);
          bins[bin].add(boxes[*it]);
          ++counts[bin];
        }
        float right_area[kBins];
        std::uint32_t right_count[kBins];
        BoxF sum;
        std::uint32_t total = 0;
        for (int bin = kBins - 1; bin > 0; --bin) {
          sum.add(bins[bin]);
          total += counts[bin];
          right_area[bin] = sum.half_area();
          right_count[bin] = total;
        }
        sum = {};
        total = 0;
        for (int bin = 1; bin < kBins; ++bin) {
          sum.add(bins[bin - 1]);
          total += counts[bin - 1];
          if (total == 0 || right_count[bin] == 0) continue;
          const float cost = sum.half_area() * static_cast<float>(total) +
                             right_area[bin] * static_cast<float>(right_count[bin]);
          if (cost < best) {
            best = cost;
            best_axis = axis;
            best_bin = bin;
          }
        }
      }
      if (best_axis >= 0) {
        const float factor = factor_of(best_axis);
        const auto at = std::stable_partition(
            begin, end, [&](std::uint32_t i) { return bin_of(boxes[i], best_axis, factor) < best_bin; });
        middle = static_cast<std::uint32_t>(at - begin);
      }
    }
    left = range(whole.first, whole.first + middle);
    right = range(whole.first + middle, whole.last);
  }

  /// Builds a node over a range of at least two.
  std::uint32_t build(const Range& whole, int depth) {
    const auto index = static_cast<std::uint32_t>(out.nodes_.size());
    out.nodes_.emplace_back();
    Range parts[kWidth] = {whole};
    int count = 1;
    while (count < kWidth) {
      int widest = -1;
      for (int i = 0; i < count; ++i) {
        if (parts[i].size() < 2) continue;
        if (widest < 0 || parts[i].box.half_area() > parts[widest].box.half_area()) widest = i;
      }
      if (widest < 0) break;
      Range left, right;
      split(parts[widest], depth > kDeepest, left, right);
      parts[widest] = left;
      parts[count++] = right;
    }
    Node node{};
    for (int lane = 0; lane < kWidth; ++lane) {
      const BoxF& box = lane < count ? parts[lane].box : BoxF{};
      for (int axis = 0; axis < 3; ++axis) {
        node.planes[0][axis][lane] = box.lo[axis];
        node.planes[1][axis][lane] = box.hi[axis];
      }
      if (lane >= count) continue;
      const Range& part = parts[lane];
      for (std::uint32_t i = part.first; i < part.last; ++i) {
        node.opacity[lane] = static_cast<std::uint8_t>(node.opacity[lane] | opacities[out.order_[i]]);
      }
      if (part.size() <= kSmallRun) {
        node.child[lane] = kLeafBit | (part.size() - 1) << kCountShift | part.first;
      } else {
        node.child[lane] = build(part, depth + 1);
      }
    }
    out.nodes_[index] = node;
    return index;
  }
};

Hierarchy::Hierarchy(std::vector<Bounds3> boxes, std::span<const std::uint8_t> opacities, const Bounds3& all)
    : order_(boxes.size()), bounds_(all) {
  std::iota(order_.begin(), order_.end(), 0u);
  Builder builder{*this, opacities, {}};
  builder.boxes.resize(boxes.size());
  const Vec3 center = all.center();
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      builder.boxes[i].lo[axis] = round_down(boxes[i].lo[axis] - center[axis]);
      builder.boxes[i].hi[axis] = round_up(boxes[i].hi[axis] - center[axis]);
    }
  }
  std::vector<Bounds3>().swap(boxes);  // a million of them weigh as much as the result
  nodes_.reserve(order_.size() / 4 + 1);
  builder.build(builder.range(0, static_cast<std::uint32_t>(order_.size())), 0);
  nodes_.shrink_to_fit();
}

}  // namespace rayshade
