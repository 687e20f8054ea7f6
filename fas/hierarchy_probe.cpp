// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>

#include "fas/hierarchy.h"

namespace fas {
namespace {

constexpr double kUnit = 64 * std::numeric_limits<double>::epsilon();
/// Components of a direction below this share of the largest are taken for it: over the extent of a structure
/// the difference is far below the slack.
constexpr double kLeastComponent = 1e-18;

double largest_of(const double* v) { return std::max({std::fabs(v[0]), std::fabs(v[1]), std::fabs(v[2])}); }

/// What exact tests may be off by: rounding of the origin taken into the space of a primitive and back.
inline double exact_slack(const ClipBox& box, double condition, const double* origin) {
  return kUnit * condition * (largest_of(origin) + box.size);
}

/// The slab test in double precision on the box widened by `slack`: the stay within (lo, hi).
[[gnu::always_inline]] inline bool clip(const ClipBox& box, double slack, const double* o, const double* d,
                                        const double* inverse, double lo, double hi, double& entry) {
  double exit = hi;
  entry = lo;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double a = box.lo[axis] - slack - o[axis], b = box.hi[axis] + slack - o[axis];
    if (d[axis] == 0) {
      if (a > 0 || b < 0) return false;
      continue;
    }
    const double in = (d[axis] > 0 ? a : b) * inverse[axis], out = (d[axis] > 0 ? b : a) * inverse[axis];
    if (in > entry) entry = in;
    if (out < exit) exit = out;
  }
  return entry <= exit + 8 * std::numeric_limits<double>::epsilon() * std::fabs(exit);
}

}  // namespace

ClipBox::ClipBox(const Bounds& box) : lo(box.lo), hi(box.hi) {
  empty = !(lo[0] <= hi[0] && lo[1] <= hi[1] && lo[2] <= hi[2]);
  size = largest_of(lo.data()) + largest_of(hi.data());
  for (std::size_t i = 0; i < 3; ++i) {
    center[i] = 0.5 * (lo[i] + hi[i]);
    extent = std::max(extent, hi[i] - lo[i]);
  }
}

bool may_meet(const ClipBox& box, double condition, const double* origin, const double* direction, double lo,
              double hi) {
  if (box.empty) return false;
  const double inverse[3] = {1 / direction[0], 1 / direction[1], 1 / direction[2]};
  double entry = 0;
  return clip(box, exact_slack(box, condition, origin), origin, direction, inverse, lo, hi, entry);
}

bool make_probe(const ClipBox& box, double condition, const double* origin, const double* direction,
                double lo, double hi, BoxProbe& probe) {
  if (box.empty) return false;
  const double exact = exact_slack(box, condition, origin);
  const double inverse[3] = {1 / direction[0], 1 / direction[1], 1 / direction[2]};
  if (!clip(box, exact, origin, direction, inverse, lo, hi, probe.entry)) return false;
  const double largest = largest_of(direction);
  double start[3], far = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    start[i] = origin[i] + probe.entry * direction[i] - box.center[i];
    far = std::max(far, std::fabs(start[i]));
  }
  const double slack = 0x1p-21 * (far + box.extent) + exact + kUnit * std::fabs(probe.entry) * largest;
  probe.usable = largest > 1e-280 && largest < 1e280 && slack < 1e30 && far < 1e30;
  if (!probe.usable) return true;
  probe.scale = largest;
  probe.slack = static_cast<float>(2 * slack);
  for (std::size_t i = 0; i < 3; ++i) {
    const bool forward = direction[i] >= 0;
    const double toward = forward ? slack : -slack;
    probe.near_side[i] = forward ? 0 : 1;
    probe.near_origin[i] = static_cast<float>(start[i] + toward);
    probe.far_origin[i] = static_cast<float>(start[i] - toward);
    const bool tiny = !(std::fabs(direction[i]) >= kLeastComponent * largest);
    probe.inverse[i] = static_cast<float>(tiny ? (forward ? 1 : -1) / kLeastComponent : inverse[i] * largest);
  }
  return true;
}

}  // namespace fas
