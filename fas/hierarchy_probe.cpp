// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "fas/hierarchy.h"

namespace fas {
namespace {

double largest_of(const Point& v) { return std::max({std::fabs(v[0]), std::fabs(v[1]), std::fabs(v[2])}); }

}  // namespace

ClipBox::ClipBox(const Bounds& box) : planes{box.lo, box.hi} {
  empty = !(box.lo[0] <= box.hi[0] && box.lo[1] <= box.hi[1] && box.lo[2] <= box.hi[2]);
  size = largest_of(box.lo) + largest_of(box.hi);
  for (std::size_t i = 0; i < 3; ++i) {
    center[i] = 0.5 * (box.lo[i] + box.hi[i]);
    extent = std::max(extent, box.hi[i] - box.lo[i]);
  }
}

bool make_probe(const ClipBox& box, double condition, const ClipRay& ray, double lo, double hi,
                BoxProbe& probe) {
  if (box.empty) return false;
  const double exact = exact_slack(box, condition, ray);
  if (!clip(box, exact, ray, lo, hi, probe.entry)) return false;
  const double largest = largest_of(ray.direction);
  double start[3], far = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    start[i] = ray.origin[i] + probe.entry * ray.direction[i] - box.center[i];
    far = std::max(far, std::fabs(start[i]));
  }
  const double slack =
      0x1p-21 * (far + box.extent) + exact + BoxProbe::kUnit * std::fabs(probe.entry) * largest;
  probe.usable = largest > 1e-280 && largest < 1e280 && slack < 1e30 && far < 1e30;
  if (!probe.usable) return true;
  probe.scale = largest;
  probe.slack = static_cast<float>(2 * slack);
  for (std::size_t i = 0; i < 3; ++i) {
    const double toward = ray.sign[i] * slack;
    probe.near_side[i] = ray.near_side[i];
    probe.near_origin[i] = static_cast<float>(start[i] + toward);
    probe.far_origin[i] = static_cast<float>(start[i] - toward);
    const bool tiny = !(std::fabs(ray.direction[i]) >= BoxProbe::kLeastComponent * largest);
    probe.inverse[i] =
        static_cast<float>(tiny ? ray.sign[i] / BoxProbe::kLeastComponent : ray.inverse[i] * largest);
  }
  return true;
}

}  // namespace fas
